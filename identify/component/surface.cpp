#include "identify/component/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/component/block_regression.hpp"
#include "models/common/error.hpp"

namespace wems::identify {

namespace {

/// A candidate with the numbers needed to name parameters afterwards.
struct Trial {
    SurfaceCandidate summary;
    bool cubic = false, friction = false;
    bool wide_regions = true;  ///< every region between breakpoints is at least 3 % of the range: narrower is noise
    double sign_penalty = 0;   ///< what zero in place of a sign that no mount has adds to −2 log likelihood (Wald)
    HingeFit fit;
    Eigen::MatrixXd base;  ///< columns of the linear parts, but for hinges
    Eigen::Index stiffness_column = 1, friction_column = -1, cubic_column = -1, damping_column = -1;
};

/// Friction that drives the motion, and a stiffness at rest that pushes away from it, are no properties of a mount: a
/// law that asks for one pays what it would lose without. Where the truth is zero, as in a clearance, chance alone asks
/// for a little, and costs little.
void addSignPenalty(Trial& trial) {
    const Estimates& e = trial.fit.estimates;
    const auto add = [&](const Eigen::VectorXd& combination) {
        const double value = combination.dot(e.value), variance = combination.dot(e.covariance * combination);
        if (value < 0 && variance > 0) trial.sign_penalty += value * value / variance;
    };
    if (trial.friction_column >= 0) add(Eigen::VectorXd::Unit(e.value.size(), trial.friction_column));
    const Eigen::Index hinges = trial.fit.hinges.size();
    const Eigen::Index first = e.value.size() - 2 * hinges;
    Eigen::VectorXd at_rest = Eigen::VectorXd::Zero(e.value.size());
    at_rest[trial.stiffness_column] = 1;
    for (Eigen::Index j = 0; j < hinges; ++j)
        if (trial.fit.hinges[j].position < 0) at_rest[first + j] = 1;
    add(at_rest);
}

Trial tryLaw(const ComponentData& data, int hinges, bool cubic, bool friction) {
    Trial trial;
    trial.cubic = cubic;
    trial.friction = friction;
    const Eigen::Index n = data.count();
    std::vector<Eigen::VectorXd> columns{Eigen::VectorXd::Ones(n), data.q};
    const auto add = [&](const Eigen::VectorXd& column) {
        columns.push_back(column);
        return static_cast<Eigen::Index>(columns.size()) - 1;
    };
    if (data.has_velocity) trial.damping_column = add(data.velocity);
    if (cubic) trial.cubic_column = add(data.q.array().cube().matrix());
    if (friction) {
        // Smooth over 2 % of the largest speed: a step at zero would fit the noise of the velocity's sign.
        const double transition = 0.02 * data.velocity.cwiseAbs().maxCoeff();
        trial.friction_column = add(data.has_velocity ? Eigen::VectorXd((data.velocity / transition).array().tanh())
                                                      : calcDirection(data.q, 0.05));
    }
    HingeProblem problem;
    problem.base.resize(n, columns.size());
    for (std::size_t j = 0; j < columns.size(); ++j) problem.base.col(j) = columns[j];
    problem.q = data.q;
    problem.y = data.force;
    problem.start.resize(hinges);
    problem.run_starts = {0};
    if (hinges == 0) {
        trial.fit.estimates = solveBlocks(problem.base, problem.y, problem.run_starts);
    } else {
        trial.fit = fitHinges(problem, true);
        std::vector<Hinge>& found = trial.fit.hinges;
        if (found.size() == 2 && found[0].position > found[1].position) {
            // Ascending positions, so that slopes accumulate from left to right.
            std::swap(found[0], found[1]);
            Estimates& e = trial.fit.estimates;
            const Eigen::Index first = problem.base.cols();
            for (const Eigen::Index j : {first, first + 2}) {
                std::swap(e.value[j], e.value[j + 1]);
                e.covariance.row(j).swap(e.covariance.row(j + 1));
                e.covariance.col(j).swap(e.covariance.col(j + 1));
            }
        }
    }
    addSignPenalty(trial);
    trial.base = std::move(problem.base);
    const double low = data.q.minCoeff(), high = data.q.maxCoeff();
    double last = low;
    for (const auto& hinge : trial.fit.hinges) {
        trial.wide_regions = trial.wide_regions && hinge.position - last >= 0.03 * (high - low);
        last = hinge.position;
    }
    trial.wide_regions = trial.wide_regions && (hinges == 0 || high - last >= 0.03 * (high - low));
    const char* names[] = {"linear", "one breakpoint", "two breakpoints"};
    trial.summary.name = std::string(cubic ? "cubic" : names[hinges]) + (friction ? " + friction" : "");
    trial.summary.fraction = trial.fit.estimates.fraction;
    trial.summary.parameters = static_cast<int>(trial.base.cols()) + 2 * hinges;
    return trial;
}

/// RMS of what is left of the force over that of the force about its mean, both over full strokes only.
struct StrokeFractions {
    double history;  ///< by a curve over direction and travel since the last reversal: memory, not state
    double law;      ///< by the law with this residual
};

StrokeFractions compareOnStrokes(const ComponentData& data, const Eigen::VectorXd& law_residual) {
    const Eigen::VectorXd travel = calcTravel(data.q, 0.05);
    const Eigen::VectorXd direction = calcDirection(data.q, 0.05);
    const std::vector<bool> full = findFullStrokes(data.q);
    constexpr int cells = 60;
    std::vector<Eigen::Index> used;
    double longest = 0, mean = 0;
    for (Eigen::Index i = 0; i < data.count(); ++i) {
        if (!full[i]) continue;
        used.push_back(i);
        longest = std::max(longest, travel[i]);
        mean += data.force[i];
    }
    // A motion that jumps from one level to the next has no travel on its strokes.
    if (used.empty() || !(longest > 0))
        return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    mean /= static_cast<double>(used.size());
    std::vector<std::vector<double>> bins(2 * std::size_t{cells});
    double law = 0, spread = 0, history = 0;
    for (const auto i : used) {
        const int cell = std::min(static_cast<int>(travel[i] / longest * cells), cells - 1);
        bins[static_cast<std::size_t>(direction[i] > 0 ? cell : cells + cell)].push_back(data.force[i]);
        law += law_residual[i] * law_residual[i];
        spread += std::pow(data.force[i] - mean, 2);
    }
    for (const auto& bin : bins) {
        double bin_mean = 0;
        for (const double f : bin) bin_mean += f / static_cast<double>(bin.size());
        for (const double f : bin) history += std::pow(f - bin_mean, 2);
    }
    if (spread <= 0) return {0, 0};
    return {std::sqrt(history / spread), std::sqrt(law / spread)};
}

ComponentParameter makeParameter(const std::string& name, const std::string& unit, double value, double half) {
    return {name, value, unit, value - half, value + half};
}

/// Standard deviation, N, of what the parts of a law make of the force.
struct Parts {
    double elastic, dashpot, friction;
};

Parts calcParts(const ComponentData& data, const Trial& trial) {
    const Estimates& e = trial.fit.estimates;
    const auto spread = [](const Eigen::VectorXd& part) {
        return std::sqrt((part.array() - part.mean()).square().mean());
    };
    const auto sizeOf = [&](Eigen::Index column) {
        return column < 0 ? 0.0 : std::abs(e.value[column]) * spread(trial.base.col(column));
    };
    Eigen::VectorXd elastic = e.value[trial.stiffness_column] * data.q;
    if (trial.cubic_column >= 0) elastic += e.value[trial.cubic_column] * trial.base.col(trial.cubic_column);
    const Eigen::Index first = e.value.size() - 2 * static_cast<Eigen::Index>(trial.fit.hinges.size());
    for (std::size_t h = 0; h < trial.fit.hinges.size(); ++h)
        elastic += e.value[first + static_cast<Eigen::Index>(h)] *
                   (data.q.array() - trial.fit.hinges[h].position).max(0).matrix();
    return {spread(elastic), sizeOf(trial.damping_column), sizeOf(trial.friction_column)};
}

void addLawParameters(const ComponentData& data, const Trial& trial, SurfaceKind& kind) {
    const std::string place = data.connection + "." + "xyz"[data.axis] + ".";
    const Estimates& e = trial.fit.estimates;
    const auto addColumn = [&](const std::string& name, const std::string& unit, Eigen::Index column) {
        if (column < 0) return;
        kind.parameters.push_back(makeParameter(place + name, unit, e.value[column], e.calcHalfWidth(column)));
    };
    const Eigen::Index hinges = trial.fit.hinges.size();
    const Eigen::Index first = e.value.size() - 2 * hinges;
    Eigen::VectorXd combination = Eigen::VectorXd::Zero(e.value.size());
    combination[trial.stiffness_column] = 1;
    std::vector<double> slopes;
    for (Eigen::Index region = 0; region <= hinges; ++region) {
        if (region > 0) combination[first + region - 1] = 1;
        const double slope = combination.dot(e.value);
        slopes.push_back(slope);
        const std::string name = hinges == 0 ? "stiffness" : "stiffness of region " + std::to_string(region + 1);
        kind.parameters.push_back(makeParameter(place + name, "N/m", slope, e.calcHalfWidth(combination)));
        if (region < hinges) addColumn("breakpoint " + std::to_string(region + 1), "m", first + hinges + region);
    }
    addColumn("cubic", "N/m^3", trial.cubic_column);
    addColumn("damping", "N s/m", trial.damping_column);
    addColumn("friction_force", "N", trial.friction_column);
    // The force at q = 0, to which each hinge below it adds −(change of slope) · (its position).
    double offset = e.value[0];
    Eigen::VectorXd at_rest = Eigen::VectorXd::Zero(e.value.size());
    at_rest[0] = 1;
    for (Eigen::Index j = first; j < first + hinges; ++j) {
        const double change = e.value[j], position = e.value[j + hinges];
        if (position >= 0) continue;
        offset -= change * position;
        at_rest[j] = -position;
        at_rest[j + hinges] = -change;
    }
    kind.parameters.push_back(makeParameter(place + "force_offset", "N", offset, e.calcHalfWidth(at_rest)));

    if (hinges == 0 && !trial.cubic) {
        kind.name = "linear";
        kind.statement = "The force is proportional to the displacement, with a dashpot.";
    } else if (trial.cubic) {
        const bool hardening = e.value[trial.cubic_column] * e.value[trial.stiffness_column] > 0;
        kind.name = hardening ? "hardening" : "softening";
        kind.statement = hardening ? "The stiffness grows smoothly with the displacement."
                                   : "The stiffness falls smoothly with the displacement.";
    } else {
        std::size_t inner = 0;  // the region that holds q = 0
        for (const auto& hinge : trial.fit.hinges) inner += hinge.position < 0 ? 1U : 0U;
        double steepest = 0;
        for (const double slope : slopes) steepest = std::max(steepest, std::abs(slope));
        if (std::abs(slopes[inner]) < 0.1 * steepest) {
            kind.name = "clearance";
            kind.statement = "Around the rest position there is nearly no stiffness; it begins at a breakpoint.";
        } else if (std::abs(slopes[inner]) < steepest) {
            kind.name = "piecewise linear, stiffening";
            kind.statement = "The stiffness rises at a breakpoint, as at a stop.";
        } else {
            kind.name = "piecewise linear, softening";
            kind.statement = "The stiffness falls at a breakpoint, as where a force saturates.";
        }
    }
    // The name is that of what makes most of the force.
    const Parts parts = calcParts(data, trial);
    if (parts.friction > std::max(parts.elastic, parts.dashpot)) {
        kind.name = "friction";
        kind.statement = "Most of the force depends on the direction of motion alone.";
    } else if (parts.dashpot > parts.elastic) {
        kind.name = "viscous";
        kind.statement = "Most of the force is proportional to the velocity.";
    }
    if (trial.friction && kind.name != "friction")
        kind.statement += " A force that depends on the direction of motion alone is added to it.";
}

void addStrokeParameters(const ComponentData& data, bool gap, SurfaceKind& kind) {
    const std::string place = data.connection + "." + "xyz"[data.axis] + ".";
    const auto add = [&](const std::string& name, const std::string& unit, const StrokeStatistic& s) {
        kind.parameters.push_back({place + name, s.value, unit, s.lower, s.upper});
    };
    add("friction level towards +", "N", kind.strokes.positive_level);
    add("friction level towards -", "N", kind.strokes.negative_level);
    if (!gap) return;
    add("gap at reversals", "m", kind.strokes.gap);
    add("gap after + strokes", "m", kind.strokes.gap_after_positive);
    add("gap after - strokes", "m", kind.strokes.gap_after_negative);
}

}  // namespace

SurfaceKind characteriseSurface(const ComponentData& data, double low_force) {
    SurfaceKind kind;
    kind.gains = gainTolerancesOf(data.source);
    std::vector<Trial> trials;
    for (const bool friction : {false, true}) {
        trials.push_back(tryLaw(data, 0, false, friction));
        trials.push_back(tryLaw(data, 0, true, friction));
        trials.push_back(tryLaw(data, 1, false, friction));
        trials.push_back(tryLaw(data, 2, false, friction));
    }
    const auto closest = std::min_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
        return a.summary.fraction < b.summary.fraction;
    });
    kind.effective_samples = static_cast<double>(data.count()) / closest->fit.estimates.correlation_length;
    double best = std::numeric_limits<double>::infinity();
    for (auto& trial : trials) {
        if (!trial.wide_regions) continue;
        auto& s = trial.summary;
        s.information = kind.effective_samples * 2.0 * std::log(std::max(s.fraction, 1e-12)) +
                        s.parameters * std::log(kind.effective_samples) + trial.sign_penalty;
        best = std::min(best, s.information);
        kind.candidates.push_back(s);
    }
    const auto on_strokes = compareOnStrokes(data, closest->fit.estimates.residual);
    std::sort(trials.begin(), trials.end(),
              [](const Trial& a, const Trial& b) { return a.summary.parameters < b.summary.parameters; });
    const auto chosen = std::find_if(trials.begin(), trials.end(), [&](const Trial& trial) {
        return trial.wide_regions && trial.summary.information <= best + 6.0;
    });
    if (chosen == trials.end())
        throw InputError({data.file, 0, ""},
                         "no law can be told from these " + std::to_string(data.count()) + " samples",
                         "displacements and forces that vary, over several strokes");

    kind.strokes = summariseFriction(data.q, data.force, low_force);
    kind.history_fraction = on_strokes.history;
    const auto& s = kind.strokes;
    const auto stroke_count = s.positive_level.strokes.size() + s.negative_level.strokes.size();
    const bool levels = s.positive_level.value > 0 && s.negative_level.value < 0 && s.flatness < 0.35 &&
                        s.loop_fill > 0.4 && stroke_count >= 2;
    // Memory is what repeats over strokes and what no law of the state explains; a ripple on one stroke is neither.
    const bool memory = stroke_count >= 4 && on_strokes.law > 0.1 && on_strokes.history < 0.7 * on_strokes.law;
    if (levels && (memory || chosen->friction)) {
        // An elastic element that turns over crosses the low forces about as fast as those beside them.
        const bool gap = s.gap.value > 1.5 * s.rise && s.gap.value > 0.01 * s.stroke;
        kind.name = gap ? "friction with gap at reversals" : "friction";
        kind.statement = gap ? "The force keeps a level in each direction of motion; after each reversal it stays low "
                               "over a travel before it builds up again."
                             : "The force keeps a level in each direction of motion.";
        addStrokeParameters(data, gap, kind);
    } else {
        addLawParameters(data, *chosen, kind);
        if (memory && s.loop_fill > 0.1) {
            kind.name = "hysteresis";
            kind.statement =
                "The force follows the travel since the last reversal better than displacement and velocity.";
        }
    }
    return kind;
}

