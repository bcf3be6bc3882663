// Readers in a process of their own: what they return, throw and how they end.
#include <sys/resource.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "models/common/error.hpp"
#include "models/recording/separate_reader.hpp"
#include "temporary_file.hpp"

using namespace wems;
using Catch::Contains;

namespace {

/// Numbers that count from 0, column by column.
class Counting : public StoredNumbers {
public:
    std::vector<double> read(std::size_t row, std::size_t rows, std::size_t column,
                             std::size_t columns) const override {
        if (column + columns > 1000) throw InputError({"run.h5", 7, "x"}, "ends there", "less");
        if (row == 99) std::raise(SIGKILL);
        std::vector<double> numbers(rows * columns);
        std::iota(numbers.begin(), numbers.end(), static_cast<double>(row + column * 100));
        return numbers;
    }
};

MatFile makeTree() {
    MatFile tree;
    tree.version = "HDF5";
    tree.has_objects = true;
    MatValue numbers, left, texts, cells;
    numbers.kind = MatValue::Kind::numbers;
    numbers.rows = 2;
    numbers.columns = 1;
    numbers.numbers = {1.5, -2};
    left.kind = MatValue::Kind::numbers;
    left.rows = 100;
    left.columns = 1000;
    left.stored = std::make_shared<Counting>();
    texts.kind = MatValue::Kind::text;
    texts.texts = {"µ", std::string("a\0b", 3)};
    cells.kind = MatValue::Kind::cells;
    cells.elements = {numbers, texts, left};
    tree.root.kind = MatValue::Kind::structs;
    tree.root.fields = {{"cells", cells}, {"stored", left}};
    return tree;
}

}  // namespace

TEST_CASE("A tree comes over whole, arrays that stay in the file are read in parts") {
    const test::TemporaryFile file("x");
    const MatFile read = readSeparately(file.path(), "HDF5", makeTree);
    CHECK(read.version == "HDF5");
    CHECK(read.has_objects);
    REQUIRE(read.root.fields.size() == 2);
    const MatValue& cells = *read.root.find("cells");
    REQUIRE(cells.elements.size() == 3);
    CHECK(cells.kind == MatValue::Kind::cells);
    CHECK(cells.elements[0].numbers == std::vector<double>{1.5, -2});
    CHECK(cells.elements[0].rows == 2);
    CHECK(cells.elements[1].texts == std::vector<std::string>{"µ", std::string("a\0b", 3)});
    for (const MatValue* left : {&cells.elements[2], read.root.find("stored")}) {
        REQUIRE(left->stored);
        CHECK(left->columns == 1000);
        CHECK(left->stored->read(3, 2, 5, 1) == std::vector<double>{503, 504});
        CHECK_THROWS_WITH(left->stored->read(0, 1, 999, 2), "run.h5:7: x: ends there (accepted: less)");
        CHECK(left->stored->read(4, 1, 0, 1) == std::vector<double>{4});
    }
}

TEST_CASE("Two readers at a time end independently of each other") {
    const test::TemporaryFile file("x");
    auto first = std::make_unique<MatFile>(readSeparately(file.path(), "HDF5", makeTree));
    const MatFile second = readSeparately(file.path(), "HDF5", makeTree);
    first.reset();  // waits for its child, which the second one must not keep
    CHECK(second.root.find("stored")->stored->read(1, 1, 0, 1) == std::vector<double>{1});
}

TEST_CASE("An error of the reader is passed on, a crash and a limit are a clear one") {
    const test::TemporaryFile file("x");
    const auto refuse = [&](auto read, const std::string& message) {
        CHECK_THROWS_WITH(readSeparately(file.path(), "HDF5", read), Contains(message));
    };
    refuse([]() -> MatFile { throw InputError({"run.h5", 0, ""}, "no good"); }, "run.h5: no good");
    const std::string broken = file.path() + ": is damaged: HDF5, which reads it, broke off";
    refuse(
        []() -> MatFile {
            std::raise(SIGSEGV);
            return {};
        },
        broken);
    refuse([]() -> MatFile { std::abort(); }, broken);
    refuse([]() -> MatFile { std::exit(0); }, broken);
    refuse([]() -> MatFile { throw 1; }, broken);
#ifndef WEMS_SANITIZED
    refuse(
        []() -> MatFile {
            MatFile tree;
            tree.root.numbers.resize(std::size_t{1} << 32U);  // 32 GB
            return tree;
        },
        broken);
#endif
    refuse(
        []() -> MatFile {
            const rlimit soon{1, 1};
            setrlimit(RLIMIT_CPU, &soon);
            for (volatile long i = 0;; i = i + 1) {
            }
        },
        broken);
    const MatFile tree = readSeparately(file.path(), "HDF5", makeTree);
    CHECK_THROWS_WITH(tree.root.find("stored")->stored->read(99, 1, 0, 1), Contains(broken));
}

TEST_CASE("What a library prints does not reach standard output") {
    const test::TemporaryFile file("x");
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const int kept = dup(STDOUT_FILENO);
    dup2(ends[1], STDOUT_FILENO);
    readSeparately(file.path(), "HDF5", [] {
        const auto written = write(STDOUT_FILENO, "noise", 5);
        return written == 5 ? MatFile{} : MatFile{};
    });
    dup2(kept, STDOUT_FILENO);
    close(kept);
    close(ends[1]);
    char received = 0;
    CHECK(read(ends[0], &received, 1) == 0);
    close(ends[0]);
}
