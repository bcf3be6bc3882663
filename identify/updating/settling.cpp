#include "identify/updating/settling.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wems::identify::updating {
namespace {

constexpr double kWorthwhile = 0.003;  // of the cost: far from the noise, the last bit of a fit decides nothing
// What a model leaves beyond the noise is alike at frequencies closer than this part of the lowest excited one.
constexpr double kAlike = 0.2;
// Of the gain that the quadratic promises, what must be there for a step to be taken (Armijo's rule).
constexpr double kPromised = 0.1;
// Of the promise, from which on a step is good enough. If what it loses grows with the square of its length, one that
// keeps a part x is best at 1 / (2 − x) of its length: at 0.75 that gains another 5 % of the promise. Not varied.
constexpr double kKept = 0.75;
// Of the least promise that is worth the next columns: what must be there of it. Half, so that a step that was just
// worth trying is taken where the equations bear out most of it. Not varied.
constexpr double kGained = 0.5;
// Levenberg's damping, in parts of the prior's precision: where the quadratic fails, it fails along what the recordings
// hardly know. Of a deep contact whose whole step lost 170 times its promise, 1 lost 14 times of it, 10 kept all, 100
// of a promise that was a fifth less. One case; ten times more is tried while a step does not keep its promise.
constexpr double kFirstDamping = 10;
constexpr double kEased = 10;  // by which it falls from step to step (Marquardt, 1963). Not varied.
// Of the squared length, in the prior's metric, of the step that was tried before: if the loss grows with the square, a
// step at one half loses half. What is hardly shorter is not worth the equations of all runs. Not varied.
constexpr double kShorter = 0.5;
// Relative: a few products and quotients by ten round off by 1e-15, and the next damping is ten times more.
constexpr double kSameDamping = 1e-9;
constexpr int kMostScalings = 30;
constexpr double kScalesSettled = 0.02;  // relative change: evidence follows to 1 % of what it is

/// How many neighbouring values what exceeds the noise has in common.
double calcAlike(const TestProblem& problem) {
    double alike = 1;
    for (const TestRun& run : problem.runs()) {
        const double duration = run.motion.time.back() - run.motion.time.front();
        alike = std::max(alike, kAlike * run.band.lowest * duration);
    }
    return alike;
}

bool areAlike(const BlockScales& a, const BlockScales& b) {
    for (std::size_t k = 0; k < kBlocks; ++k)
        if (std::abs(a[k].scale - b[k].scale) > kScalesSettled * a[k].scale) return false;
    return true;
}

std::vector<Hypothesis> collect(const TestProblem& problem, const HypothesisSet& set) {
    std::vector<Hypothesis> members;
    for (const int h : set) members.push_back(problem.hypotheses()[h]);
    return members;
}

/// A number that a step leads beyond its range stays at its end: what the step promises is what it does there.
Eigen::VectorXd keepInRange(const TestProblem& problem, Eigen::VectorXd estimate) {
    for (std::size_t i = 0; i < problem.table().size(); ++i) {
        const Unknown& row = problem.table()[i];
        estimate[i] = std::clamp(row.believed + estimate[i], row.least, row.most) - row.believed;
    }
    return estimate;
}

/// C⁻¹ ε on the columns that a set moves, C their prior covariance: the slope of −log prior there.
Eigen::VectorXd calcPriorSlope(const TestProblem& problem, const Eigen::VectorXd& estimate, const HypothesisSet& set) {
    std::vector<Direction> directions = problem.tolerances(set, estimate);
    for (const int h : set) {
        const std::vector<Direction>& own = problem.hypotheses()[h].directions;
        directions.insert(directions.end(), own.begin(), own.end());
    }
    return identify::calcPriorSlope(directions, estimate);
}

}  // namespace

std::vector<double> calcMeanSquares(const Information& actual) {
    std::vector<double> misfits;
    for (const BlockInformation& block : actual) misfits.push_back(block.empty() ? 0 : block.chi_squared / block.count);
    return misfits;
}

bool isSatisfied(const std::vector<double>& misfits) {
    return std::all_of(misfits.begin(), misfits.end(), [](double misfit) { return misfit < kSatisfied; });
}

Evidence makeEvidence(const TestProblem& problem, const TestView& view, const HypothesisSet& set,
                      const BlockScales& scales, bool with_validation) {
    return {combine(sumOf(view, with_validation), scales, problem.reaches()),
            problem.tolerances(set, problem.estimateOf(view.at)), problem.hypotheses()};
}

Information sumOf(const TestInformation& runs, bool with_validation) {
    Information all = runs.identification;
    if (with_validation) add(all, runs.validation);
    return all;
}

