#include "models/law_equality.hpp"

#include <tuple>

namespace wems {
namespace {

// Structured bindings, so that a parameter that is added to a struct does not compile until it is compared here.

auto valuesOf(const Stop& stop) {
    const auto& [side, clearance, stiffness, dissipation] = stop;
    return std::tie(side, clearance, stiffness, dissipation);
}

auto valuesOf(const Relaxation& relaxation) {
    const auto& [stiffness_ratio, time_constant] = relaxation;
    return std::tie(stiffness_ratio, time_constant);
}

auto valuesOf(const Friction& friction) {
    const auto& [force, transition_velocity, presliding_stiffness] = friction;
    return std::tie(force, transition_velocity, presliding_stiffness);
}

auto valuesOf(const Hysteresis& hysteresis) {
    const auto& [force, yield_displacement, exponent, shape] = hysteresis;
    return std::tie(force, yield_displacement, exponent, shape);
}

auto valuesOf(const MaxwellBranch& branch) {
    const auto& [stiffness, time_constant] = branch;
    return std::tie(stiffness, time_constant);
}

auto valuesOf(const Slider& slider) {
    const auto& [force, yield_displacement, gap, negative_force, exponent] = slider;
    return std::tie(force, yield_displacement, gap, negative_force, exponent);
}

auto valuesOf(const CurveRow& row) {
    const auto& [displacement, force, stiffness] = row;
    return std::tie(displacement, force, stiffness);
}

auto valuesOf(const AxisLaw& law) {
    const auto& [stiffness, damping, offset, quadratic, cubic, loss_factor, drift, relaxation, friction, hysteresis,
                 branches, spectrum, sliders, curve, stops] = law;
    return std::tie(stiffness, damping, offset, quadratic, cubic, loss_factor, drift, relaxation, friction, hysteresis,
                    branches, spectrum, sliders, curve, stops);
}

}  // namespace

bool operator==(const Stop& a, const Stop& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const Relaxation& a, const Relaxation& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const Friction& a, const Friction& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const Hysteresis& a, const Hysteresis& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const MaxwellBranch& a, const MaxwellBranch& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const Slider& a, const Slider& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const CurveRow& a, const CurveRow& b) {
    return valuesOf(a) == valuesOf(b);
}

bool operator==(const AxisLaw& a, const AxisLaw& b) {
    return valuesOf(a) == valuesOf(b);
}

}  // namespace wems
