/// @file
/// What drives a hidden device and what is recorded of it.
#pragma once

#include <Eigen/Core>
#include <string>

namespace wems::hidden {

/// How a device is held and driven.
struct SetUp {
    enum class Kind { bracket, base, axis };
    Kind kind = Kind::bracket;
    /// base: the table's acceleration, or the motion of the connections' fixed ends, or both are recorded.
    /// axis: the table's acceleration or the fixed end, when base-driven.
    bool records_base = false, records_fixed = true;
    /// axis: a shaker table, otherwise the load acts on the mobile part.
    bool shaken = false;

    bool baseDriven() const { return kind == Kind::base || (kind == Kind::axis && shaken); }
    bool loaded() const { return !baseDriven(); }
    /// The mobile part moves along z alone.
    bool oneAxis() const { return kind == Kind::axis; }
};

/// `bracket`, `base: base`, `base: fixed`, `base: both`, `axis: load`, `axis: base`, `axis: fixed`
inline std::string formatSetUp(const SetUp& set_up) {
    const std::string recorded = set_up.records_base ? (set_up.records_fixed ? "both" : "base") : "fixed";
    if (set_up.kind == SetUp::Kind::bracket) return "bracket";
    if (set_up.kind == SetUp::Kind::base) return "base: " + recorded;
    return "axis: " + (set_up.shaken ? recorded : "load");
}

}  // namespace wems::hidden