std::vector<double> calcMisfits(const Information& all, const Eigen::VectorXd& estimate) {
    std::vector<double> misfits;
    for (std::size_t k = 0; k < kBlocks; ++k) misfits.push_back(calcBlockMisfit(all[k], estimate));
    return misfits;
}

double calcExcessOf(const std::vector<double>& misfits) {
    return *std::max_element(misfits.begin(), misfits.end()) - 1;
}

bool hasBursts(const Information& all) {
    return std::any_of(all.begin(), all.end(), [](const BlockInformation& block) { return block.scatter.size() > 0; });
}

std::vector<double> calcScatter(const Information& all) {
    std::vector<double> scatter;
    for (const BlockInformation& block : all) scatter.push_back(block.empty() ? 0 : std::sqrt(2 / block.count));
    return scatter;
}

bool isNoiseAlone(const Information& all, const std::vector<double>& misfits) {
    const std::vector<double> scatter = calcScatter(all);
    for (std::size_t k = 0; k < kBlocks; ++k) {
        // Of many values the mean scatters little: what is not known of it is the noise's level, in each band by
        // itself.
        const auto bands = static_cast<double>(all[k].noise_slopes.cols());
        const double level = bands > 0 ? kLevelDeviation / std::sqrt(bands) : 0;
        if (misfits[k] - 1 > kBeyondNoise * std::hypot(scatter[k], level)) return false;
    }
    return true;
}

SetEvidence::SetEvidence(const TestProblem& problem, const Information& all, const BlockScales& scales,
                         const HypothesisSet& set, const Eigen::VectorXd& estimate, Growth growth)
    : members_(collect(problem, set)),
      evidence_(combine(all, scales, problem.reaches(), growth), problem.tolerances(set, estimate), members_) {
    for (std::size_t i = 0; i < members_.size(); ++i) all_.push_back(static_cast<int>(i));
}

Settler::Settler(const TestProblem& problem) : problem_(problem), alike_(calcAlike(problem)) {}

BlockScales Settler::scalesOf(const std::vector<double>& misfits) const {
    BlockScales scales;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        scales[k].scale = 1 + std::max(0.0, misfits[k] - 1) * alike_;
        scales[k].level = std::max(0.0, misfits[k]);
    }
    return scales;
}

double Settler::calcCost(const Information& all, const std::vector<double>& misfits) const {
    double cost = 0;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        const double excess = misfits[k] - 1;
        cost += all[k].count * (excess > 0 ? std::log1p(alike_ * excess) / alike_ : excess);
    }
    return cost;
}

/// Scales at which a set's estimate leaves what they say, by the quadratic. From those of a perfect model upwards, so
/// that a set is given the chance to explain before what it leaves is called discrepancy.
BlockScales Settler::settleScales(const Information& all,
                                  const std::function<SetSolution(const BlockScales&)>& solve) const {
    BlockScales scales;
    for (int pass = 0; pass < kMostScalings; ++pass) {
        const BlockScales next = scalesOf(calcMisfits(all, solve(scales).mean));
        const bool settled = areAlike(scales, next);
        scales = next;
        if (settled) break;
    }
    return scales;
}

BlockScales Settler::settleScales(const Information& all, const HypothesisSet& set,
                                  const Eigen::VectorXd& estimate) const {
    return settleScales(all, [&](const BlockScales& scales) {
        return SetEvidence(problem_, all, scales, set, estimate, Growth::followed).solve();
    });
}

Information Settler::calcActual(const TestPoint& point, bool with_validation) const {
    return sumOf(problem_.misfit(point), with_validation);
}

double Settler::calcExcess(const TestView& view, const TestPoint& point, const Eigen::VectorXd& estimate,
                           const BlockScales& scales) const {
    return calcExcess(sumOf(view, true), estimate - problem_.estimateOf(view.at), calcActual(point, true), estimate,
                      scales, Growth::doubted);
}

double Settler::calcExcess(const Information& quadratic, const Eigen::VectorXd& step, const Information& actual,
                           const Eigen::VectorXd& estimate, const BlockScales& scales, Growth growth) const {
    double excess = 0;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        if (actual[k].empty()) continue;
        const BlockInformation& block = quadratic[k];
        double expected = calcBlockMisfit(block, estimate) * block.count;
        // The quadratic keeps the covariance of the view, under which the columns' noise grows with the columns. Each
        // point's own covariance has grown alike.
        if (block.noise_slopes.size() > 0) expected -= 2 * step.dot(block.noise_slopes.rowwise().sum());
        if (block.noise.size() > 0) expected -= std::min(1.0, scales[k].level) * step.dot(block.noise * step);
        if (growth == Growth::followed && block.growth.size() > 0) expected -= step.dot(block.growth * step);
        excess += (actual[k].chi_squared - expected) / scales[k].scale;
    }
    return excess;
}

