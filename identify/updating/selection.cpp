#include "identify/updating/selection.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace wems::identify::updating {
namespace {

constexpr int kMostRounds = 12;
constexpr std::size_t kBeam = 6;        // sets that a search follows
constexpr std::size_t kMostCauses = 6;  // of one answer: more describe, they do not explain
constexpr std::size_t kShown = 8;       // candidates of a round that its record keeps
constexpr int kHalvings = 2;
constexpr int kMostSettling = 16, kMostRefining = 3;  // Gauss–Newton steps
constexpr std::size_t kTried = 8;                     // sets of a round that are judged where they lead
constexpr double kSettled = 0.5;                      // log evidence that a further step would still change
constexpr double kWorthwhile = 0.003;  // of the cost: far from the noise, the last bit of a fit decides nothing
// What a model leaves beyond the noise is alike at frequencies closer than this part of the lowest excited one.
constexpr double kAlike = 0.2;
constexpr double kUnlikely = 5;  // log evidence below the present set's: what is less likely by far is not tried
// Of the gain that the quadratic promises, what must be there for a step to be taken (Armijo's rule).
constexpr double kEnough = 0.1;
constexpr int kMostScalings = 30;
constexpr double kScalesSettled = 0.02;  // relative change: evidence follows to 1 % of what it is

Information sumOf(const TestView& view, bool with_validation) {
    Information all = view.identification;
    if (with_validation) add(all, view.validation);
    return all;
}

/// How many neighbouring values what exceeds the noise has in common.
double calcAlike(const TestProblem& problem) {
    double alike = 1;
    for (const TestRun& run : problem.runs()) {
        const double duration = run.motion.time.back() - run.motion.time.front();
        alike = std::max(alike, kAlike * run.band.lowest * duration);
    }
    return alike;
}

/// Misfit of each block, and the scales that follow: what exceeds the noise comes in stretches that are alike, so that
/// it weighs as fewer values.
BlockScales scalesOf(const std::vector<double>& misfits, double alike) {
    BlockScales scales;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        scales[k].scale = 1 + std::max(0.0, misfits[k] - 1) * alike;
        scales[k].level = std::max(0.0, misfits[k]);
    }
    return scales;
}

/// −2 log likelihood of blocks whose scale is not known but follows from their misfit: the integral of dχ² / scale.
double calcCost(const Information& all, const std::vector<double>& misfits, double alike) {
    double cost = 0;
    for (std::size_t k = 0; k < kBlocks; ++k) {
        const double excess = misfits[k] - 1;
        cost += all[k].count * (excess > 0 ? std::log1p(alike * excess) / alike : excess);
    }
    return cost;
}

bool areAlike(const BlockScales& a, const BlockScales& b) {
    for (std::size_t k = 0; k < kBlocks; ++k)
        if (std::abs(a[k].scale - b[k].scale) > kScalesSettled * a[k].scale) return false;
    return true;
}

std::vector<double> calcMisfits(const Information& all, const Eigen::VectorXd& estimate) {
    std::vector<double> misfits;
    for (std::size_t k = 0; k < kBlocks; ++k) misfits.push_back(calcBlockMisfit(all[k], estimate));
    return misfits;
}

/// The evidence of one set alone: its members, and nothing else to weigh.
class SetEvidence {
public:
    SetEvidence(const TestProblem& problem, const Information& all, const BlockScales& scales, const HypothesisSet& set)
        : members_(collect(problem, set)),
          evidence_(combine(all, scales, problem.reaches()), problem.deviations(), members_) {
        for (std::size_t i = 0; i < members_.size(); ++i) all_.push_back(static_cast<int>(i));
    }
    SetEvidence(const SetEvidence&) = delete;
    SetEvidence& operator=(const SetEvidence&) = delete;
    SetSolution solve() const { return evidence_.solve(all_); }
    double calcChange(const Eigen::VectorXd& estimate) const { return evidence_.calcChange(estimate); }
    Posterior calcPosterior() const { return evidence_.calcPosterior(all_); }

private:
    static std::vector<Hypothesis> collect(const TestProblem& problem, const HypothesisSet& set) {
        std::vector<Hypothesis> members;
        for (const int h : set) members.push_back(problem.hypotheses()[static_cast<std::size_t>(h)]);
        return members;
    }
    std::vector<Hypothesis> members_;
    HypothesisSet all_;
    Evidence evidence_;
};

/// What a set says and where: two sets of one statement differ only in where they began to look.
std::string signatureOf(const TestProblem& problem, const HypothesisSet& set) {
    std::vector<std::string> statements;
    for (const int h : set) statements.push_back(describe(problem.hypotheses()[static_cast<std::size_t>(h)]));
    std::sort(statements.begin(), statements.end());
    std::string text;
    for (const auto& statement : statements) text += statement + "; ";
    return text;
}

