#include "identify/component/law_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "identify/component/block_regression.hpp"
#include "identify/component/curve_basis.hpp"
#include "models/common/non_negative.hpp"
#include "models/sampled_motion.hpp"

namespace wems::identify {
namespace {

using Memory = LawTerms::Memory;

// Cells of a force curve over the whole travel: a cubic in each. The knee of a stop is round over one of them. On four
// public records of elastomers 8 leave up to a fifth more than 12; of 18, 86 samples could not tell as many weights.
constexpr int kCurveCells = 12;

/// A part of a law: what its weight multiplies, and where that goes.
struct WeightedPart {
    AxisLaw unit;  ///< the law with a weight of one; nothing: a constant force
    bool bounded = true;
    Eigen::VectorXd values = {};
};

AxisLaw withStiffness(double AxisLaw::*member) {
    AxisLaw law;
    law.*member = 1;
    return law;
}

AxisLaw withSlider(double positive, double negative, double yield, double gap, std::optional<double> exponent = {}) {
    AxisLaw law;
    law.sliders.push_back({positive, yield, gap, negative, exponent});
    return law;
}

/// All tests one below the other.
class TestStack {
public:
    explicit TestStack(const std::vector<ComponentData>& tests) : tests_(tests) {
        Eigen::Index count = 0;
        for (const ComponentData& test : tests) {
            starts.push_back(count);
            count += test.count();
            range = std::max(range, 0.5 * (test.q.maxCoeff() - test.q.minCoeff()));
            lowest = std::min(lowest, test.q.minCoeff());
            highest = std::max(highest, test.q.maxCoeff());
            duration = std::max(duration, test.time[test.count() - 1] - test.time[0]);
            interval = std::min(interval, (test.time[test.count() - 1] - test.time[0]) /
                                              static_cast<double>(std::max<Eigen::Index>(1, test.count() - 1)));
            has_velocity = has_velocity && test.has_velocity;
        }
        force.resize(count);
        for (std::size_t r = 0; r < tests.size(); ++r) force.segment(starts[r], tests[r].count()) = tests[r].force;
        spread = (force.array() - force.mean()).matrix().norm();
    }

    Eigen::VectorXd calc(const AxisLaw& law) const {
        Eigen::VectorXd values(force.size());
        for (std::size_t r = 0; r < tests_.size(); ++r)
            values.segment(starts[r], tests_[r].count()) =
                calcForceAlong(law, tests_[r].time, tests_[r].q, tests_[r].velocity);
        return values;
    }

