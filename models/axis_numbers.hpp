/// @file
/// The parameters of an axis law that are single numbers, each told once: reading, writing, range, name, unit and sign
/// follow from this table. Mechanisms of several numbers (relaxation, friction, stops) are not in it.
#pragma once

#include <array>
#include <string_view>

#include "models/axis_law.hpp"

namespace wems {

struct AxisNumber {
    const char* key;  ///< in the model file, and the last part of the parameter's name
    double AxisLaw::*member;
    const char* unit;  ///< SI; `-` if it has none
    enum class Range { not_negative, any } range;
    enum class Presence { required, optional } presence;  ///< absent = 0
};

/// In the order in which a model file holds them.
inline constexpr std::array<AxisNumber, 7> kAxisNumbers{{
    {"stiffness", &AxisLaw::stiffness, "N/m", AxisNumber::Range::not_negative, AxisNumber::Presence::required},
    {"damping", &AxisLaw::damping, "N s/m", AxisNumber::Range::not_negative, AxisNumber::Presence::optional},
    {"offset", &AxisLaw::offset, "m", AxisNumber::Range::any, AxisNumber::Presence::optional},
    {"quadratic", &AxisLaw::quadratic, "N/m^2", AxisNumber::Range::any, AxisNumber::Presence::optional},
    {"cubic", &AxisLaw::cubic, "N/m^3", AxisNumber::Range::any, AxisNumber::Presence::optional},
    {"loss_factor", &AxisLaw::loss_factor, "-", AxisNumber::Range::not_negative, AxisNumber::Presence::optional},
    {"drift", &AxisLaw::drift, "1/s", AxisNumber::Range::any, AxisNumber::Presence::optional},
}};

/// The entry of a key; nullptr if it is none of them.
constexpr const AxisNumber* findAxisNumber(std::string_view key) {
    for (const AxisNumber& number : kAxisNumbers)
        if (number.key == key) return &number;
    return nullptr;
}

}  // namespace wems