class Selector {
public:
    Selector(TestProblem& problem, const std::function<void(const std::string&)>& progress)
        : problem_(problem), progress_(progress), alike_(calcAlike(problem)) {}

    Selection run() {
        tell("equations of motion");
        result_.point = problem_.believedPoint();
        result_.view = problem_.view(result_.point, result_.set);
        settle(kMostSettling, true);
        result_.adjusted = result_.point;
        for (int round = 0; round < kMostRounds; ++round)
            if (!step(round)) break;
        result_.fitted = result_.point;
        result_.fitted_posterior =
            makeEvidence(problem_, result_.view, result_.scales, true).calcPosterior(result_.set);
        // What is predicted for the validation runs rests on the identification runs alone.
        settle(kMostRefining, false);
        result_.view = problem_.view(result_.point);
        result_.posterior = makeEvidence(problem_, result_.view, result_.scales, false).calcPosterior(result_.set);
        return std::move(result_);
    }

private:
    /// A set, where its estimate leads, and what the equations really say there.
    struct Trial {
        HypothesisSet set;
        TestPoint point;
        double log_evidence = 0;  ///< of the quadratic, less half of what the misfit exceeds the quadratic's by
    };

    void tell(const std::string& text) const {
        if (progress_) progress_(text);
    }

    /// Scales at which a set's estimate leaves what they say, by the quadratic. From those of a perfect model upwards,
    /// so that a set is given the chance to explain before what it leaves is called discrepancy.
    BlockScales settleScales(const Information& all, const HypothesisSet& set) const {
        BlockScales scales;
        for (int pass = 0; pass < kMostScalings; ++pass) {
            const BlockScales next =
                scalesOf(calcMisfits(all, SetEvidence(problem_, all, scales, set).solve().mean), alike_);
            const bool settled = areAlike(scales, next);
            scales = next;
            if (settled) break;
        }
        return scales;
    }

    /// How much more than its quadratic a view's misfit is at a point, each block over its scale: what the laws and
    /// sensors do beyond first order.
    double calcExcess(const TestView& view, const TestPoint& point, const Eigen::VectorXd& estimate,
                      const BlockScales& scales, bool with_validation) const {
        // Sensors are linear, but their columns hold less noise than their channels: they stay where the view has them.
        TestPoint moved = point;
        Eigen::VectorXd at = estimate;
        const Eigen::VectorXd present = problem_.estimateOf(view.at);
        moved.state.sensors = view.at.state.sensors;
        for (std::size_t i = 0; i < problem_.table().size(); ++i)
            if (problem_.table()[i].kind >= UnknownKind::channel_gain)
                at[static_cast<Eigen::Index>(i)] = present[static_cast<Eigen::Index>(i)];
        const TestMisfit misfit = problem_.misfit(moved, view);
        Information actual = misfit.identification;
        if (with_validation) add(actual, misfit.validation);
        const Information quadratic = sumOf(view, with_validation);
        double excess = 0;
        for (std::size_t k = 0; k < kBlocks; ++k)
            if (!actual[k].empty())
                excess +=
                    (actual[k].chi_squared - calcBlockMisfit(quadratic[k], at) * quadratic[k].count) / scales[k].scale;
        return excess;
    }

    /// Gauss–Newton steps of the present set, until the next would change the evidence by less than a half.
    void settle(int most, bool with_validation) {
        for (int pass = 0; pass < most; ++pass)
            if (!improve(with_validation)) break;
        const Information all = sumOf(result_.view, true);
        result_.scales = scalesOf(calcMisfits(all, problem_.estimateOf(result_.point)), alike_);
    }

    /// A step of the present set: to where the quadratic leads with the discrepancy that it would leave, or with the
    /// present one; or part of the way, where the equations are not of first order. @return false if there is none
    bool improve(bool with_validation) {
        const Information all = sumOf(result_.view, with_validation);
        const Eigen::VectorXd present = problem_.estimateOf(result_.point);
        const std::vector<double> misfits = calcMisfits(all, present);
        const double least = std::max(2 * kSettled, kWorthwhile * calcCost(all, misfits, alike_));
        for (const BlockScales& scales : {settleScales(all, result_.set), scalesOf(misfits, alike_)}) {
            const SetEvidence evidence(problem_, all, scales, result_.set);
            const Eigen::VectorXd target = evidence.solve().mean;
            const auto objective = [&](const Eigen::VectorXd& at) {
                return evidence.calcChange(at) + calcPriorSquare(at, result_.set);
            };
            const double here = objective(present);
            if (here - objective(target) < least) continue;
            const double own = calcExcess(result_.view, result_.point, present, scales, with_validation);
            double share = 1;
            for (int halving = 0; halving <= kHalvings; ++halving, share *= 0.5) {
                const Eigen::VectorXd at = present + share * (target - present);
                TestPoint point = problem_.pointAt(at, result_.set);
                const double excess = calcExcess(result_.view, point, at, scales, with_validation) - own;
                if (!(here - objective(at) - excess > kEnough * (here - objective(at)))) continue;
                result_.point = std::move(point);
                result_.view = problem_.view(result_.point, result_.set);
                return true;
            }
        }
        return false;
    }

