#include "models/device_drawing.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
#include "models/common/toml_table.hpp"

namespace wems {
namespace {

constexpr std::size_t kMostTriangles = 50000;              // 450 000 numbers: 3 MB of page
constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;  // bytes

using Triangles = Eigen::Matrix<double, 9, Eigen::Dynamic>;

void checkTriangles(std::size_t count, const std::string& file) {
    if (count > 0 && count <= kMostTriangles) return;
    throw InputError({file, 0, {}}, "holds " + std::to_string(count) + " triangles",
                     "1 to " + std::to_string(kMostTriangles));
}

bool isBinary(std::string_view bytes, std::uint32_t& count) {
    if (bytes.size() < kStlHeader) return false;
    std::memcpy(&count, bytes.data() + kStlHeader - sizeof count, sizeof count);
    return bytes.size() == kStlHeader + kStlTriangle * count;
}

Triangles readBinary(std::string_view bytes, std::size_t count) {
    Triangles triangles(9, count);
    constexpr std::size_t normal = 12;  // bytes, before the corners
    for (Eigen::Index k = 0; k < triangles.cols(); ++k) {
        float corners[9];
        std::memcpy(corners, bytes.data() + kStlHeader + kStlTriangle * static_cast<std::size_t>(k) + normal,
                    sizeof corners);
        for (Eigen::Index i = 0; i < 9; ++i) triangles(i, k) = corners[i];
    }
    return triangles;
}

/// Words after each `vertex`. @return false at a word that is no number
bool readText(const std::string& text, std::vector<double>& numbers) {
    constexpr std::string_view word = "vertex";
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at)) {
        const char* from = text.c_str() + at + word.size();
        for (int i = 0; i < 3; ++i) {
            char* end = nullptr;
            numbers.push_back(std::strtod(from, &end));
            if (end == from) return false;
            from = end;
        }
        at = static_cast<std::size_t>(from - text.c_str());
    }
    return !numbers.empty() && numbers.size() % 9 == 0;
}

}  // namespace

const char* nameShape(DrawnShape::Kind kind) {
    switch (kind) {
        case DrawnShape::Kind::box:
            return "box";
        case DrawnShape::Kind::plate:
            return "plate";
        case DrawnShape::Kind::cylinder:
            return "cylinder";
        case DrawnShape::Kind::stl:
            break;
    }
    return "stl";
}

DrawnShape readShape(TomlTable& table, const std::string& file) {
    using Kind = DrawnShape::Kind;
    DrawnShape shape;
    const std::string part = table.findString("part").value_or("mobile");
    if (part != "mobile" && part != "fixed") table.fail("part", "is \"" + part + "\"", "mobile, fixed");
    shape.part = part == "mobile" ? Part::mobile : Part::fixed;
    const std::string accepted = "box, plate, cylinder, stl", kind = table.requireString("shape", accepted);
    bool known = false;
    for (const Kind candidate : {Kind::box, Kind::plate, Kind::cylinder, Kind::stl}) {
        if (kind != nameShape(candidate)) continue;
        shape.kind = candidate;
        known = true;
    }
    if (!known) table.fail("shape", "is \"" + kind + "\"", accepted);
    if (shape.kind == Kind::stl) {
        const std::string name = table.requireString("file", "the name of an STL file, beside the model");
        shape.path = (std::filesystem::path(file).parent_path() / name).string();
        shape.scale = table.findNumber("scale").value_or(1);
        if (!(shape.scale > 0)) table.fail("scale", "is not above 0", "a number above 0, m");
    } else {
        const bool round = shape.kind == Kind::cylinder;
        const std::string lengths = round ? "diameter and length, m" : "three lengths along x, y, z, m";
        const auto size = table.requireNumbers("size", {round ? 2UL : 3UL}, lengths);
        for (const double length : size)
            if (!(length > 0)) table.fail("size", "is not above 0", "lengths above 0, m");
        shape.size = {size[0], round ? size[0] : size[1], size.back()};
    }
    shape.position = table.findVector("position").value_or(Eigen::Vector3d::Zero());
    shape.rotation = table.findVector("rotation").value_or(Eigen::Vector3d::Zero());
    return shape;
}

std::vector<DrawnShape> readDrawing(const std::string& model_file) {
    const TextFile text(model_file);
    const toml::table parsed = parseToml(text.view(), model_file);
    TomlPlaces places{model_file, {}};
    TomlTable root(parsed, "", places);
    std::vector<DrawnShape> drawing;
    root.readTables("drawing", [&](TomlTable& table) { drawing.push_back(readShape(table, model_file)); });
    return drawing;
}

Triangles readStl(const std::string& file) {
    const TextFile bytes(file);
    Triangles triangles;
    std::uint32_t count = 0;
    if (isBinary(bytes.view(), count)) {
        checkTriangles(count, file);
        triangles = readBinary(bytes.view(), count);
    } else {
        std::vector<double> numbers;
        if (!readText(std::string(bytes.view()), numbers))
            throw InputError({file, 0, {}}, "is no STL", "an STL file, text or binary");
        checkTriangles(numbers.size() / 9, file);
        triangles = Eigen::Map<const Triangles>(numbers.data(), 9, numbers.size() / 9);
    }
    if (!triangles.allFinite()) throw InputError({file, 0, {}}, "holds a corner that is not finite", "finite numbers");
    return triangles;
}

}  // namespace wems
