/// @file
/// A file's bytes, mapped into memory for reading.
#pragma once

#include <string>
#include <string_view>

namespace wems {

class TextFile {
public:
    /// @throws InputError: not there, not readable, a directory or another thing that is no file, empty.
    explicit TextFile(const std::string& file);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    std::string_view view() const { return view_; }

private:
    std::string_view view_;
    void* mapping_ = nullptr;
    std::string copy_;  // where the file cannot be mapped, such as a pipe
};

}  // namespace wems