    /// C⁻¹ ε on the columns that a set moves, C their prior covariance: the slope of −log prior there.
    Eigen::VectorXd calcPriorSlope(const Eigen::VectorXd& estimate, const HypothesisSet& set) const {
        const Eigen::VectorXd deviation = problem_.deviations();
        Eigen::VectorXd slope = Eigen::VectorXd::Zero(deviation.size());
        std::vector<char> member(static_cast<std::size_t>(deviation.size()), 0);
        std::vector<Eigen::Index> freed;
        for (const int h : set)
            for (const auto& direction : problem_.hypotheses()[static_cast<std::size_t>(h)].directions)
                for (const auto& [column, weight] : direction)
                    if (!std::exchange(member[static_cast<std::size_t>(column)], 1)) freed.push_back(column);
        for (Eigen::Index i = 0; i < deviation.size(); ++i)
            if (deviation[i] > 0 && !member[static_cast<std::size_t>(i)])
                slope[i] = estimate[i] / (deviation[i] * deviation[i]);
        if (freed.empty()) return slope;
        Eigen::MatrixXd C = deviation(freed).cwiseAbs2().asDiagonal();
        for (const int h : set)
            for (const auto& direction : problem_.hypotheses()[static_cast<std::size_t>(h)].directions) {
                Eigen::VectorXd along = Eigen::VectorXd::Zero(C.rows());
                for (const auto& [column, weight] : direction)
                    along[std::find(freed.begin(), freed.end(), column) - freed.begin()] += weight;
                C += along * along.transpose();
            }
        const Eigen::VectorXd size = C.diagonal().cwiseSqrt();
        const Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * C * size.cwiseInverse().asDiagonal();
        slope(freed) = size.cwiseInverse().cwiseProduct(
            scaled.completeOrthogonalDecomposition().solve(estimate(freed).cwiseQuotient(size)));
        return slope;
    }
    double calcPriorSquare(const Eigen::VectorXd& estimate, const HypothesisSet& set) const {
        return estimate.dot(calcPriorSlope(estimate, set));
    }

