#include "identify/diagnose/selection.hpp"

#include <algorithm>
#include <cmath>

namespace wems::identify {
namespace {

constexpr int kMostRounds = 12;
constexpr std::size_t kBeam = 6;        // sets that a search follows
constexpr std::size_t kMostCauses = 6;  // of one answer: more describe, they do not explain
constexpr std::size_t kShown = 8;       // candidates of a round that its record keeps
constexpr int kHalvings = 2;
constexpr int kMostSettling = 16, kMostRefining = 3;  // Gauss–Newton steps
constexpr std::size_t kTried = 6;                     // sets of a round that are judged where they lead
constexpr double kSettled = 0.5;                      // log evidence that a further step would still change
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

double totalOf(const Information& all, const BlockScales& scales) {
    double total = 0;
    for (std::size_t k = 0; k < kBlocks; ++k)
        if (!all[k].empty()) total += all[k].chi_squared / scales[k].scale;
    return total;
}

class Selector {
public:
    Selector(TestProblem& problem, const std::function<void(const std::string&)>& progress)
        : problem_(problem), progress_(progress) {}

    Selection run() {
        tell("equations of motion");
        result_.point = problem_.believedPoint();
        result_.view = problem_.view(result_.point);
        settle(kMostSettling, true);
        result_.adjusted = result_.point;
        for (int round = 0; round < kMostRounds; ++round)
            if (!step(round)) break;
        // What is predicted for the validation runs rests on the identification runs alone.
        settle(kMostRefining, false);
        result_.posterior = makeEvidence(problem_, result_.view, result_.scales, false).calcPosterior(result_.set);
        return std::move(result_);
    }

private:
    void tell(const std::string& text) const {
        if (progress_) progress_(text);
    }

    /// Scales for a set at the present view: the estimate depends on them and they on it.
    BlockScales settleScales(const HypothesisSet& set) const {
        const Information all = sumOf(result_.view, true);
        BlockScales scales = calcScales(problem_, all, problem_.estimateOf(result_.point));
        for (int pass = 0; pass < 3; ++pass) {
            const Evidence evidence(combine(all, scales, problem_.reaches()), problem_.deviations(),
                                    problem_.hypotheses());
            scales = calcScales(problem_, all, evidence.calcMean(set));
        }
        return scales;
    }

    /// Gauss–Newton steps of the present set, until the next would change the evidence by less than a half.
    void settle(int most, bool with_validation) {
        for (int pass = 0; pass < most; ++pass) {
            result_.scales = settleScales(result_.set);
            const Evidence evidence = makeEvidence(problem_, result_.view, result_.scales, with_validation);
            const Eigen::VectorXd present = problem_.estimateOf(result_.point),
                                  estimate = evidence.calcMean(result_.set);
            const double gain = calcObjective(evidence, present) - calcObjective(evidence, estimate);
            if (gain < 2 * kSettled || !move(present, estimate, with_validation)) break;
        }
        result_.scales = settleScales(result_.set);
    }

    /// −2 log of likelihood and tolerances, beside a constant, as the quadratic has it.
    double calcObjective(const Evidence& evidence, const Eigen::VectorXd& estimate) const {
        return evidence.calcChange(estimate) + calcPriorSquare(estimate, result_.set);
    }
    double calcPriorSquare(const Eigen::VectorXd& estimate, const HypothesisSet& set) const {
        double sum = 0;
        const Eigen::VectorXd deviation = problem_.deviations();
        for (Eigen::Index i = 0; i < deviation.size(); ++i) {
            bool free = false;
            for (const int h : set)
                for (const auto& direction : problem_.hypotheses()[static_cast<std::size_t>(h)].directions)
                    for (const auto& [column, weight] : direction) free = free || column == i;
            if (!free && deviation[i] > 0) sum += std::pow(estimate[i] / deviation[i], 2);
        }
        return sum;
    }

    /// @return false when nothing changes any more
    bool step(int round) {
        const Evidence evidence = makeEvidence(problem_, result_.view, result_.scales, true);
        tell("round " + std::to_string(round + 1));
        // One cause more at a time: the next one is sought about a state that has this one.
        const std::size_t largest = std::min(kMostCauses, result_.set.size() + 1);
        result_.ranked = evidence.search({result_.set}, kBeam, largest);
        const Trial best = tryBest(evidence);
        const bool same = best.set == result_.set;
        Decision decision = record(evidence, best.set);
        decision.action = same ? "nothing more to add, take away or exchange" : "causes changed";
        result_.decisions.push_back(decision);
        if (same) return false;
        result_.set = best.set;
        take(evidence.calcMean(best.set));
        settle(kMostRefining, true);
        return true;
    }

    /// A set and what the equations really say where its estimate lies.
    struct Trial {
        HypothesisSet set;
        double log_evidence = 0;
    };

    /// The best few sets by the quadratic, each judged where its estimate lies: covariance, laws and sensors follow.
    Trial tryBest(const Evidence& evidence) {
        Trial best{result_.set, evidence.calcLogEvidence(result_.set)};
        const Information here = sumOf(result_.view, true);
        double base = 0;  // total of the quadratic at the believed values
        for (std::size_t k = 0; k < kBlocks; ++k)
            if (!here[k].empty()) base += here[k].chi_squared / result_.scales[k].scale;
        const double floor = best.log_evidence;
        std::size_t tried = 0;
        for (RankedSet& ranked : result_.ranked) {
            if (ranked.log_evidence <= floor || tried == kTried) break;
            ++tried;
            const Eigen::VectorXd estimate = evidence.calcMean(ranked.members);
            const double predicted = base + evidence.calcChange(estimate);
            const double actual = totalOf(problem_.misfit(problem_.pointAt(estimate, ranked.members)), result_.scales);
            if (actual > predicted) ranked.log_evidence -= 0.5 * (actual - predicted);
            if (ranked.log_evidence > best.log_evidence) best = {ranked.members, ranked.log_evidence};
        }
        std::sort(result_.ranked.begin(), result_.ranked.end(),
                  [](const RankedSet& a, const RankedSet& b) { return a.log_evidence > b.log_evidence; });
        return best;
    }

    double calcTotal(const TestView& view, const TestPoint& point, bool with_validation) const {
        const Eigen::VectorXd at = problem_.estimateOf(point);
        const Information all = sumOf(view, with_validation);
        double total = calcPriorSquare(at, result_.set);
        for (std::size_t k = 0; k < kBlocks; ++k)
            total += calcBlockMisfit(all[k], at) * all[k].count / result_.scales[k].scale;
        return total;
    }

    /// To the estimate, or part of the way if the misfit does not follow. @return false if it never does
    bool move(const Eigen::VectorXd& present, const Eigen::VectorXd& estimate, bool with_validation) {
        const double before = calcTotal(result_.view, result_.point, with_validation);
        double share = 1;
        for (int halving = 0; halving <= kHalvings; ++halving, share *= 0.5) {
            const Eigen::VectorXd target = present + share * (estimate - present);
            TestPoint point = problem_.pointAt(target, result_.set);
            TestView view = problem_.view(point);
            if (calcTotal(view, point, with_validation) > before) continue;
            result_.point = std::move(point);
            result_.view = std::move(view);
            return true;
        }
        return false;
    }

    /// To the estimate of a set that has just been chosen; what it sought far off becomes part of the table.
    void take(const Eigen::VectorXd& estimate) {
        result_.point = problem_.pointAt(estimate, result_.set);
        problem_.adopt(result_.set);
        // Rows count from new believed values and columns are others now.
        result_.point = problem_.pointAt(problem_.estimateOf(result_.point), result_.set);
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
