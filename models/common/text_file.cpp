#include "models/common/text_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "models/common/error.hpp"

namespace wems {

namespace {

/// @param expected bytes; more are read where there are more
std::string readAll(int descriptor, const std::string& file, std::size_t expected) {
    constexpr std::size_t at_once = std::size_t{1} << 20;
    std::string text;
    for (std::size_t size = 0;;) {
        text.resize(std::max(size + at_once, expected + 1));
        const auto count = ::read(descriptor, text.data() + size, text.size() - size);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw InputError({file, 0, {}}, "cannot be read: " + std::generic_category().message(errno));
        size += static_cast<std::size_t>(count);
        if (count > 0) continue;
        text.resize(size);
        return text;
    }
}

bool isUnchanged(const struct stat& before, const struct stat& now) {
    return now.st_size == before.st_size && now.st_mtim.tv_sec == before.st_mtim.tv_sec &&
           now.st_mtim.tv_nsec == before.st_mtim.tv_nsec;
}

}  // namespace

TextFile::Descriptor::~Descriptor() {
    if (value_ >= 0) ::close(value_);
}

TextFile::TextFile(const std::string& file, Pages pages)
    : file_(file), descriptor_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_.get() < 0) {
        throw InputError({file, 0, {}}, errno == ENOENT
                                            ? "there is no such file"
                                            : "cannot be opened: " + std::generic_category().message(errno));
    }
    if (::fstat(descriptor_.get(), &status_) != 0)
        throw InputError({file, 0, {}}, "cannot be read: " + std::generic_category().message(errno));
    if (S_ISDIR(status_.st_mode)) throw InputError({file, 0, {}}, "is a directory, not a file");
    const bool regular = S_ISREG(status_.st_mode) && status_.st_size > 0;
    if (regular && pages == Pages::as_needed) {
        const std::size_t size = status_.st_size;
        void* mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor_.get(), 0);
        if (mapping != MAP_FAILED) {
            mapping_ = mapping;
            view_ = {static_cast<const char*>(mapping), size};
            return;
        }
    }
    copy_ = readAll(descriptor_.get(), file, regular ? static_cast<std::size_t>(status_.st_size) : 0);
    view_ = copy_;
    if (S_ISREG(status_.st_mode)) checkUnchanged();
    if (view_.empty()) throw InputError({file, 0, {}}, "the file is empty");
}

void TextFile::checkUnchanged() const {
    struct stat now {};
    if (::fstat(descriptor_.get(), &now) == 0 && !isUnchanged(status_, now))
        throw InputError({file_, 0, {}}, "was changed while it was read", "a recording that is complete");
}

void TextFile::release() const {
    if (mapping_ == nullptr) return;
    checkUnchanged();
    ::madvise(mapping_, view_.size(), MADV_DONTNEED);
}

TextFile::~TextFile() {
    if (mapping_ != nullptr) ::munmap(mapping_, view_.size());
}

}  // namespace wems