    /// @return false when nothing changes any more
    bool step(int round) {
        tell("round " + std::to_string(round + 1));
        result_.view = problem_.view(result_.point);
        result_.scales = scalesOf(calcMisfits(sumOf(result_.view, true), problem_.estimateOf(result_.point)), alike_);
        const Evidence evidence = makeEvidence(problem_, result_.view, result_.scales, true);
        // One cause more at a time: the next one is sought about a state that has this one.
        const std::size_t largest = std::min(kMostCauses, result_.set.size() + 1);
        const std::vector<Trial> trials = tryBest(evidence, evidence.search({result_.set}, kBeam, largest));
        const auto best = std::max_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
            return a.log_evidence < b.log_evidence;
        });
        result_.ranked.clear();
        for (const Trial& trial : trials) result_.ranked.push_back({trial.set, trial.log_evidence});
        std::sort(result_.ranked.begin(), result_.ranked.end(),
                  [](const RankedSet& a, const RankedSet& b) { return a.log_evidence > b.log_evidence; });
        const bool same = best == trials.begin();
        Decision decision = record(evidence, best->set);
        decision.action = same ? "nothing more to add, take away or exchange" : "causes changed";
        result_.decisions.push_back(decision);
        if (same) return false;
        result_.set = best->set;
        problem_.adopt(result_.set);
        // Rows count from new believed values and columns are others now.
        result_.point = problem_.pointAt(problem_.estimateOf(best->point), result_.set);
        result_.view = problem_.view(result_.point, result_.set);
        settle(kMostRefining, true);
        return true;
    }

    /// The present set, then the best few by the quadratic, each judged where its estimate lies: laws and sensors are
    /// not of first order.
    std::vector<Trial> tryBest(const Evidence& evidence, const std::vector<RankedSet>& ranked) {
        const Eigen::VectorXd present = problem_.estimateOf(result_.point);
        std::vector<Trial> trials{{result_.set, result_.point, evidence.calcLogEvidence(result_.set)}};
        std::vector<std::string> known{signatureOf(problem_, result_.set)};
        const SetSolution settled = evidence.solve(result_.set);
        // The present point is near the quadratic's estimate of its set: a trial differs from it as the estimates do.
        const Eigen::VectorXd shift = present - settled.mean;
        const double own = calcExcess(result_.view, result_.point, present, result_.scales, true);
        for (const RankedSet& entry : ranked) {
            if (trials.size() > kTried) break;
            const std::string signature = signatureOf(problem_, entry.members);
            if (std::find(known.begin(), known.end(), signature) != known.end()) continue;
            const SetSolution solution = evidence.solve(entry.members);
            if (!isPossible(solution.mean, entry.members)) continue;
            known.push_back(signature);
            const double best = std::max_element(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
                                    return a.log_evidence < b.log_evidence;
                                })->log_evidence;
            const Eigen::VectorXd target = solution.mean + shift;
            Trial trial{entry.members, problem_.pointAt(target, entry.members), entry.log_evidence};
            const double excess = calcExcess(result_.view, trial.point, target, result_.scales, true) - own;
            trial.log_evidence -= 0.5 * std::max(0.0, excess);
            if (entry.log_evidence > best && trial.log_evidence < best) {
                const double here = evidence.calcChange(present) + calcPriorSquare(present, result_.set) + own;
                const double gained = here - refine(trial, evidence);
                trial.log_evidence = std::max(
                    trial.log_evidence, std::min(entry.log_evidence, trials.front().log_evidence + solution.occam -
                                                                         settled.occam + 0.5 * gained));
            }
            trials.push_back(std::move(trial));
            if (entry.log_evidence < trials.front().log_evidence - kUnlikely) break;
        }
        return trials;
    }

    /// Whether mechanisms that the model lacks come out with the sign that they can have.
    bool isPossible(const Eigen::VectorXd& target, const HypothesisSet& set) const {
        for (const int h : set)
            for (const Direction& direction : problem_.hypotheses()[static_cast<std::size_t>(h)].directions)
                for (const auto& [column, weight] : direction) {
                    const auto row = static_cast<std::size_t>(column);
                    if (row >= problem_.table().size()) continue;
                    const Unknown& number = problem_.table()[row];
                    if (number.believed == number.least && target[column] < 0) return false;
                }
        return true;
    }

    /// Gauss–Newton steps of a trial that is not of first order.
    /// @return −2 log of likelihood and prior where they lead, as the present view has it
    double refine(Trial& trial, const Evidence& evidence) {
        const TestProblem::Memento before = problem_.adopt(trial.set);
        TestPoint point = trial.point;
        for (int pass = 0; pass < kMostRefining; ++pass) {
            const TestView view = problem_.view(point, trial.set);
            const SetEvidence around(problem_, sumOf(view, true), result_.scales, trial.set);
            const Eigen::VectorXd present = problem_.estimateOf(point), target = around.solve().mean;
            const auto objective = [&](const Eigen::VectorXd& at) {
                return around.calcChange(at) + calcPriorSquare(at, trial.set);
            };
            const double here = objective(present), start = calcExcess(view, point, present, result_.scales, true);
            if (here - objective(target) < 2 * kSettled) break;
            bool moved = false;
            double share = 1;
            for (int halving = 0; halving <= kHalvings && !moved; ++halving, share *= 0.5) {
                const Eigen::VectorXd at = present + share * (target - present);
                TestPoint next = problem_.pointAt(at, trial.set);
                const double gain = here - objective(at);
                const double excess = calcExcess(view, next, at, result_.scales, true) - start;
                if (!(gain - excess > kEnough * gain)) continue;
                point = std::move(next);
                moved = true;
            }
            if (!moved) break;
        }
        const double prior = calcPriorSquare(problem_.estimateOf(point), trial.set);
        problem_.restore(before);
        const Eigen::VectorXd estimate = problem_.estimateOf(point);
        trial.point = std::move(point);
        return evidence.calcChange(estimate) + prior +
               calcExcess(result_.view, trial.point, estimate, result_.scales, true);
    }

    Decision record(const Evidence& evidence, const HypothesisSet& best) const {
        Decision decision;
        for (const int h : best)
            decision.causes.push_back(describe(problem_.hypotheses()[static_cast<std::size_t>(h)]));
        decision.log_evidence = evidence.calcLogEvidence(best) - evidence.calcLogEvidence({});
        decision.misfit = calcMisfits(sumOf(result_.view, true), evidence.solve(best).mean);
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
    double alike_ = 1;
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

}  // namespace wems::identify::updating