    std::vector<Eigen::Index> starts;
    Eigen::VectorXd force;
    double range = 0, duration = 0, interval = std::numeric_limits<double>::infinity(), spread = 0;
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;  // displacements
    bool has_velocity = true;

private:
    const std::vector<ComponentData>& tests_;
};

/// Weights of columns, and what they leave.
struct Weights {
    Eigen::VectorXd value;
    double cost = 0;
};

Weights solveWeights(const TestStack& problem, const std::vector<WeightedPart>& columns) {
    const Eigen::Index count = columns.size();
    Eigen::MatrixXd X(problem.force.size(), count);
    Eigen::VectorXd scale(count);
    std::vector<bool> bounded;
    for (Eigen::Index j = 0; j < count; ++j) {
        const WeightedPart& column = columns[j];
        const double norm = column.values.norm();
        scale[j] = norm > 0 ? norm : 1;
        X.col(j) = column.values / scale[j];
        bounded.push_back(column.bounded);
    }
    const Eigen::VectorXd right = X.transpose() * problem.force;
    Weights weights;
    weights.value = solveNonNegative(X.transpose() * X, right, bounded);
    weights.cost = (problem.force - X * weights.value).squaredNorm();
    weights.value.array() /= scale.array();
    return weights;
}

std::vector<WeightedPart> makeBase(const TestStack& problem, const LawTerms& terms, const std::vector<Stop>& stops) {
    std::vector<WeightedPart> columns{{{}, false}};
    if (!terms.curve) columns.push_back({withStiffness(&AxisLaw::stiffness)});
    if (terms.curve)
        for (std::vector<CurveRow>& rows : makeMonotoneCurves(problem.lowest, problem.highest, kCurveCells)) {
            AxisLaw law;
            law.curve = std::move(rows);
            columns.push_back({law});
        }
    if (problem.has_velocity) columns.push_back({withStiffness(&AxisLaw::damping)});
    if (terms.cubic) columns.push_back({withStiffness(&AxisLaw::cubic), false});
    for (const Stop& stop : stops) {
        AxisLaw law;
        law.stops.push_back({stop.side, stop.clearance, 1, 0});
        columns.push_back({law});
    }
    if (terms.relaxation && problem.has_velocity) {
        // Two in each decade: a spectrum between them differs by less than a thousandth (trapezoids in log τ).
        double tau = 3 * problem.interval;
        for (int i = 0; i < kMostBranches && tau < 2 * problem.duration; ++i, tau *= std::sqrt(10.0)) {
            AxisLaw law;
            law.branches.push_back({1, tau});
            columns.push_back({law});
        }
    }
    const double R = problem.range;
    if (terms.memory == Memory::sliders)
        for (int i = 0; i < 12; ++i) {
            const double yield = 1.5 * R * std::pow(0.62, i);
            columns.push_back({withSlider(1, 1, yield, 0)});
        }
    if (terms.memory == Memory::gap_sliders)
        for (const double yield : {0.02, 0.06, 0.15, 0.4, 1.0})
            for (const double gap : {0.0, 0.06, 0.12, 0.18, 0.25, 0.35, 0.5, 0.8})
                for (const bool positive : {true, false})
                    columns.push_back({withSlider(positive ? 1 : 0, positive ? 0 : 1, yield * R, gap * R)});
    for (WeightedPart& column : columns) column.values = problem.calc(column.unit);
    columns.front().values = Eigen::VectorXd::Ones(problem.force.size());
    return columns;
}

/// Columns of a memory whose shape is searched. @param shape logarithm of Y, then gap over R, or exponent
std::vector<WeightedPart> makeShaped(const TestStack& problem, Memory memory, const Eigen::VectorXd& shape) {
    std::vector<WeightedPart> columns;
    if (memory == Memory::gap_slider) {
        const std::optional<double> exponent = shape[2] > 20 ? std::nullopt : std::optional<double>(shape[2]);
        for (const bool positive : {true, false})
            columns.push_back({withSlider(positive ? 1 : 0, positive ? 0 : 1, std::exp(shape[0]),
                                          shape[1] * problem.range, exponent)});
    } else {
        AxisLaw law;
        law.hysteresis = Hysteresis{1, std::exp(shape[0]), shape[2], shape[1]};
        columns.push_back({law});
    }
    for (WeightedPart& column : columns) column.values = problem.calc(column.unit);
    return columns;
}

/// Searches the shape by steps along each of its numbers, halved where none helps.
Eigen::VectorXd searchShape(const TestStack& problem, Memory memory, std::vector<WeightedPart> columns) {
    const std::size_t base = columns.size();
    const double R = problem.range;
    Eigen::Vector3d lower(std::log(1e-3 * R), 0, 1), upper(std::log(3 * R), 1.9, 21);
    if (memory == Memory::hysteresis) {
        lower[1] = 0.5;
        upper[1] = 1;
        upper[2] = 12;
    }
    const auto calcCost = [&](const Eigen::VectorXd& shape) {
        columns.resize(base);
        for (WeightedPart& column : makeShaped(problem, memory, shape)) columns.push_back(std::move(column));
        return solveWeights(problem, columns).cost;
    };
    Eigen::Vector3d best(0, 0, 0);
    double least = std::numeric_limits<double>::infinity();
    const std::vector<double> seconds =
        memory == Memory::gap_slider ? std::vector<double>{0, 0.1, 0.2, 0.3, 0.5, 0.8} : std::vector<double>{0.5};
    for (const double yield : {0.02, 0.06, 0.15, 0.4, 0.9})
        for (const double second : seconds) {
            const Eigen::Vector3d shape(std::log(yield * R), second, memory == Memory::gap_slider ? 21 : 2);
            const double cost = calcCost(shape);
            if (cost >= least) continue;
            least = cost;
            best = shape;
        }
    Eigen::Vector3d step(0.4, memory == Memory::gap_slider ? 0.06 : 0.25, memory == Memory::gap_slider ? 17 : 2);
    for (int round = 0; round < 40 && step[0] > 2e-3; ++round) {
        bool moved = false;
        for (int k = 0; k < 3; ++k)
            for (const double sign : {1.0, -1.0}) {
                Eigen::Vector3d trial = best;
                trial[k] = std::clamp(best[k] + sign * step[k], lower[k], upper[k]);
                if (trial[k] == best[k]) continue;
                const double cost = calcCost(trial);
                if (cost >= least * (1 - 1e-9)) continue;
                least = cost;
                best = trial;
                moved = true;
            }
        if (!moved) step *= 0.5;
    }
    return best;
}

/// The parts with a weight; of sliders and branches no more than a law may list, those that move most.
/// @param shaped from here on columns of a searched shape, which stay together
std::vector<WeightedPart> keepActive(const TestStack& problem, std::vector<WeightedPart> columns, std::size_t shaped,
                                     Weights& weights) {
    const auto size = [&](std::size_t j) { return std::abs(weights.value[j]) * columns[j].values.norm(); };
    std::vector<std::size_t> sliders;
    std::vector<bool> kept(columns.size());
    for (std::size_t j = 0; j < columns.size(); ++j) {
        kept[j] = j >= shaped || !columns[j].bounded || size(j) > 1e-4 * problem.spread;
        if (kept[j] && !columns[j].unit.sliders.empty()) sliders.push_back(j);
    }
    std::sort(sliders.begin(), sliders.end(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); });
    for (std::size_t i = kMostSliders; i < sliders.size(); ++i) kept[sliders[i]] = false;
    std::vector<WeightedPart> result;
    for (std::size_t j = 0; j < columns.size(); ++j)
        if (kept[j]) result.push_back(std::move(columns[j]));
    weights = solveWeights(problem, result);
    return result;
}

bool sameShape(const Slider& a, const Slider& b) {
    return a.yield_displacement == b.yield_displacement && a.gap == b.gap && a.exponent == b.exponent;
}

/// Adds a weighted part to a law.
void addPart(const AxisLaw& unit, double weight, AxisLaw& law) {
    law.stiffness += weight * unit.stiffness;
    law.damping += weight * unit.damping;
    law.cubic += weight * unit.cubic;
    if (!unit.curve.empty() && weight > 0) addCurve(unit.curve, weight, law.curve);
    for (Stop stop : unit.stops) {
        stop.stiffness *= weight;
        if (weight > 0) law.stops.push_back(stop);
    }
    for (const MaxwellBranch& branch : unit.branches)
        if (weight > 0) law.branches.push_back({weight * branch.stiffness, branch.time_constant});
    for (const Slider& part : unit.sliders) {
        if (!(weight > 0)) continue;
        auto same = std::find_if(law.sliders.begin(), law.sliders.end(),
                                 [&](const Slider& other) { return sameShape(part, other); });
        if (same == law.sliders.end()) {
            law.sliders.push_back(part);
            same = law.sliders.end() - 1;
            same->force = 0;
            same->negative_force = 0;
        }
        Slider& slider = *same;
        slider.force += weight * part.force;
        *slider.negative_force += weight * *part.negative_force;
    }
    if (unit.hysteresis && weight > 0) {
        law.hysteresis = unit.hysteresis;
        law.hysteresis->force *= weight;
    }
}

/// Values with their intervals; sums of a distribution rather than each of its parts.
void addParameters(const TestStack& problem, const std::vector<WeightedPart>& columns, const Weights& weights,
                   const Estimates& e, const std::string& place, LawFit& fit) {
    const auto combine = [&](const std::string& name, const std::string& unit, const auto& weightOf) {
        Eigen::VectorXd combination = Eigen::VectorXd::Zero(e.covariance.rows());
        for (std::size_t j = 0; j < columns.size(); ++j) combination[j] = weightOf(columns[j].unit);
        if (combination.isZero()) return;
        const double value = combination.head(weights.value.size()).dot(weights.value);
        const double half = e.calcHalfWidth(combination);
        fit.parameters.push_back({place + name, value, unit, value - half, value + half});
    };
    // Of a curve: where it is at rest, and at both ends of the tests.
    combine("stiffness", "N/m",
            [](const AxisLaw& law) { return law.stiffness + ForceCurve(law.curve).calcStiffness(0); });
    combine("stiffness at the + end", "N/m",
            [&](const AxisLaw& law) { return ForceCurve(law.curve).calcStiffness(problem.highest); });
    combine("stiffness at the - end", "N/m",
            [&](const AxisLaw& law) { return ForceCurve(law.curve).calcStiffness(problem.lowest); });
    combine("damping", "N s/m", [](const AxisLaw& law) { return law.damping; });
    combine("cubic", "N/m^3", [](const AxisLaw& law) { return law.cubic; });
    combine("sliding force towards +", "N",
            [](const AxisLaw& law) { return law.sliders.empty() ? 0.0 : law.sliders[0].force; });
    combine("sliding force towards -", "N",
            [](const AxisLaw& law) { return law.sliders.empty() ? 0.0 : law.sliders[0].negative_force.value_or(0); });
    combine("hysteresis_force", "N", [](const AxisLaw& law) { return law.hysteresis ? law.hysteresis->force : 0.0; });
    combine("stiffness of all branches", "N/m",
            [](const AxisLaw& law) { return law.branches.empty() ? 0.0 : law.branches[0].stiffness; });
    const Eigen::Index shaped = columns.size();
    if (e.covariance.rows() == shaped) return;
    const bool gap = fit.terms.memory == Memory::gap_slider;
    const auto addShape = [&](const std::string& name, const std::string& unit, double value, double scale,
                              Eigen::Index k) {
        const double half = scale * e.calcHalfWidth(shaped + k);
        fit.parameters.push_back({place + name, value, unit, value - half, value + half});
    };
    const double yield = gap ? fit.law.sliders.at(0).yield_displacement : fit.law.hysteresis->yield_displacement;
    addShape("yield_displacement", "m", yield, yield, 0);
    if (gap) addShape("gap", "m", fit.law.sliders.at(0).gap, problem.range, 1);
}

}  // namespace

