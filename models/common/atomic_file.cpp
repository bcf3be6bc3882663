#include "models/common/atomic_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <random>
#include <system_error>
#include <utility>

#include "models/common/error.hpp"

namespace wems {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferSize = std::size_t{1} << 20;
constexpr mode_t kNewFile = 0666;  // less the user's umask
constexpr mode_t kPermissions = 07777;
constexpr std::string_view kEnding = ".part";
constexpr const char* kAccepted = "a file in a folder that exists and is writable";

/// Where a chain of symbolic links ends, whether something is there or not.
std::string followLinks(const std::string& path) {
    constexpr int longest_chain = 40;  // as Linux follows
    fs::path at = path;
    std::error_code missing;
    for (int i = 0; i < longest_chain && fs::is_symlink(fs::symlink_status(at, missing)); ++i) {
        const fs::path next = fs::read_symlink(at, missing);
        if (missing) break;
        at = next.is_absolute() ? next : at.parent_path() / next;
    }
    return at.string();
}

std::string folderOf(const std::string& file) {
    const std::string folder = fs::path(file).parent_path().string();
    return folder.empty() ? "." : folder;
}

/// `.run.csv.` of `folder/run.csv`: what the names of its staged files begin with.
std::string stagedPrefix(const std::string& target) {
    return "." + fs::path(target).filename().string() + ".";
}

/// A name beside `target` that nobody can foresee.
std::string drawName(const std::string& target) {
    constexpr std::string_view letters = "abcdefghijklmnopqrstuvwxyz234567";
    constexpr int length = 16;  // 80 bits
    std::random_device random;  // of the system
    std::string name = stagedPrefix(target);
    for (int i = 0; i < length; ++i) name += letters[random() % letters.size()];
    return folderOf(target) + "/" + name + std::string(kEnding);
}

/// Removes what killed runs left beside `target`: a file of a run that goes on is locked by it.
void removeLeftovers(const std::string& target) {
    const std::string prefix = stagedPrefix(target);
    std::error_code failed;
    for (const auto& entry : fs::directory_iterator(folderOf(target), failed)) {
        const std::string name = entry.path().filename().string();
        const bool staged = name.size() > prefix.size() + kEnding.size() && name.rfind(prefix, 0) == 0 &&
                            name.compare(name.size() - kEnding.size(), kEnding.size(), kEnding) == 0;
        if (!staged) continue;
        const int descriptor = ::open(entry.path().c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
        if (descriptor < 0) continue;
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(entry.path().c_str());
        ::close(descriptor);
    }
}

std::string describe(int error_number) {
    return std::generic_category().message(error_number);
}

}  // namespace

AtomicFile::AtomicFile(std::string path, Staging staging) : path_(std::move(path)), target_(followLinks(path_)) {
    struct stat old {};
    const bool exists = ::stat(target_.c_str(), &old) == 0;
    if (!exists && errno != ENOENT)
        throw InputError({path_, 0, {}}, "cannot be written: " + describe(errno), kAccepted);
    if (exists && S_ISDIR(old.st_mode)) throw InputError({path_, 0, {}}, "is a folder", "the name of a file");
    through_ = exists && !S_ISREG(old.st_mode);
    if (through_) {
        openThrough();
        return;
    }
    if (exists && ::access(target_.c_str(), W_OK) != 0)
        throw InputError({path_, 0, {}}, "cannot be written", kAccepted);
    openStaged(staging);
    if (exists) keepOwner(old);
}

AtomicFile::~AtomicFile() {
    if (!committed_ && !staged_.empty()) ::unlink(staged_.c_str());
    if (descriptor_ >= 0) ::close(descriptor_);
}

void AtomicFile::fail(int error_number) const {
    const std::string reason = error_number == 0 ? "" : ": " + describe(error_number);
    throw InputError({path_, 0, {}}, "could not be written completely" + reason);
}

void AtomicFile::openThrough() {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
    if (descriptor_ < 0) throw InputError({path_, 0, {}}, "cannot be written: " + describe(errno));
}

void AtomicFile::openStaged(Staging staging) {
    if (fs::path(target_).filename().empty()) throw InputError({path_, 0, {}}, "cannot be written", kAccepted);
    if (staging == Staging::nameless) {
        descriptor_ = ::open(folderOf(target_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, kNewFile);
        // A name is given to it through /proc.
        if (descriptor_ >= 0 && ::access(("/proc/self/fd/" + std::to_string(descriptor_)).c_str(), F_OK) != 0) {
            ::close(descriptor_);
            descriptor_ = -1;
        }
    }
    if (descriptor_ < 0) openNamed(kNewFile);
}

void AtomicFile::openNamed(mode_t mode) {
    removeLeftovers(target_);
    constexpr int attempts = 100;
    for (int i = 0; i < attempts && descriptor_ < 0; ++i) {
        const std::string name = drawName(target_);
        descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
        if (descriptor_ >= 0) staged_ = name;
        if (descriptor_ < 0 && errno != EEXIST) break;
    }
    if (descriptor_ < 0) throw InputError({path_, 0, {}}, "cannot be written", kAccepted);
    ::flock(descriptor_, LOCK_EX | LOCK_NB);
}

/// What may not be given away stays this user's; then the set-user and set-group bits must not go with it.
void AtomicFile::keepOwner(const struct stat& old) {
    struct stat now {};
    mode_t mode = old.st_mode & kPermissions;
    if (::fstat(descriptor_, &now) != 0) fail(errno);
    const bool same = now.st_uid == old.st_uid && now.st_gid == old.st_gid;
    if (!same && ::fchown(descriptor_, old.st_uid, old.st_gid) != 0 &&
        ::fchown(descriptor_, static_cast<uid_t>(-1), old.st_gid) != 0)
        mode &= static_cast<mode_t>(~(S_ISUID | S_ISGID));
    if (::fchmod(descriptor_, mode) != 0 && errno != EPERM) fail(errno);
}

void AtomicFile::write(std::string_view text) {
    buffer_.append(text);
    if (buffer_.size() >= kBufferSize) flush();
}

void AtomicFile::flush() {
    for (std::size_t done = 0; done < buffer_.size();) {
        const auto count = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) fail(errno);
        done += static_cast<std::size_t>(count);
    }
    buffer_.clear();
}

void AtomicFile::finish() {
    if (finished_) return;
    flush();
    // Not every file system, and no device, can be told to write to the disk.
    if (!through_ && ::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOSYS) fail(errno);
    finished_ = true;
}

/// The lock keeps others from taking the name for a leftover before the file gets its own.
void AtomicFile::nameNameless() {
    removeLeftovers(target_);
    ::flock(descriptor_, LOCK_EX | LOCK_NB);
    const std::string open_file = "/proc/self/fd/" + std::to_string(descriptor_);
    const std::string name = drawName(target_);
    if (::linkat(AT_FDCWD, open_file.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0) fail(errno);
    staged_ = name;
}

void AtomicFile::commit() {
    finish();
    if (!through_) {
        if (staged_.empty()) nameNameless();
        if (std::rename(staged_.c_str(), target_.c_str()) != 0) fail(errno);
    }
    committed_ = true;
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0 && errno != EINTR) fail(errno);
}

void AtomicFile::checkWritable(const std::string& path) {
    struct stat status {};
    const bool exists = ::stat(path.c_str(), &status) == 0;
    if (!exists || S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) {
        const AtomicFile probe(path);
    } else if (::access(path.c_str(), W_OK) != 0) {  // not opened: who reads a pipe would see its end
        throw InputError({path, 0, {}}, "cannot be written", kAccepted);
    }
}

void OutputFiles::protect(const std::vector<std::string>& inputs) {
    inputs_.insert(inputs_.end(), inputs.begin(), inputs.end());
}

void OutputFiles::add(std::unique_ptr<AtomicFile> file) {
    std::vector<std::string> outputs{file->path()};
    for (const auto& other : files_) outputs.push_back(other->path());
    checkOutputs(outputs, inputs_);
    file->finish();
    files_.push_back(std::move(file));
}

void OutputFiles::add(const std::string& path, std::string_view text) {
    auto file = std::make_unique<AtomicFile>(path);
    file->write(text);
    add(std::move(file));
}

void OutputFiles::commit() {
    for (const auto& file : files_) file->commit();
    files_.clear();
}

void checkOutputs(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        if (outputs[i].empty()) continue;
        const auto refuse = [&](const std::vector<std::string>& others, std::size_t from, const char* problem) {
            for (std::size_t k = from; k < others.size(); ++k)
                if (!others[k].empty() && isSameFile(outputs[i], others[k]))
                    throw InputError({outputs[i], 0, {}}, problem, "another name for the output");
        };
        refuse(inputs, 0, "is read and to be written in one command");
        refuse(outputs, i + 1, "is to be written twice in one command");
    }
}

bool isSameFile(const std::string& one, const std::string& other) {
    const std::string a = followLinks(one), b = followLinks(other);
    struct stat first {
    }, second{};
    const bool has_first = ::stat(a.c_str(), &first) == 0, has_second = ::stat(b.c_str(), &second) == 0;
    if (has_first && has_second)
        return S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
    if (has_first || has_second) return false;
    std::error_code failed;
    const fs::path folder_a = fs::canonical(folderOf(a), failed), folder_b = fs::canonical(folderOf(b), failed);
    return !failed && folder_a == folder_b && fs::path(a).filename() == fs::path(b).filename();
}

}  // namespace wems
