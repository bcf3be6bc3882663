// A file for the time of a test.
#pragma once

#include <string>

namespace wems::test {

class TemporaryFile {
public:
    explicit TemporaryFile(const std::string& content = {});
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& path() const { return path_; }
    std::string read() const;

private:
    std::string path_;
};

}  // namespace wems::test
