/// @file
/// Output files that are either complete or not there.
#pragma once

#include <sys/stat.h>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace wems {

/// Collects what is to stand in `path` in a file of the same folder that has no name yet, or, where the file system
/// has no such files, a name that nobody can foresee. `commit()` puts it on the disk and into place; without commit,
/// on an exception too, nothing is left and an older file stays as it was.
///
/// A symbolic link is followed: what it points at is replaced, the link stays. A file that is replaced leaves its mode
/// and, as far as this user may, its owner to the new one. Devices, pipes and sockets are written through at once.
class AtomicFile {
public:
    /// How the file is kept until commit().
    enum class Staging {
        nameless,  ///< O_TMPFILE; named where the file system cannot
        named      ///< `.NAME.RANDOM.part`; what a killed run left of such files is removed by the next run
    };
    /// @throws InputError if `path` is a folder or cannot be written.
    explicit AtomicFile(std::string path, Staging staging = Staging::nameless);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Appends. @throws InputError with the system's reason, such as a full disk.
    void write(std::string_view text);
    /// All that was written is on the disk afterwards; commit() then only gives it its name. @throws InputError
    void finish();
    /// finish(), and the file appears. @throws InputError
    void commit();

    const std::string& path() const { return path_; }

    /// Whether a file can be written there, before anything is computed for it. @throws InputError if not.
    static void checkWritable(const std::string& path);

private:
    void openThrough();
    void openNamed(mode_t mode);
    void openStaged(Staging staging);
    void keepOwner(const struct stat& old);
    void flush();
    void nameNameless();
    [[noreturn]] void fail(int error_number) const;

    std::string path_;    // as the user gave it
    std::string target_;  // links followed
    std::string staged_;  // name of the staged file; empty while it has none
    std::string buffer_;
    int descriptor_ = -1;
    bool through_ = false, finished_ = false, committed_ = false;
};

/// The files of one command: they appear together, or none does.
class OutputFiles {
public:
    /// Files that the command reads: add() refuses them.
    void protect(const std::vector<std::string>& inputs);
    /// A further file of the set, complete.
    /// @throws InputError if it is an input or in the set already; if the disk does not take all of it
    void add(std::unique_ptr<AtomicFile> file);
    /// The same from a text.
    void add(const std::string& path, std::string_view text);
    /// All appear, in the order in which they were added. @throws InputError
    void commit();

private:
    std::vector<std::string> inputs_;
    std::vector<std::unique_ptr<AtomicFile>> files_;
};

/// @throws InputError if a file that is to be written is one that is read, or two of them are one file. Empty names
/// are no files.
void checkOutputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

/// True if both names lead to one file: the same one on the disk, links followed, or, where it is not there yet, the
/// same name in the same folder. Devices and pipes are never the same.
bool isSameFile(const std::string& one, const std::string& other);

}  // namespace wems
