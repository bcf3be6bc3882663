#include "tests/recording/temporary_file.hpp"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace wems::test {

TemporaryFile::TemporaryFile(const std::string& content) {
    static std::atomic<int> count{0};
    path_ = (std::filesystem::temp_directory_path() /
             ("wems_recording_" + std::to_string(::getpid()) + "_" + std::to_string(count++) + ".csv"))
                .string();
    std::ofstream(path_, std::ios::binary) << content;
}

TemporaryFile::~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
}

std::string TemporaryFile::read() const {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace wems::test
