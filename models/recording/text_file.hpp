/// @file
/// A file's bytes.
#pragma once

#include <sys/stat.h>

#include <string>
#include <string_view>

namespace wems {

class TextFile {
public:
    /// When the file is read.
    enum class Pages {
        all,       ///< at once
        as_needed  ///< mapped into memory, read where view() is looked at; release() gives the memory back
    };
    /// @throws InputError: not there, not readable, a directory or another thing that is no file, empty, changed while
    ///         it was read.
    explicit TextFile(const std::string& file, Pages pages = Pages::all);
    ~TextFile();
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;

    std::string_view view() const { return view_; }
    /// Gives the memory back that was taken so far; what is looked at again is read again.
    /// @throws InputError if the file was changed since it was opened
    void release() const;

private:
    class Descriptor {
    public:
        explicit Descriptor(int value) : value_(value) {}
        ~Descriptor();
        Descriptor(const Descriptor&) = delete;
        Descriptor& operator=(const Descriptor&) = delete;
        int get() const { return value_; }

    private:
        int value_;
    };
    void checkUnchanged() const;

    std::string file_;
    Descriptor descriptor_;
    struct stat status_ {};  // when it was opened
    std::string_view view_;
    void* mapping_ = nullptr;
    std::string copy_;  // where the file cannot be mapped, such as a pipe
};

}  // namespace wems
