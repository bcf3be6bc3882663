// Output files: complete or not there, whatever stands under their name.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "models/common/atomic_file.hpp"
#include "models/common/error.hpp"

using namespace wems;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

class Folder {
public:
    Folder() {
        std::string pattern = (fs::temp_directory_path() / "wems-atomic-XXXXXX").string();
        REQUIRE(mkdtemp(pattern.data()) != nullptr);
        path_ = pattern;
    }
    ~Folder() { fs::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    std::string operator/(const std::string& name) const { return path_ + "/" + name; }
    std::string write(const std::string& name, const std::string& text) const {
        std::ofstream(*this / name) << text;
        return *this / name;
    }
    std::string read(const std::string& name) const {
        std::ifstream file(*this / name);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::vector<std::string> list() const {
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
        std::sort(names.begin(), names.end());
        return names;
    }

private:
    std::string path_;
};

mode_t modeOf(const std::string& file) {
    struct stat status {};
    REQUIRE(stat(file.c_str(), &status) == 0);
    return status.st_mode & 07777;
}

using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("A file appears with commit() and not before; without it nothing is left") {
    const auto staging = GENERATE(AtomicFile::Staging::nameless, AtomicFile::Staging::named);
    const Folder folder;
    folder.write("out", "older");
    {
        AtomicFile abandoned(folder / "out", staging);
        abandoned.write("newer");
        abandoned.finish();
        CHECK(folder.read("out") == "older");
    }
    CHECK(folder.list() == Names{"out"});
    const std::string large(3000000, 'x');  // more than is kept in memory
    AtomicFile file(folder / "out", staging);
    file.write("newer");
    file.write(large);
    file.commit();
    CHECK(folder.read("out") == "newer" + large);
    CHECK(folder.list() == Names{"out"});
}

TEST_CASE("A planted name is not followed, and two writers of one file do not meet") {
    const Folder folder;
    folder.write("precious", "kept");
    // What an earlier version used: a name that anyone can foresee.
    fs::create_symlink("precious", folder / ("out.part" + std::to_string(getpid())));
    AtomicFile one(folder / "out", AtomicFile::Staging::named), two(folder / "out", AtomicFile::Staging::named);
    one.write("one");
    two.write("two");
    one.commit();
    CHECK(folder.read("out") == "one");
    two.commit();
    CHECK(folder.read("out") == "two");
    CHECK(folder.read("precious") == "kept");
}

TEST_CASE("What a killed run left is removed by the next one, not what a run that goes on is writing") {
    const Folder folder;
    folder.write(".out.abcdefgh.part", "of a run that was killed");
    folder.write(".other.abcdefgh.part", "of another file");
    folder.write(".out.txt", "the user's own");
    AtomicFile first(folder / "out", AtomicFile::Staging::named);
    const Names during = folder.list();
    CHECK(during.size() == 3);
    CHECK_THAT(during, !Catch::VectorContains(std::string(".out.abcdefgh.part")));
    AtomicFile second(folder / "out", AtomicFile::Staging::named);
    CHECK(folder.list().size() == 4);
    first.write("first");
    first.commit();
    CHECK(folder.read("out") == "first");
}

TEST_CASE("What a run left that was killed between naming a file and moving it is removed by the next one") {
    const Folder folder;
    folder.write(".out.abcdefgh.part", "of a run that was killed");
    AtomicFile file(folder / "out");
    file.write("new");
    file.commit();
    CHECK(folder.read("out") == "new");
    CHECK(folder.list() == Names{"out"});
}

TEST_CASE("A symbolic link stays, what it points at is replaced") {
    const Folder folder;
    fs::create_directory(folder / "far");
    folder.write("far/target", "older");
    fs::create_symlink("far/target", folder / "link");
    fs::create_symlink("link", folder / "link_to_link");
    fs::create_symlink("far/new", folder / "dangling");
    for (const auto& [name, target] : {std::pair("link_to_link", "far/target"), std::pair("dangling", "far/new")}) {
        AtomicFile file(folder / name);
        file.write("newer");
        file.commit();
        CHECK(fs::is_symlink(folder / name));
        CHECK(folder.read(target) == "newer");
    }
    CHECK(fs::is_symlink(folder / "link"));
    fs::create_symlink("circle", folder / "circle");
    CHECK_THROWS_WITH(AtomicFile(folder / "circle"), Contains("cannot be written"));
}

TEST_CASE("The mode is kept; a new file has what the user's mask leaves") {
    const auto staging = GENERATE(AtomicFile::Staging::nameless, AtomicFile::Staging::named);
    const Folder folder;
    folder.write("secret", "older");
    REQUIRE(chmod((folder / "secret").c_str(), 0640) == 0);
    const mode_t mask = umask(027);
    for (const char* name : {"secret", "new"}) {
        AtomicFile file(folder / name, staging);
        file.write("newer");
        file.commit();
    }
    umask(mask);
    CHECK(modeOf(folder / "secret") == 0640);
    CHECK(modeOf(folder / "new") == 0640);
    if (geteuid() != 0) return;  // who else may give files away
    REQUIRE(chown((folder / "secret").c_str(), 1234, 1235) == 0);
    AtomicFile file(folder / "secret", staging);
    file.commit();
    struct stat status {};
    REQUIRE(stat((folder / "secret").c_str(), &status) == 0);
    CHECK(status.st_uid == 1234);
    CHECK(status.st_gid == 1235);
}

TEST_CASE("Devices and pipes are written through, and their errors noticed") {
    const Folder folder;
    REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
    AtomicFile::checkWritable(folder / "pipe");  // does not wait for a reader
    std::string received;
    std::thread reader([&] { received = folder.read("pipe"); });
    {
        AtomicFile file(folder / "pipe");
        file.write("through");
        file.commit();
    }
    reader.join();
    CHECK(received == "through");
    CHECK(fs::is_fifo(folder / "pipe"));
    AtomicFile full("/dev/full");
    full.write("too much");
    CHECK_THROWS_WITH(full.finish(), Contains("/dev/full: could not be written completely: No space left on device"));
    CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("What cannot be written is refused at once") {
    const Folder folder;
    CHECK_THROWS_WITH(AtomicFile::checkWritable(folder / ""), Contains("is a folder"));
    CHECK_THROWS_WITH(AtomicFile::checkWritable(folder / "none/out"), Contains("cannot be written"));
    CHECK_THROWS_WITH(AtomicFile::checkWritable(""), Contains("cannot be written"));
    if (geteuid() == 0) return;  // whom nothing is forbidden
    folder.write("locked", "older");
    REQUIRE(chmod((folder / "locked").c_str(), 0444) == 0);
    CHECK_THROWS_WITH(AtomicFile::checkWritable(folder / "locked"), Contains("cannot be written"));
}

TEST_CASE("The files of a command appear together, or none does") {
    const Folder folder;
    folder.write("one", "older");
    {
        OutputFiles outputs;
        outputs.add(folder / "one", "newer");
        outputs.add(folder / "two", "newer");
        CHECK_THROWS_AS(outputs.add("/dev/full", "too much"), InputError);
        CHECK(folder.read("one") == "older");
    }
    CHECK(folder.list() == Names{"one"});
    OutputFiles outputs;
    outputs.add(folder / "one", "newer");
    outputs.add(folder / "two", "newer");
    outputs.commit();
    CHECK(folder.read("one") == "newer");
    CHECK(folder.read("two") == "newer");
}

TEST_CASE("An output that is read, or written twice, is refused") {
    const Folder folder;
    folder.write("run", "data");
    fs::create_symlink("run", folder / "link");
    fs::create_hard_link(folder / "run", folder / "hard");
    fs::create_directory(folder / "sub");
    for (const char* name : {"run", "link", "hard", "./run", "sub/../run"}) {
        CAPTURE(name);
        CHECK(isSameFile(folder / "run", folder / name));
        OutputFiles outputs;
        outputs.protect({folder / "run"});
        CHECK_THROWS_WITH(outputs.add(folder / name, "x"), Contains("is read and to be written in one command"));
    }
    CHECK(folder.read("run") == "data");
    CHECK(isSameFile(folder / "new", folder / "sub/../new"));
    CHECK_FALSE(isSameFile(folder / "new", folder / "sub/new"));
    CHECK_FALSE(isSameFile(folder / "new", folder / "run"));
    CHECK_FALSE(isSameFile("/dev/null", "/dev/null"));
    OutputFiles outputs;
    outputs.add(folder / "new", "x");
    CHECK_THROWS_WITH(outputs.add(folder / "sub/../new", "y"), Contains("is to be written twice in one command"));
}
