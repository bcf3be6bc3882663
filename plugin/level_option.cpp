#include "plugin/level_option.hpp"

#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "models/error.hpp"

namespace wems::plugin {
namespace {

std::string accepted(Quantity quantity) {
    return std::string("axes and values such as z=200 or x=100,y=100; units: ") + listUnits(quantity);
}

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts;
    std::stringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    if (text.empty() || text.back() == ',') parts.emplace_back();
    return parts;
}

int findAxis(const std::string& name) {
    return name.size() == 1 && name[0] >= 'x' && name[0] <= 'z' ? name[0] - 'x' : -1;
}

}  // namespace

double parseQuantity(const std::string& text, Quantity quantity, const std::string& option, bool* with_unit) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end == text.c_str() || !std::isfinite(value))
        throw InputError({"", 0, option}, "`" + text + "` is not a number", accepted(quantity));
    const std::string unit = end;
    if (unit.empty()) return value;
    if (with_unit != nullptr) *with_unit = true;
    return value * findUnitFactor(unit, quantity, {"", 0, option});
}

Level parseLevel(const std::string& text, const std::string& option, Quantity quantity) {
    Level level;
    std::set<int> given;
    for (const std::string& part : split(text)) {
        const auto equals = part.find('=');
        const int axis = findAxis(part.substr(0, equals));
        if (axis < 0) throw InputError({"", 0, option}, "`" + part + "` is not understood", accepted(quantity));
        if (!given.insert(axis).second)
            throw InputError({"", 0, option}, "`" + part.substr(0, 1) + "` is given twice", accepted(quantity));
        if (equals == std::string::npos) {
            level.bare = true;
            level.value[axis] = 1;
        } else {
            level.value[axis] = parseQuantity(part.substr(equals + 1), quantity, option, &level.with_unit);
        }
    }
    if (level.value.isZero()) throw InputError({"", 0, option}, "excites nothing", accepted(quantity));
    return level;
}

std::vector<Level> parseLevels(const std::string& text, const std::string& option, Quantity quantity) {
    const std::vector<std::string> parts = split(text);
    bool list = parts.size() > 1 && parts[0].find('=') != std::string::npos;
    for (std::size_t i = 1; i < parts.size(); ++i) list = list && parts[i].find('=') == std::string::npos;
    if (!list) return {parseLevel(text, option, quantity)};
    std::vector<Level> levels;
    const std::string axis = parts[0].substr(0, parts[0].find('=') + 1);
    for (std::size_t i = 0; i < parts.size(); ++i)
        levels.push_back(parseLevel(i == 0 ? parts[i] : axis + parts[i], option, quantity));
    return levels;
}

}  // namespace wems::plugin
