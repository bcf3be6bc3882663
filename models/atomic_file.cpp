#include "models/atomic_file.hpp"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <utility>

#include "models/error.hpp"

namespace wems {

AtomicFile::AtomicFile(std::string path)
    : path_(std::move(path)), temporary_(path_ + ".part" + std::to_string(::getpid())) {
    std::ofstream probe(temporary_, std::ios::binary);
    if (!probe) throw InputError({path_, 0, {}}, "cannot be written", "a file in a folder that exists and is writable");
}

AtomicFile::~AtomicFile() {
    if (!committed_) std::remove(temporary_.c_str());
}

void AtomicFile::commit() {
    if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
        throw InputError({path_, 0, {}}, "cannot be written", "a file in a folder that exists and is writable");
    }
    committed_ = true;
}

void AtomicFile::checkWritable(const std::string& path) {
    if (std::filesystem::is_directory(path)) throw InputError({path, 0, {}}, "is a folder", "the name of a file");
    const AtomicFile probe(path);
}

void AtomicFile::write(const std::string& path, const std::string& text) {
    AtomicFile file(path);
    std::ofstream stream(file.temporaryPath(), std::ios::binary | std::ios::trunc);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    if (!stream) throw InputError({path, 0, {}}, "could not be written completely; is the disk full?");
    file.commit();
}

}  // namespace wems
