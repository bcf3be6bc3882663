#include "models/recording/text_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "models/error.hpp"

namespace wems {
namespace {

/// Closes the descriptor at the end of the scope.
class Descriptor {
public:
    explicit Descriptor(int value) : value_(value) {}
    ~Descriptor() {
        if (value_ >= 0) ::close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return value_; }

private:
    int value_;
};

std::string readAll(int descriptor, const std::string& file) {
    std::string text;
    std::array<char, 65536> buffer{};
    for (;;) {
        const auto count = ::read(descriptor, buffer.data(), buffer.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw InputError({file, 0, {}}, "cannot be read: " + std::generic_category().message(errno));
        if (count == 0) return text;
        text.append(buffer.data(), static_cast<std::size_t>(count));
    }
}

}  // namespace

TextFile::TextFile(const std::string& file, Pages pages) {
    const Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
    if (descriptor.get() < 0) {
        throw InputError({file, 0, {}}, errno == ENOENT
                                            ? "there is no such file"
                                            : "cannot be opened: " + std::generic_category().message(errno));
    }
    struct stat status {};
    if (::fstat(descriptor.get(), &status) != 0)
        throw InputError({file, 0, {}}, "cannot be read: " + std::generic_category().message(errno));
    if (S_ISDIR(status.st_mode)) throw InputError({file, 0, {}}, "is a directory, not a file");
    if (S_ISREG(status.st_mode) && status.st_size > 0) {
        const auto size = static_cast<std::size_t>(status.st_size);
        const int flags = MAP_PRIVATE | (pages == Pages::all ? MAP_POPULATE : 0);
        void* mapping = ::mmap(nullptr, size, PROT_READ, flags, descriptor.get(), 0);
        if (mapping != MAP_FAILED) {
            mapping_ = mapping;
            view_ = {static_cast<const char*>(mapping), size};
            return;
        }
    }
    copy_ = readAll(descriptor.get(), file);
    view_ = copy_;
    if (view_.empty()) throw InputError({file, 0, {}}, "the file is empty");
}

void TextFile::release() const {
    if (mapping_ != nullptr) ::madvise(mapping_, view_.size(), MADV_DONTNEED);
}

TextFile::~TextFile() {
    if (mapping_ != nullptr) ::munmap(mapping_, view_.size());
}

}  // namespace wems
