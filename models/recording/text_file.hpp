/// @file
/// A file's bytes, mapped into memory for reading.
#pragma once

#include <string>
#include <string_view>

namespace wems {

class TextFile {
public:
    /// When the file is read.
    enum class Pages {
        all,       ///< at once
        as_needed  ///< where view() is looked at; release() gives them back
    };
    /// @throws InputError: not there, not readable, a directory or another thing that is no file, empty.
    explicit TextFile(const std::string& file, Pages pages = Pages::all);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    std::string_view view() const { return view_; }
    /// Gives the memory back that was taken so far; what is looked at again is read again.
    void release() const;

private:
    std::string_view view_;
    void* mapping_ = nullptr;
    std::string copy_;  // where the file cannot be mapped, such as a pipe
};

}  // namespace wems