namespace {

double takeMedian(std::vector<double>& values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

Eigen::VectorXd makeEdges(const Eigen::VectorXd& values, int cells) {
    double low = values.minCoeff(), high = values.maxCoeff();
    if (high <= low) high = low + 1;  // a single cell catches all: no velocity was recorded
    return Eigen::VectorXd::LinSpaced(cells + 1, low, high);
}

Eigen::Index findCell(const Eigen::VectorXd& edges, double value) {
    const Eigen::Index cells = edges.size() - 1;
    const double place = (value - edges[0]) / (edges[cells] - edges[0]) * static_cast<double>(cells);
    return std::clamp(static_cast<Eigen::Index>(std::floor(place)), Eigen::Index{0}, cells - 1);
}

/// Medians of f over cells of `along`, of the samples where |across| is below a tenth of its maximum.
SurfaceSlice slice(const Eigen::VectorXd& along, const Eigen::VectorXd& across, const Eigen::VectorXd& force,
                   int cells) {
    SurfaceSlice result;
    result.half_width = 0.1 * across.cwiseAbs().maxCoeff();
    const Eigen::VectorXd edges = makeEdges(along, cells);
    std::vector<std::vector<double>> bins(cells);
    for (Eigen::Index i = 0; i < along.size(); ++i)
        if (std::abs(across[i]) <= result.half_width) bins[findCell(edges, along[i])].push_back(force[i]);
    for (std::size_t c = 0; c < bins.size(); ++c) {
        if (bins[c].empty()) continue;
        const Eigen::Index k = c;
        result.at.push_back(0.5 * (edges[k] + edges[k + 1]));
        result.count.push_back(static_cast<long>(bins[c].size()));
        result.force.push_back(takeMedian(bins[c]));
    }
    return result;
}

}  // namespace

SurfaceGrid makeSurfaceGrid(const ComponentData& data, int q_cells, int v_cells) {
    SurfaceGrid grid;
    grid.q_edges = makeEdges(data.q, q_cells);
    grid.v_edges = makeEdges(data.velocity, v_cells);
    grid.median.resize(q_cells, v_cells);
    grid.count = Eigen::MatrixXi::Zero(q_cells, v_cells);
    std::vector<std::vector<double>> bins(static_cast<std::size_t>(q_cells) * static_cast<std::size_t>(v_cells));
    const auto binOf = [&](Eigen::Index i) {
        return static_cast<std::size_t>(findCell(grid.q_edges, data.q[i]) * v_cells +
                                        findCell(grid.v_edges, data.velocity[i]));
    };
    for (Eigen::Index i = 0; i < data.count(); ++i) bins[binOf(i)].push_back(data.force[i]);
    std::vector<double> medians(bins.size());
    for (std::size_t b = 0; b < bins.size(); ++b) {
        const auto row = static_cast<Eigen::Index>(b) / v_cells, column = static_cast<Eigen::Index>(b) % v_cells;
        grid.count(row, column) = static_cast<int>(bins[b].size());
        medians[b] = takeMedian(bins[b]);
        grid.median(row, column) = medians[b];
    }
    double left = 0;
    for (Eigen::Index i = 0; i < data.count(); ++i) left += std::pow(data.force[i] - medians[binOf(i)], 2);
    const double spread = (data.force.array() - data.force.mean()).matrix().squaredNorm();
    grid.fraction = spread > 0 ? std::sqrt(left / spread) : 0.0;
    return grid;
}

SurfaceSlice sliceStiffness(const ComponentData& data, int cells) {
    return slice(data.q, data.velocity, data.force, cells);
}

SurfaceSlice sliceDamping(const ComponentData& data, int cells) {
    return slice(data.velocity, data.q, data.force, cells);
}

}  // namespace wems::identify
