/// @file
/// Output files that are either complete or not there.
#pragma once

#include <string>

namespace wems {

/// Collects what is to stand in `path` in a temporary file beside it. `commit()` renames it into place; without
/// commit, on an exception too, nothing is left and an older file stays as it was.
class AtomicFile {
public:
    /// @throws InputError if the folder cannot be written to.
    explicit AtomicFile(std::string path);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Where to write until commit().
    const std::string& temporaryPath() const { return temporary_; }
    void commit();

    /// Whether a file can be written there, before anything is computed for it. @throws InputError if not.
    static void checkWritable(const std::string& path);

    /// Writes `text` to `path` in one go.
    static void write(const std::string& path, const std::string& text);

private:
    std::string path_, temporary_;
    bool committed_ = false;
};

}  // namespace wems