std::string LawTerms::name() const {
    static const char* const memories[] = {"", "hysteresis of Bouc and Wen", "sliders", "slider with gap",
                                           "sliders with gaps"};
    std::string text = memories[static_cast<int>(memory)];
    const auto add = [&](const char* part) { text += (text.empty() ? "" : ", ") + std::string(part); };
    if (relaxation) add("Prony series");
    if (cubic) add("cubic term");
    if (curve) add("force curve");
    return text.empty() ? "spring and dashpot" : text;
}

LawFit fitLaw(const std::vector<ComponentData>& tests, const LawTerms& terms, const std::vector<Stop>& stops,
              const std::string& place) {
    const TestStack problem(tests);
    LawFit fit;
    fit.terms = terms;
    std::vector<WeightedPart> columns = makeBase(problem, terms, stops);
    const bool searched = terms.memory == Memory::gap_slider || terms.memory == Memory::hysteresis;
    Eigen::VectorXd shape;
    const std::size_t shaped = columns.size();
    if (searched) {
        shape = searchShape(problem, terms.memory, columns);
        for (WeightedPart& column : makeShaped(problem, terms.memory, shape)) columns.push_back(std::move(column));
    }
    Weights weights = solveWeights(problem, columns);
    columns = keepActive(problem, std::move(columns), shaped, weights);
    for (std::size_t j = 1; j < columns.size(); ++j) addPart(columns[j].unit, weights.value[j], fit.law);
    moveSlopeToStiffness(fit.law);
    fit.force_offset = weights.value[0];
    fit.fraction = problem.spread > 0 ? std::sqrt(weights.cost) / problem.spread : 0;

    // Intervals of the weights that are not held at zero; of a shape by differences of the fitted force.
    const bool shape_acts =
        searched && (terms.memory == Memory::gap_slider ? !fit.law.sliders.empty() : fit.law.hysteresis.has_value());
    const Eigen::Index count = columns.size();
    Eigen::MatrixXd J(problem.force.size(), count + (shape_acts ? 2 : 0));
    Eigen::VectorXd fitted = Eigen::VectorXd::Zero(problem.force.size());
    for (Eigen::Index j = 0; j < count; ++j) {
        J.col(j) = columns[j].values;
        fitted += weights.value[j] * J.col(j);
    }
    for (Eigen::Index k = 0; shape_acts && k < 2; ++k) {
        const double h = 1e-3;
        Eigen::VectorXd change = Eigen::VectorXd::Zero(problem.force.size());
        for (const double sign : {1.0, -1.0}) {
            Eigen::VectorXd moved = shape;
            moved[k] = std::max(moved[k] + sign * h, k == 1 && terms.memory == Memory::gap_slider ? 0.0 : moved[k] - h);
            const auto parts = makeShaped(problem, terms.memory, moved);
            const auto first = count - static_cast<Eigen::Index>(parts.size());
            for (std::size_t j = 0; j < parts.size(); ++j)
                change += sign * weights.value[first + static_cast<Eigen::Index>(j)] * parts[j].values;
        }
        J.col(count + k) = change / (2 * h);
    }
    const Estimates e = solveBlocks(J, problem.force - fitted, problem.starts);
    addParameters(problem, columns, weights, e, place, fit);
    fit.parameter_count = static_cast<int>(count) + (shape_acts ? 3 : 0);
    fit.effective_samples = static_cast<double>(problem.force.size()) / e.correlation_length;
    return fit;
}

double calcLawError(const AxisLaw& law, double force_offset, const std::vector<ComponentData>& tests) {
    double left = 0, sum = 0, square = 0;
    Eigen::Index count = 0;
    for (const ComponentData& test : tests) {
        const Eigen::VectorXd f = calcForceAlong(law, test.time, test.q, test.velocity);
        left += (f.array() + force_offset - test.force.array()).square().sum();
        sum += test.force.sum();
        square += test.force.squaredNorm();
        count += test.count();
    }
    const double spread = square - sum * sum / static_cast<double>(std::max<Eigen::Index>(1, count));
    return spread > 0 ? std::sqrt(left / spread) : 0;
}

double calcLawError(const AxisLaw& law, double force_offset, const ComponentData& test) {
    return calcLawError(law, force_offset, std::vector<ComponentData>{test});
}

}  // namespace wems::identify
