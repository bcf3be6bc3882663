#include "models/axis_law.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "models/axis_numbers.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"

namespace wems {

namespace {

std::optional<LawProblem> findNonFinite(const std::string& key, double value) {
    if (std::isfinite(value)) return std::nullopt;
    return LawProblem{key, "is " + formatNumber(value), "a finite number"};
}

std::optional<LawProblem> findNegative(const std::string& key, double value, const std::string& unit) {
    if (std::isfinite(value) && value >= 0) return std::nullopt;
    return LawProblem{key, "is " + formatNumber(value), "a number from 0 on" + unit};
}

std::optional<LawProblem> findNotPositive(const std::string& key, double value, const std::string& unit) {
    if (std::isfinite(value) && value > 0) return std::nullopt;
    return LawProblem{key, "is " + formatNumber(value), "a number above 0" + unit};
}

/// A quotient or product that the law computes with, and that two numbers accepted one by one can carry beyond all
/// numbers.
std::optional<LawProblem> findOverflow(const std::string& key, double value, double computed, const std::string& what) {
    if (std::isfinite(computed)) return std::nullopt;
    return LawProblem{key, "is " + formatNumber(value), "what leaves " + what + " finite"};
}

std::optional<LawProblem> findStopProblem(const Stop& stop, const std::string& prefix) {
    if (auto p = findNotPositive(prefix + "clearance", stop.clearance, ", m")) return p;
    if (auto p = findNonFinite(prefix + "stiffness", stop.stiffness)) return p;
    return findNegative(prefix + "dissipation", stop.dissipation, ", s/m");
}

std::optional<LawProblem> findFrictionProblem(const Friction& friction) {
    if (auto p = findNegative("friction.force", friction.force, ", N")) return p;
    if (auto p = findNotPositive("friction.transition_velocity", friction.transition_velocity, ", m/s")) return p;
    if (auto p = findOverflow("friction.transition_velocity", friction.transition_velocity,
                              1 / friction.transition_velocity, "its reciprocal"))
        return p;
    if (!friction.presliding_stiffness) return std::nullopt;
    return findNotPositive("friction.presliding_stiffness", *friction.presliding_stiffness, ", N/m");
}

std::optional<LawProblem> findOutside(const std::string& key, double value, double lower, double upper) {
    if (value >= lower && value <= upper) return std::nullopt;
    return LawProblem{key, "is " + formatNumber(value), formatNumber(lower) + " to " + formatNumber(upper)};
}

std::optional<LawProblem> findHysteresisProblem(const Hysteresis& hysteresis) {
    if (auto p = findNegative("hysteresis.force", hysteresis.force, ", N")) return p;
    if (auto p = findNotPositive("hysteresis.yield_displacement", hysteresis.yield_displacement, ", m")) return p;
    if (auto p = findOverflow("hysteresis.yield_displacement", hysteresis.yield_displacement,
                              hysteresis.force / hysteresis.yield_displacement, "force / yield_displacement"))
        return p;
    if (auto p = findOutside("hysteresis.exponent", hysteresis.exponent, 1, Hysteresis::sharpest)) return p;
    auto p = findOutside("hysteresis.shape", hysteresis.shape, 0.5, 1);
    if (p) p->accepted += ", since less would give back more energy than its spring holds";
    return p;
}

std::optional<LawProblem> findBranchProblem(const MaxwellBranch& branch, const std::string& prefix) {
    if (auto p = findNegative(prefix + "stiffness", branch.stiffness, ", N/m")) return p;
    return findNotPositive(prefix + "time_constant", branch.time_constant, ", s");
}

/// @param stiffness of the axis, N/m
std::optional<LawProblem> findRelaxationProblem(const Relaxation& relaxation, double stiffness,
                                                const std::string& prefix) {
    if (auto p = findNegative(prefix + "stiffness_ratio", relaxation.stiffness_ratio, "")) return p;
    if (auto p = findNotPositive(prefix + "time_constant", relaxation.time_constant, ", s")) return p;
    if (auto p = findOverflow(prefix + "stiffness_ratio", relaxation.stiffness_ratio,
                              relaxation.stiffness_ratio * stiffness, "its product with the stiffness"))
        return p;
    return findOverflow(prefix + "time_constant", relaxation.time_constant, 1 / relaxation.time_constant,
                        "its reciprocal");
}

std::optional<LawProblem> findSliderProblem(const Slider& slider, const std::string& prefix) {
    if (auto p = findNegative(prefix + "force", slider.force, ", N")) return p;
    if (auto p = findNotPositive(prefix + "yield_displacement", slider.yield_displacement, ", m")) return p;
    if (auto p = findNegative(prefix + "gap", slider.gap, ", m")) return p;
    if (auto p = findNegative(prefix + "negative_force", slider.negative_force.value_or(0), ", N")) return p;
    return findOutside(prefix + "exponent", slider.exponent.value_or(1), 1, Hysteresis::sharpest);
}

/// Of a list of parts, each with its own check; no more of them than `most`.
template <class Item, class Check>
std::optional<LawProblem> findListProblem(const std::vector<Item>& items, const std::string& key, std::size_t most,
                                          const Check& check) {
    if (items.size() > most)
        return LawProblem{key, "has " + std::to_string(items.size()) + " entries", std::to_string(most) + " at most"};
    for (std::size_t i = 0; i < items.size(); ++i)
        if (auto p = check(items[i], key + "[" + std::to_string(i) + "].")) return p;
    return std::nullopt;
}

}  // namespace

std::optional<LawProblem> findProblem(const AxisLaw& law) {
    for (const AxisNumber& number : kAxisNumbers) {
        const double value = law.*number.member;
        const std::string unit = number.unit;
        auto problem = number.range == AxisNumber::Range::any
                           ? findNonFinite(number.key, value)
                           : findNegative(number.key, value, unit == "-" ? "" : ", " + unit);
        if (problem) return problem;
    }
    if (law.loss_factor >= largestLossFactor()) {
        return LawProblem{"loss_factor", "is " + formatNumber(law.loss_factor),
                          "0 to below " + formatNumber(largestLossFactor(), 3) +
                              ", since its Maxwell branches would leave no static stiffness"};
    }
    if (law.relaxation) {
        if (auto p = findRelaxationProblem(*law.relaxation, law.stiffness, "relaxation.")) return p;
    }
    if (law.friction) {
        if (auto p = findFrictionProblem(*law.friction)) return p;
    }
    if (law.hysteresis) {
        if (auto p = findHysteresisProblem(*law.hysteresis)) return p;
    }
    if (auto p = findListProblem(law.branches, "branches", kMostBranches, findBranchProblem)) return p;
    const auto check = [&](const Relaxation& part, const std::string& prefix) {
        return findRelaxationProblem(part, law.stiffness, prefix);
    };
    if (auto p = findListProblem(law.spectrum, "spectrum", kMostBranches - law.branches.size(), check)) return p;
    if (auto p = findListProblem(law.sliders, "sliders", kMostSliders, findSliderProblem)) return p;
    if (!law.curve.empty()) {
        if (const auto p = findProblem(law.curve))
            return LawProblem{p->row < 0 ? "curve" : "curve[" + std::to_string(p->row) + "]", p->problem, p->accepted};
    }
    return findListProblem(law.stops, "stops", law.stops.size(), findStopProblem);
}

void moveSlopeToStiffness(AxisLaw& law) {
    const double slope = ForceCurve(law.curve).calcStiffness(0);
    if (!(slope > 0)) return;
    law.curve = subtractSpring(std::move(law.curve), slope);
    law.stiffness += slope;
}

AxisForce::AxisForce(const AxisLaw& law) : law_(law), curve_(law.curve), static_stiffness_(law.stiffness) {
    if (law.relaxation) {
        branches_.push_back({law.relaxation->stiffness_ratio * law.stiffness, law.relaxation->time_constant});
    }
    branches_.insert(branches_.end(), law.branches.begin(), law.branches.end());
    for (const Relaxation& part : law.spectrum)
        branches_.push_back({part.stiffness_ratio * law.stiffness, part.time_constant});
    if (law.loss_factor > 0) {
        const double loss_modulus = law.loss_factor * law.stiffness;
        for (const MaxwellBranch& unit : structuralBranches().branch) {
            branches_.push_back({loss_modulus * unit.stiffness, unit.time_constant});
        }
        static_stiffness_ -= loss_modulus * structuralBranches().storage_in_middle;
    }
    for (const Stop& stop : law.stops) {
        contacts_.push_back(
            {stop.side == Side::positive ? 1.0 : -1.0, stop.clearance, stop.stiffness, stop.dissipation});
    }
    if (law.friction) {
        friction_force_ = law.friction->force;
        transition_velocity_ = law.friction->transition_velocity;
        presliding_stiffness_ = law.friction->presliding_stiffness.value_or(0);
        shape_.bristle = law.friction->presliding_stiffness.has_value();
        shape_.sliding = !shape_.bristle;
    }
    shape_.hystereses = (law.hysteresis ? 1 : 0) + static_cast<int>(law.sliders.size());
    shape_.stops = static_cast<int>(contacts_.size());
    shape_.branches = static_cast<int>(branches_.size());
    shape_.curve_segments = curve_.segments();
    collectConstants();
}

void AxisForce::collectConstants() {
    constants_ = {static_stiffness_, law_.stiffness * law_.drift, law_.quadratic, law_.cubic, law_.damping};
    for (const Contact& stop : contacts_) {
        constants_.insert(constants_.end(), {stop.direction, stop.direction * law_.offset - stop.clearance,
                                             stop.direction * stop.stiffness, stop.direction * stop.dissipation});
    }
    if (shape_.sliding) constants_.insert(constants_.end(), {friction_force_, 1 / transition_velocity_});
    for (const MaxwellBranch& branch : branches_)
        constants_.insert(constants_.end(), {branch.stiffness, 1 / branch.time_constant});
    if (shape_.bristle) {
        // Without any sliding force the bristle never stretches.
        const bool stretches = friction_force_ > 0;
        constants_.insert(
            constants_.end(),
            {presliding_stiffness_, stretches ? friction_force_ / presliding_stiffness_ : 1.0, stretches ? 1.0 : 0.0});
    }
    if (law_.hysteresis) {
        const Hysteresis& hysteresis = *law_.hysteresis;
        const double stiffness = hysteresis.force / hysteresis.yield_displacement;
        constants_.insert(constants_.end(), {stiffness, hysteresis.yield_displacement, hysteresis.exponent,
                                             2 * hysteresis.shape - 1, stiffness, 0.0});
    }
    for (const Slider& slider : law_.sliders) {
        const double yield = slider.yield_displacement;
        constants_.insert(constants_.end(), {slider.force / yield, yield + 0.5 * slider.gap,
                                             slider.exponent.value_or(std::numeric_limits<double>::infinity()), 0.0,
                                             slider.negative_force.value_or(slider.force) / yield, 0.5 * slider.gap});
    }
    curve_.appendConstants(constants_);
}

double AxisForce::calcForce(double q, double v, double t, const double* z) const {
    const auto closed = [](int, double penetration) { return penetration > 0 ? 1.0 : 0.0; };
    return calcAxisForce(shape_, constants_.data(), closed, q, v, t, z);
}

double AxisForce::calcStiffness(double q, double v, double t, const double*) const {
    double stiffness =
        calcElastomerStiffness(t) + (2 * law_.quadratic + 3 * law_.cubic * q) * q + curve_.calcStiffness(q);
    for (const Contact& stop : contacts_) {
        if (calcPenetration(stop, q) > 0) {
            stiffness += stop.stiffness * std::max(0.0, 1 + stop.dissipation * stop.direction * v);
        }
    }
    for (const MaxwellBranch& branch : branches_) stiffness += branch.stiffness;
    return stiffness;
}

double AxisForce::calcDamping(double q, double v, double, const double*) const {
    double damping = law_.damping;
    for (const Contact& stop : contacts_) {
        const double penetration = calcPenetration(stop, q);
        if (penetration > 0 && 1 + stop.dissipation * stop.direction * v > 0) {
            damping += stop.stiffness * penetration * stop.dissipation;
        }
    }
    if (shape_.sliding) {
        const double tanh = std::tanh(v / transition_velocity_);
        damping += friction_force_ / transition_velocity_ * (1 - tanh * tanh);
    }
    return damping;
}

double AxisForce::calcPotential(double q, double t, const double* z) const {
    double energy = (0.5 * calcElastomerStiffness(t) + (law_.quadratic / 3 + 0.25 * law_.cubic * q) * q) * q * q +
                    curve_.calcPotential(q);
    for (const Contact& stop : contacts_) {
        const double penetration = std::max(0.0, calcPenetration(stop, q));
        energy += 0.5 * stop.stiffness * penetration * penetration;
    }
    for (const MaxwellBranch& branch : branches_) {
        const double stretch = q - *z++;
        energy += 0.5 * branch.stiffness * stretch * stretch;
    }
    if (shape_.bristle) {
        energy += 0.5 * presliding_stiffness_ * *z * *z;
        ++z;
    }
    for (int i = 0; i < shape_.hystereses; ++i, ++z) {
        const double* c = hysteresisConstants(i);
        const double over = positivePart(*z - c[5]), under = positivePart(-*z - c[5]);
        energy += 0.5 * (c[0] * over * over + c[4] * under * under);
    }
    return energy;
}

double AxisForce::calcDissipatedPower(double q, double v, double, const double* z) const {
    double power = law_.damping * v * v;
    for (const Contact& stop : contacts_) {
        const double penetration = calcPenetration(stop, q);
        if (penetration > 0) {
            const double rate = stop.direction * v;
            power += stop.stiffness * penetration * rate * std::max(-1.0, stop.dissipation * rate);
        }
    }
    if (shape_.sliding) power += friction_force_ * v * std::tanh(v / transition_velocity_);
    for (const MaxwellBranch& branch : branches_) {
        const double stretch = q - *z++;
        power += branch.stiffness * stretch * stretch / branch.time_constant;
    }
    // Of what is dragged: its force times the part of v that does not stretch it.
    if (shape_.bristle) {
        const double force = presliding_stiffness_ * *z++;
        if (friction_force_ > 0) power += std::abs(v) * force * force / friction_force_;
    }
    for (int i = 0; i < shape_.hystereses; ++i, ++z) {
        const double* c = hysteresisConstants(i);
        power += calcHysteresisForce(c, *z) * (v - calcHysteresisRate(c, v < 0 ? -1.0 : 1.0, v, *z));
    }
    return power;
}

void AxisForce::calcStateDerivative(double q, double v, const double* z, double* zdot) const {
    std::array<double, kMostStates> directions{};
    directions.fill(v < 0 ? -1.0 : 1.0);
    calcAxisStateRates(shape_, constants_.data(), directions.data(), q, v, z, zdot);
}

void AxisForce::dragStates(double travel, double* z) const {
    const double direction = travel < 0 ? -1.0 : 1.0;
    for (int i = 0; i < shape_.draggedCount(); ++i) {
        double& stretch = z[shape_.branches + i];
        stretch = calcDragged(shape_, constants_.data(), i, direction, stretch, travel);
    }
}

double AxisForce::draggedStiffness(bool largest) const {
    double stiffness = shape_.bristle ? presliding_stiffness_ : 0;
    for (int i = 0; i < shape_.hystereses; ++i) {
        const double* c = hysteresisConstants(i);
        if (largest || c[5] == 0) stiffness += std::max(c[0], c[4]);
    }
    return stiffness;
}

double AxisForce::calcStaticForce(double q) const {
    double f = (static_stiffness_ + (law_.quadratic + law_.cubic * q) * q) * q + curve_.calcForce(q);
    for (const Contact& stop : contacts_) {
        f += stop.direction * stop.stiffness * std::max(0.0, calcPenetration(stop, q));
    }
    return f;
}

double AxisForce::calcStaticStiffness(double q) const {
    double stiffness = static_stiffness_ + (2 * law_.quadratic + 3 * law_.cubic * q) * q + curve_.calcStiffness(q);
    for (const Contact& stop : contacts_) {
        if (calcPenetration(stop, q) > 0) stiffness += stop.stiffness;
    }
    return stiffness;
}

namespace {

constexpr double corner_ratio = 4.89;
constexpr int fit_points = 41;

StructuralBranches calcBranches() {
    const Band band = structuralBand();
    const double middle = std::sqrt(band.lower * band.upper);
    StructuralBranches result{};
    for (int j = 0; j < 3; ++j) {
        result.branch[j].time_constant = 1 / (kTwoPi * middle * std::pow(corner_ratio, j - 1));
    }
    Eigen::Matrix<double, fit_points, 3> loss;
    for (int i = 0; i < fit_points; ++i) {
        const double omega = kTwoPi * band.lower * std::pow(band.upper / band.lower, i / (fit_points - 1.0));
        for (int j = 0; j < 3; ++j) {
            const double u = omega * result.branch[j].time_constant;
            loss(i, j) = u / (1 + u * u);
        }
    }
    const Eigen::Vector3d stiffness = loss.colPivHouseholderQr().solve(Eigen::Matrix<double, fit_points, 1>::Ones());
    for (int j = 0; j < 3; ++j) {
        MaxwellBranch& branch = result.branch[j];
        branch.stiffness = stiffness[j];
        const double u = kTwoPi * middle * branch.time_constant;
        result.storage_in_middle += branch.stiffness * u * u / (1 + u * u);
    }
    return result;
}

}  // namespace

Band structuralBand() {
    return {5.0, 50.0};
}

double largestLossFactor() {
    return 1 / structuralBranches().storage_in_middle;
}

const StructuralBranches& structuralBranches() {
    static const StructuralBranches branches = calcBranches();
    return branches;
}

}  // namespace wems