bool Settler::settle(SetState& state, int most, bool with_validation) const {
    return settle(state, most, with_validation, [](double /*damping*/) { return true; }).at_rest;
}

int Settler::compete(SetState& state, int most, double rival) const {
    double before = calcLogEvidence(state), last = std::numeric_limits<double>::infinity();
    const auto may_win = [&](double damping) {
        state.scales = scalesOf(calcMisfits(sumOf(state.view, true), problem_.estimateOf(state.point)));
        const double now = calcLogEvidence(state), gained = now - std::exchange(before, now);
        const double previous = std::exchange(last, damping > 0 ? last : gained);
        if (now > rival || damping > 0 || !std::isfinite(previous)) return true;
        const double ratio = gained / previous;
        return !(ratio < 1) || now + gained * ratio / (1 - ratio) > rival;
    };
    return settle(state, most, true, may_win).steps;
}

Settler::Settling Settler::settle(SetState& state, int most, bool with_validation,
                                  const std::function<bool(double)>& is_worth_more) const {
    const std::vector<double> misfits =
        calcMisfits(sumOf(state.view, with_validation), problem_.estimateOf(state.point));
    // The more a model leaves, the less its columns say of where that vanishes (Fan and Yuan, 2005, damp by the
    // residual). What the recordings know best moves first. Where few steps are allowed, the last has at most the
    // prior's own precision as its damping.
    double damping = std::min(*std::max_element(misfits.begin(), misfits.end()) - 1, std::pow(kEased, most - 1));
    Settling settling;
    std::vector<TriedStep> tried;
    while (settling.steps < most) {
        if (!(damping >= 1)) damping = 0;  // nor where a misfit is no number
        Step step = improve(state, with_validation, damping, tried);
        if (step != Step::onwards && damping == 0 && reachStops(state, with_validation)) step = Step::onwards;
        if (step != Step::none) {
            ++settling.steps;
            tried.clear();
        }
        if (step != Step::none && !is_worth_more(damping)) break;
        settling.at_rest = damping == 0 && step == Step::none;
        if (damping == 0 && step != Step::onwards) break;
        damping /= kEased;
    }
    state.scales = scalesOf(calcMisfits(sumOf(state.view, with_validation), problem_.estimateOf(state.point)));
    return settling;
}

/// The point towards which a quadratic leads, as far as the equations themselves bear out what it promises. The view
/// was made at `point`: there the quadratic is what the equations say.
Settler::Step Settler::advance(const Information& all, const HypothesisSet& set, const BlockScales& scales,
                               double least, bool with_validation, double first_damping, std::vector<TriedStep>& tried,
                               TestPoint& point, PointEquations& equations) const {
    const Eigen::VectorXd present = problem_.estimateOf(point), slope = calcPriorSlope(problem_, present, set);
    const SetEvidence evidence(problem_, all, scales, set, present, Growth::followed);
    const Eigen::VectorXd target =
        keepInRange(problem_, first_damping > 0 ? evidence.solveNear(slope, first_damping) : evidence.solve().mean);
    const auto objective = [&](const Eigen::VectorXd& at) {
        return evidence.calcChange(at) + calcPriorSquare(at, set);
    };
    const double here = objective(present);
    if (!(here - objective(target) >= least)) return Step::none;  // nor where it is no number
    const std::vector<double> misfits = calcMisfits(all, present);
    const bool must_fall = hasBursts(all) && !isNoiseAlone(all, misfits);
    const double cost = calcCost(all, misfits) + calcPriorSquare(present, set);
    struct Reached {
        TriedStep step;
        Eigen::VectorXd at;
        TestPoint point;
        PointEquations equations;
    };
    const auto measure = [&](double damping, const Eigen::VectorXd& at) -> Reached {
        TestPoint next = problem_.pointAt(at, set);
        const double promised = here - objective(at);
        TestMisfit misfit = problem_.misfit(next);
        const Information actual = sumOf(misfit, with_validation);
        const double excess = calcExcess(all, at - present, actual, at, scales, Growth::followed);
        const double fall = cost - calcCost(actual, calcMeanSquares(actual)) - calcPriorSquare(at, set);
        return {{damping, promised, promised - excess, fall, fall > 0 || !must_fall},
                at,
                std::move(next),
                std::move(misfit.equations)};
    };
    const auto reach = [&](double damping, const Eigen::VectorXd& at) -> Reached {
        for (const TriedStep& own : tried)
            if (std::abs(own.damping - damping) <= kSameDamping * damping) return {own, at, {}, {}};
        Reached reached = measure(damping, at);
        tried.push_back(reached.step);
        return reached;
    };
    const auto isKept = [](const Reached& reached) { return reached.step.gain >= kKept * reached.step.promised; };
    Reached best = reach(first_damping, target);
    const TriedStep first = best.step;
    if (isKept(best) && !best.step.falls) return Step::contrary;
    if (!isKept(best)) {
        double length = calcPriorSquare(target - present, set);
        for (double damping = kFirstDamping * std::max(1.0, first_damping);; damping *= kFirstDamping) {
            const Eigen::VectorXd at = keepInRange(problem_, evidence.solveNear(slope, damping));
            if (!(here - objective(at) >= least)) break;  // so little is not worth the next columns
            const double shorter = calcPriorSquare(at - present, set);
            if (shorter > kShorter * length) continue;
            length = shorter;
            Reached nearer = reach(damping, at);
            const bool kept = isKept(nearer);
            if (kept && !nearer.step.falls) return Step::contrary;
            if (!(best.step.gain >= nearer.step.gain)) best = std::move(nearer);
            if (kept) break;
        }
    }
    if (!(best.step.gain > std::max(kGained * least, kPromised * best.step.promised))) {
        // Where noise comes in bursts the promise counts little of what the equations' own squares give, and the excess
        // all of it: as much less left as was promised bears a step out that nothing else does.
        if (!(first.fall >= first.promised)) return Step::none;
        best = measure(first_damping, target);
        best.step.gain = first.promised;
    }
    if (!best.step.falls) return Step::contrary;
    if (best.equations.at.empty()) best = measure(best.step.damping, best.at);
    point = std::move(best.point);
    equations = std::move(best.equations);
    return best.step.gain >= least ? Step::onwards : Step::last;
}

