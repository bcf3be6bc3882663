#include "models/common/units.hpp"

#include <algorithm>
#include <array>

namespace wems {

namespace {

// Exact by definition: inch (1959), standard gravity (CGPM 1901), avoirdupois pound times standard gravity.
constexpr double kInch = 0.0254;
constexpr double kStandardGravity = 9.80665;
constexpr double kPoundForce = 0.45359237 * kStandardGravity;

struct Unit {
    Quantity quantity;
    std::string_view name;
    double factor;
    bool listed;  ///< another spelling of a listed unit is read but not advertised
};

constexpr std::array<Unit, 41> kUnits = {{
    {Quantity::time, "s", 1, true},
    {Quantity::time, "sec", 1, false},
    {Quantity::time, "ms", 1e-3, true},
    {Quantity::time, "us", 1e-6, true},
    {Quantity::time, "\u00B5s", 1e-6, false},
    {Quantity::time, "\u03BCs", 1e-6, false},
    {Quantity::length, "m", 1, true},
    {Quantity::length, "mm", 1e-3, true},
    {Quantity::length, "um", 1e-6, true},
    {Quantity::length, "\u00B5m", 1e-6, false},
    {Quantity::length, "\u03BCm", 1e-6, false},
    {Quantity::length, "\xB5m", 1e-6, false},  // Latin-1
    {Quantity::length, "in", kInch, true},
    {Quantity::velocity, "m/s", 1, true},
    {Quantity::velocity, "mm/s", 1e-3, true},
    {Quantity::velocity, "um/s", 1e-6, false},
    {Quantity::velocity, "\u00B5m/s", 1e-6, false},
    {Quantity::velocity, "\u03BCm/s", 1e-6, false},
    {Quantity::velocity, "in/s", kInch, true},
    {Quantity::acceleration, "m/s^2", 1, true},
    {Quantity::acceleration, "m/s2", 1, false},
    {Quantity::acceleration, "m/s\u00B2", 1, false},
    {Quantity::acceleration, "m/s\xB2", 1, false},  // Latin-1
    {Quantity::acceleration, "m/s/s", 1, false},
    {Quantity::acceleration, "m/s**2", 1, false},
    {Quantity::acceleration, "m/sec^2", 1, false},
    {Quantity::acceleration, "mm/s^2", 1e-3, true},
    {Quantity::acceleration, "mm/s2", 1e-3, false},
    {Quantity::acceleration, "mm/s\u00B2", 1e-3, false},
    {Quantity::acceleration, "in/s^2", kInch, false},
    {Quantity::acceleration, "g", kStandardGravity, true},
    {Quantity::acceleration, "gn", kStandardGravity, false},
    {Quantity::force, "N", 1, true},
    {Quantity::force, "mN", 1e-3, false},
    {Quantity::force, "kN", 1e3, true},
    {Quantity::force, "lbf", kPoundForce, true},
    {Quantity::force, "lb", kPoundForce, true},
    {Quantity::force, "kip", 1e3 * kPoundForce, true},
    {Quantity::none, "-", 1, true},
    {Quantity::none, "", 1, false},
    {Quantity::none, "1", 1, false},
}};

const char* describe(Quantity quantity) {
    switch (quantity) {
        case Quantity::time:
            return "time";
        case Quantity::length:
            return "displacement";
        case Quantity::velocity:
            return "velocity";
        case Quantity::acceleration:
            return "acceleration";
        case Quantity::force:
            return "force";
        case Quantity::none:
            break;
    }
    return "quantity without unit";
}

}  // namespace

double findUnitFactor(std::string_view unit, Quantity quantity, const InputLocation& location) {
    const auto first = unit.find_first_not_of(" \t");
    unit = first == std::string_view::npos ? std::string_view{}
                                           : unit.substr(first, unit.find_last_not_of(" \t") - first + 1);
    for (const auto& known : kUnits) {
        if (known.quantity == quantity && known.name == unit) return known.factor;
    }
    throw InputError(location, "'" + std::string(unit) + "' is not a unit of " + describe(quantity),
                     listUnits(quantity));
}

bool isUnit(std::string_view unit) {
    return std::any_of(kUnits.begin(), kUnits.end(), [&](const Unit& known) { return known.name == unit; });
}

std::string listUnits(Quantity quantity) {
    std::string list;
    for (const auto& known : kUnits) {
        if (known.quantity != quantity || !known.listed) continue;
        if (!list.empty()) list += ", ";
        list += known.name;
    }
    return list;
}

const char* siUnit(Quantity quantity) {
    switch (quantity) {
        case Quantity::time:
            return "s";
        case Quantity::length:
            return "m";
        case Quantity::velocity:
            return "m/s";
        case Quantity::acceleration:
            return "m/s^2";
        case Quantity::force:
            return "N";
        case Quantity::none:
            break;
    }
    return "-";
}

}  // namespace wems
