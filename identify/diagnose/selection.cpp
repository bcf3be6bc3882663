#include "identify/diagnose/selection.hpp"

#include <algorithm>
#include <cmath>

namespace wems::identify {
namespace {

constexpr int kMostRounds = 12;
constexpr std::size_t kBeam = 6;        // sets that a search follows
constexpr std::size_t kMostCauses = 6;  // of one answer: more describe, they do not explain
constexpr std::size_t kShown = 8;       // candidates of a round that its record keeps
constexpr int kHalvings = 3;
constexpr double kWorse = 1.02;   // of the misfit, that a step may cost by what is of second order
constexpr double kSettled = 0.3;  // standard errors that the estimate still moves
// What a model leaves beyond the noise is alike at frequencies closer than this part of the lowest excited one.
constexpr double kAlike = 0.2;

Information sumOf(const TestView& view, bool with_validation) {
    Information all = view.identification;
    if (with_validation) add(all, view.validation);
    return all;
}

/// Misfit of each block at an estimate, and the scales that follow: what exceeds the noise comes in stretches that are
/// alike, so that it weighs as fewer values.
BlockScales calcScales(const TestProblem& problem, const Information& all, const Eigen::VectorXd& estimate) {
    double alike = 0;
    for (const TestRun& run : problem.runs()) {
        const double duration = run.motion.time.back() - run.motion.time.front();
        alike = std::max(alike, kAlike * run.band.lowest * duration);
    }
    BlockScales scales;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        const double misfit = std::max(0.0, calcBlockMisfit(all[k], estimate));
        scales[k].scale = 1 + std::max(0.0, misfit - 1) * std::max(1.0, alike);
        scales[k].level = misfit;
    }
    return scales;
}

std::vector<double> calcMisfits(const Information& all, const Eigen::VectorXd& estimate) {
    std::vector<double> misfits;
    for (std::size_t k = 0; k < kBlocks; ++k) misfits.push_back(calcBlockMisfit(all[k], estimate));
    return misfits;
}

Eigen::VectorXd calcEstimate(const TestProblem& problem, const TestPoint& point) {
    Eigen::VectorXd estimate = point.values;
    for (std::size_t i = 0; i < problem.table().size(); ++i)
        estimate[static_cast<Eigen::Index>(i)] -= problem.table()[i].believed;
    return estimate;
}

class Selector {
public:
    Selector(TestProblem& problem, const std::function<void(const std::string&)>& progress)
        : problem_(problem), progress_(progress) {}

    Selection run() {
        tell("equations of motion");
        result_.point = problem_.believedPoint();
        result_.view = problem_.view(result_.point);
        for (int round = 0; round < kMostRounds; ++round)
            if (!step(round)) break;
        finish();
        return std::move(result_);
    }

private:
    void tell(const std::string& text) const {
        if (progress_) progress_(text);
    }

    /// Scales for a set at the present view: the estimate depends on them and they on it.
    BlockScales settleScales(const HypothesisSet& set) const {
        const Information all = sumOf(result_.view, true);
        BlockScales scales = calcScales(problem_, all, calcEstimate(problem_, result_.point));
        for (int pass = 0; pass < 3; ++pass) {
            const Evidence evidence(combine(all, scales, problem_.reaches()), problem_.deviations(),
                                    problem_.hypotheses());
            scales = calcScales(problem_, all, evidence.calcMean(set));
        }
        return scales;
    }

    /// @return false when nothing changes any more
    bool step(int round) {
        result_.scales = settleScales(result_.set);
        const Evidence evidence = makeEvidence(problem_, result_.view, result_.scales, true);
        tell("round " + std::to_string(round + 1));
        // One cause more at a time: the next one is sought about a state that has this one.
        const std::size_t largest = std::min(kMostCauses, result_.set.size() + 1);
        result_.ranked = evidence.search({result_.set}, kBeam, largest);
        const HypothesisSet best = result_.ranked.front().members;
        const bool same = best == result_.set;
        Decision decision = record(evidence, best);
        const Evidence own = makeEvidence(problem_, result_.view, result_.scales, false);
        const Eigen::VectorXd estimate = own.calcMean(best), present = calcEstimate(problem_, result_.point);
        const bool settled = same && isSettled(own, best, estimate, present);
        if (settled) {
            decision.action = "nothing more to add, take away or exchange";
            result_.decisions.push_back(decision);
            return false;
        }
        decision.action = same ? "the same causes, values refined" : "causes changed";
        result_.decisions.push_back(decision);
        move(best, present, estimate);
        return true;
    }