/// A step of the set: with the present discrepancy, or, undamped, with the one that its estimate would leave.
Settler::Step Settler::improve(SetState& state, bool with_validation, double damping,
                               std::vector<TriedStep>& tried) const {
    Information all = sumOf(state.view, with_validation);
    const std::vector<double> misfits = calcMisfits(all, problem_.estimateOf(state.point));
    const double least = std::max(2 * kSettled, kWorthwhile * calcCost(all, misfits));
    PointEquations equations;
    const auto advanced = [&](const BlockScales& scales, std::vector<TriedStep>& from_here) {
        return advance(all, state.set, scales, least, with_validation, damping, from_here, state.point, equations);
    };
    std::vector<TriedStep> others;
    Step step = advanced(scalesOf(misfits), tried);
    if (step == Step::none && damping == 0)
        step = advanced(settleScales(all, state.set, problem_.estimateOf(state.point)), others);
    if (step == Step::contrary) {
        for (BlockInformation& block : all) block.scatter.resize(0, 0);
        others.clear();
        step = advanced(scalesOf(misfits), others);
    }
    if (step != Step::none) state.view = problem_.view(state.point, state.set, std::move(equations));
    return step;
}

TestPoint Settler::refine(TestPoint point, const HypothesisSet& set, const BlockScales& scales, int most) const {
    PointEquations equations;
    for (int pass = 0; pass < most; ++pass) {
        const Information all = sumOf(problem_.view(point, set, std::move(equations)), true);
        std::vector<TriedStep> tried;
        if (advance(all, set, scales, 2 * kSettled, true, 0, tried, point, equations) != Step::onwards) break;
    }
    return point;
}

double Settler::calcCostAt(const TestPoint& point) const {
    const Information actual = calcActual(point, true);
    return calcCost(actual, calcMeanSquares(actual));
}

double Settler::calcLogEvidence(const SetState& state) const {
    const Information all = sumOf(state.view, true);
    const Eigen::VectorXd estimate = problem_.estimateOf(state.point);
    return SetEvidence(problem_, all, state.scales, state.set, estimate).solve().occam -
           0.5 * (calcCost(all, calcMisfits(all, estimate)) + calcPriorSquare(estimate, state.set));
}

SetSolution Settler::solveSettled(const Information& all,
                                  const std::function<SetSolution(const BlockScales&)>& solve) const {
    return solve(settleScales(all, solve));
}

double Settler::calcLogEvidence(const Information& all, const SetSolution& solution) const {
    return solution.occam - 0.5 * (calcCost(all, calcMisfits(all, solution.mean)) + solution.prior_square);
}

double Settler::calcPriorSquare(const Eigen::VectorXd& estimate, const HypothesisSet& set) const {
    return estimate.dot(calcPriorSlope(problem_, estimate, set));
}

}  // namespace wems::identify::updating
