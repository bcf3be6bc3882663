// Files that change while they are read.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "temporary_file.hpp"

using namespace wems;

TEST_CASE("What was read whole stays readable when the file shrinks") {
    const std::string content(std::size_t{3} << 20, 'x');  // many pages
    const test::TemporaryFile file(content);
    const TextFile text(file.path());
    std::filesystem::resize_file(file.path(), 0);
    CHECK(text.view() == content);
}

TEST_CASE("A file that grows or shrinks while it is read page by page is said to have changed") {
    const std::string content(std::size_t{1} << 20, 'x');
    const auto size = GENERATE_COPY(content.size() / 2, content.size() + 1);
    const test::TemporaryFile file(content);
    const TextFile text(file.path(), TextFile::Pages::as_needed);
    CHECK_NOTHROW(text.release());
    std::filesystem::resize_file(file.path(), size);
    CHECK_THROWS_WITH(text.release(), Catch::Contains("was changed while it was read"));
}
