// The drawing of a model: keys, shapes, STL files, what is refused.
#include <catch2/catch.hpp>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "models/common/error.hpp"
#include "models/device_drawing.hpp"
#include "models/mount_model.hpp"
#include "tests/cli/run_program.hpp"

using namespace wems;

namespace {

const std::string every_key = WEMS_SOURCE_DIR "/tests/models/data/every_key.toml";

void write(const std::string& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

/// A corner of a cube as binary STL: two triangles.
std::string makeBinaryStl() {
    std::string bytes(80, ' ');
    const auto append = [&bytes](const auto& value) {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        bytes.append(raw, sizeof value);
    };
    append(std::uint32_t{2});
    for (int triangle = 0; triangle < 2; ++triangle) {
        for (int i = 0; i < 3; ++i) append(0.0F);
        for (int i = 0; i < 9; ++i) append(static_cast<float>(10 * triangle + i));
        append(std::uint16_t{0});
    }
    return bytes;
}

}  // namespace

TEST_CASE("every key of a drawing lands in its place") {
    const std::vector<DrawnShape> drawing = readDrawing(every_key);
    REQUIRE(drawing.size() == 3);
    CHECK(drawing[0].kind == DrawnShape::Kind::box);
    CHECK(drawing[0].size == Eigen::Vector3d(0.2, 0.15, 0.1));
    CHECK(drawing[0].position == Eigen::Vector3d(0, 0, 0.06));
    CHECK(drawing[0].rotation == Eigen::Vector3d(0, 0, 0.1));
    CHECK(drawing[1].part == Part::fixed);
    CHECK(drawing[1].size == Eigen::Vector3d(0.3, 0.3, 0.02));
    CHECK(drawing[2].path == WEMS_SOURCE_DIR "/tests/models/data/part.stl");
    CHECK(drawing[2].scale == 0.001);
    CHECK(readDrawing(WEMS_SOURCE_DIR "/models/shipped/single_axis.toml").empty());
}

TEST_CASE("STL files, text and binary; what is none is refused") {
    const test::TemporaryDirectory folder;
    const std::string file = folder.path() + "/part.stl";
    write(file, makeBinaryStl());
    auto triangles = readStl(file);
    REQUIRE(triangles.cols() == 2);
    for (int i = 0; i < 9; ++i) CHECK(triangles(i, 1) == 10 + i);
    write(file,
          "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 2.5e0 0\nendloop\nendfacet\n"
          "endsolid s\n");
    triangles = readStl(file);
    REQUIRE(triangles.cols() == 1);
    CHECK(triangles(7, 0) == 2.5);
    for (const std::string& bad :
         {std::string("solid s\nvertex 0 0\n"), std::string("nothing"), makeBinaryStl().substr(0, 120),
          std::string("vertex 0 0 0 vertex 1 0 nan vertex 0 1 0")}) {
        write(file, bad);
        CHECK_THROWS_AS(readStl(file), InputError);
    }
    CHECK_THROWS_AS(readStl(folder.path() + "/none.stl"), InputError);
}

TEST_CASE("a drawing that makes no sense is refused with its line, by the model's reader too") {
    const test::TemporaryDirectory folder;
    const std::string file = folder.path() + "/model.toml";
    const auto [keys, words] = GENERATE(table<const char*, const char*>({
        {"shape = \"ball\"", "ball"},
        {"size = [1, 1, 1]", "shape"},
        {"shape = \"box\"\nsize = [1, 1]", "size"},
        {"shape = \"cylinder\"\nsize = [1, 0]", "above 0"},
        {"shape = \"stl\"", "file"},
        {"shape = \"box\"\nsize = [1, 1, 1]\ncolour = \"red\"", "colour"},
        {"part = \"base\"\nshape = \"box\"\nsize = [1, 1, 1]", "part"},
    }));
    std::ifstream stream(WEMS_SOURCE_DIR "/models/shipped/single_axis.toml");
    const std::string model(std::istreambuf_iterator<char>(stream), {});
    write(file, model + "\n[[drawing]]\n" + keys + "\n");
    CHECK_THROWS_WITH(readDrawing(file), Catch::Contains(words) && Catch::Contains("model.toml:"));
    CHECK_THROWS_WITH(readMountModel(file), Catch::Contains(words) && Catch::Contains("model.toml:"));
}