    bool isSettled(const Evidence& own, const HypothesisSet& set, const Eigen::VectorXd& estimate,
                   const Eigen::VectorXd& present) const {
        const Posterior posterior = own.calcPosterior(set);
        const auto rows = static_cast<Eigen::Index>(problem_.table().size());
        for (Eigen::Index i = 0; i < rows; ++i) {
            const double deviation = std::sqrt(std::max(0.0, posterior.covariance(i, i)));
            if (std::abs(estimate[i] - present[i]) >
                kSettled * deviation + 1e-9 * std::abs(problem_.table()[static_cast<std::size_t>(i)].reach))
                return false;
        }
        return true;
    }

    double calcTotal(const TestView& view, const TestPoint& point) const {
        const Eigen::VectorXd at = calcEstimate(problem_, point);
        double total = 0;
        for (std::size_t k = 0; k < kBlocks; ++k)
            total +=
                calcBlockMisfit(view.identification[k], at) * view.identification[k].count / result_.scales[k].scale;
        return total;
    }

    /// To the estimate, or part of the way if the misfit does not follow.
    void move(const HypothesisSet& set, const Eigen::VectorXd& present, const Eigen::VectorXd& estimate) {
        const double before = calcTotal(result_.view, result_.point);
        double share = 1;
        for (int halving = 0;; ++halving, share *= 0.5) {
            Eigen::VectorXd target = present + share * (estimate - present);
            TestPoint point = problem_.pointAt(target, set);
            TestView view = problem_.view(point);
            const bool good = calcTotal(view, point) <= kWorse * before;
            if (!good && halving < kHalvings) continue;
            result_.point = std::move(point);
            result_.view = std::move(view);
            break;
        }
        bool adopted = false;
        for (const int h : set)
            adopted = adopted || !problem_.hypotheses()[static_cast<std::size_t>(h)].tangent.empty();
        result_.set = set;
        if (!adopted) return;
        problem_.adopt(set);
        // Rows count from new believed values and columns are others now.
        const Eigen::VectorXd target = calcEstimate(problem_, result_.point);
        result_.point = problem_.pointAt(target, set);
        result_.view = problem_.view(result_.point);
    }

    Decision record(const Evidence& evidence, const HypothesisSet& best) const {
        Decision decision;
        for (const int h : best)
            decision.causes.push_back(describe(problem_.hypotheses()[static_cast<std::size_t>(h)]));
        decision.log_evidence = evidence.calcLogEvidence(best) - evidence.calcLogEvidence({});
        decision.misfit = calcMisfits(sumOf(result_.view, true), evidence.calcMean(best));
        const double base = evidence.calcLogEvidence(result_.set);
        const auto extended = evidence.calcExtensions(result_.set);
        std::vector<std::size_t> order(extended.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return extended[a] > extended[b]; });
        for (std::size_t i = 0; i < std::min(kShown, order.size()); ++i) {
            const auto& hypothesis = problem_.hypotheses()[order[i]];
            if (std::isfinite(extended[order[i]]))
                decision.candidates.push_back({hypothesis.cause, hypothesis.where, extended[order[i]] - base});
        }
        return decision;
    }

    void finish() {
        const Evidence own = makeEvidence(problem_, result_.view, result_.scales, false);
        result_.posterior = own.calcPosterior(result_.set);
        // Adjustments alone: about the believed state, where no cause bends them.
        TestPoint point = problem_.believedPoint();
        const TestView view = result_.set.empty() ? result_.view : problem_.view(point);
        BlockScales scales;
        for (int pass = 0; pass < 3; ++pass) {
            const Evidence evidence = makeEvidence(problem_, view, scales, false);
            const Eigen::VectorXd mean = evidence.calcMean({});
            scales = calcScales(problem_, sumOf(view, false), mean);
            point = problem_.pointAt(mean, {});
        }
        result_.adjusted = result_.set.empty() ? result_.point : point;
    }

    TestProblem& problem_;
    const std::function<void(const std::string&)>& progress_;
    Selection result_;
};

}  // namespace

Evidence makeEvidence(const TestProblem& problem, const TestView& view, const BlockScales& scales,
                      bool with_validation) {
    return {combine(sumOf(view, with_validation), scales, problem.reaches()), problem.deviations(),
            problem.hypotheses()};
}

double Selection::probabilityOf(int hypothesis) const {
    double with = 0, all = 0;
    for (const RankedSet& entry : ranked) {
        const double weight = std::exp(entry.log_evidence - ranked.front().log_evidence);
        all += weight;
        if (std::binary_search(entry.members.begin(), entry.members.end(), hypothesis)) with += weight;
    }
    return all > 0 ? with / all : 0;
}

std::string describe(const Hypothesis& hypothesis) {
    std::string text = hypothesis.cause;
    for (const auto& place : hypothesis.where) text += " " + place;
    return text;
}

Selection selectCauses(TestProblem& problem, const std::function<void(const std::string&)>& progress) {
    return Selector(problem, progress).run();
}

}  // namespace wems::identify
