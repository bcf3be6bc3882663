/// @file
/// How well the numbers of a model are known: ± values, read as two standard deviations; 0 = exactly known.
///
/// The table [tolerance] of a model holds them for the whole model, `tolerance = { … }` inside a table for that item
/// alone. What neither gives has a default.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace wems {

/// What a tolerance is of; the order is that of kToleranceKeys.
enum class ToleranceOf {
    mass,
    center_of_gravity,
    inertia,
    stiffness,
    damping,
    clearance,
    stop_stiffness,
    position,
    mode_frequency,
    mode_damping_ratio,
    mode_shape,
    load_gain,
    sensor_gain,
    sensor_rotation,
    sensor_position,
    sensor_delay
};

struct ToleranceKey {
    const char* key;    ///< in the model file
    double standard;    ///< what an absent key means
    const char* unit;   ///< SI; `-` of a relative one
    const char* table;  ///< where it may stand for one item alone; empty: nowhere
};

/// Each key told once: reading, writing and the reference follow from this table.
inline constexpr std::array<ToleranceKey, 16> kToleranceKeys{{
    {"mass", 0.005, "-", "body"},
    {"center_of_gravity", 1e-3, "m", "body"},
    {"inertia", 0.05, "-", "body"},  // a product of inertia: of the geometric mean of its two moments
    {"stiffness", 0.10, "-", "axis"},
    {"damping", 0.30, "-", "axis"},
    {"clearance", 0.05, "-", "axis"},
    {"stop_stiffness", 0.15, "-", "axis"},
    {"position", 5e-4, "m", "connection"},
    {"mode_frequency", 0.02, "-", "mode"},
    {"mode_damping_ratio", 0.50, "-", "mode"},
    {"mode_shape", 0.05, "-", "mode"},  // of the largest entry of the mode that has the same unit
    {"load_gain", 0.01, "-", ""},
    {"sensor_gain", 0.01, "-", "sensor"},
    {"sensor_rotation", 0.01, "rad", "sensor"},
    {"sensor_position", 1e-3, "m", "sensor"},
    {"sensor_delay", 2e-5, "s", "sensor"},
}};

constexpr const ToleranceKey& keyOf(ToleranceOf what) {
    return kToleranceKeys[static_cast<std::size_t>(what)];
}

/// The tolerances that a model gives, for itself or for one item. Default-constructed: none.
class Tolerances {
public:
    std::optional<double> find(ToleranceOf what) const { return given_[static_cast<std::size_t>(what)]; }
    /// In the key's unit; ≥ 0 (checked by validate()). nullopt: not given.
    void set(ToleranceOf what, std::optional<double> value) { given_[static_cast<std::size_t>(what)] = value; }
    bool empty() const { return *this == Tolerances(); }

    friend bool operator==(const Tolerances& a, const Tolerances& b) { return a.given_ == b.given_; }
    friend bool operator!=(const Tolerances& a, const Tolerances& b) { return !(a == b); }

private:
    std::array<std::optional<double>, kToleranceKeys.size()> given_;
};

}  // namespace wems
