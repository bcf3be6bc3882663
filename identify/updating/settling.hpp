/// @file
/// The most probable numbers of one set of causes: steps of Gauss and Newton on the posterior, damped as Levenberg's
/// (1944) while the equations are far from satisfied and where steps lose what they promise. Each is tried by the
/// equations themselves, with the size of the discrepancy following what the set leaves.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "identify/updating/test_problem.hpp"

namespace wems::identify::updating {

/// Misfit per value up to which equations of motion count as satisfied: noise, and what sampling makes of a stop, leave
/// 0.9 to 2.1 on recordings of another simulator whose cause is known.
inline constexpr double kSatisfied = 3;

/// Whether no block leaves so much.
bool isSatisfied(const std::vector<double>& misfits);

/// A set of causes, where its numbers lie, and what all runs say about that point.
struct SetState {
    HypothesisSet set;
    TestPoint point;
    TestView view;  ///< at `point`
    BlockScales scales;
};

/// The evidence of one set alone: its members, and nothing else to weigh.
class SetEvidence {
public:
    /// @param estimate about which tolerances are what they are (TestProblem::deviations)
    SetEvidence(const TestProblem& problem, const Information& all, const BlockScales& scales, const HypothesisSet& set,
                const Eigen::VectorXd& estimate, Growth growth = Growth::doubted);
    SetEvidence(const SetEvidence&) = delete;
    SetEvidence& operator=(const SetEvidence&) = delete;
    SetSolution solve() const { return evidence_.solve(all_); }
    Eigen::VectorXd solveNear(const Eigen::VectorXd& slope, double damping) const {
        return evidence_.solveNear(all_, slope, damping);
    }
    double calcChange(const Eigen::VectorXd& estimate) const { return evidence_.calcChange(estimate); }
    Posterior calcPosterior() const { return evidence_.calcPosterior(all_); }

private:
    std::vector<Hypothesis> members_;
    HypothesisSet all_;
    Evidence evidence_;
};

/// Evidence of all runs, or of the identification runs alone, at a view. @param set whose tolerances count there
Evidence makeEvidence(const TestProblem& problem, const TestView& view, const HypothesisSet& set,
                      const BlockScales& scales, bool with_validation);

/// Runs of a view together: the identification runs, or all.
Information sumOf(const TestInformation& runs, bool with_validation);

/// Misfit of each block at an estimate.
std::vector<double> calcMisfits(const Information& all, const Eigen::VectorXd& estimate);

/// χ² of each block over its count, of a misfit without quadratic.
std::vector<double> calcMeanSquares(const Information& actual);

/// Beyond the noise, of the block that leaves most.
double calcExcessOf(const std::vector<double>& misfits);

/// Whether noise comes in bursts, as in contact: V of information.hpp.
bool hasBursts(const Information& all);

/// Standard deviations of a misfit: less is noise, which any number may halve.
inline constexpr double kBeyondNoise = 1.96;
/// Standard deviation of each block's misfit if the model is perfect.
std::vector<double> calcScatter(const Information& all);
/// Whether no block leaves more than a perfect model would.
bool isNoiseAlone(const Information& all, const std::vector<double>& misfits);

/// Gauss–Newton steps of a set that begins near its best numbers.
inline constexpr int kMostRefining = 3;

/// Log evidence that a further step would still change.
inline constexpr double kSettled = 0.5;

class Settler {
public:
    explicit Settler(const TestProblem& problem);

    /// Steps until one changes the evidence by less than a half, or would do so, `most` at most. The view keeps the
    /// columns of the set alone, if a step was taken.
    /// @return whether it came to rest: from where it ended no step, damped or not, is worth it
    bool settle(SetState& state, int most, bool with_validation) const;

    /// Steps of a set that begins far from its best numbers, against a rival's log evidence: to its end, or until what
    /// undamped steps gain, as a geometric series, leaves it behind (Aitken, Proc. R. Soc. Edinburgh 46, 1926,
    /// extrapolates so).
    /// @return steps taken
    int compete(SetState& state, int most, double rival) const;

    /// Up to `most` steps of a set from a point, at scales that are held.
    TestPoint refine(TestPoint point, const HypothesisSet& set, const BlockScales& scales, int most) const;

    /// Misfit of each block, and the scales that follow: what exceeds the noise comes in stretches that are alike, so
    /// that it weighs as fewer values.
    BlockScales scalesOf(const std::vector<double>& misfits) const;

    /// How much more than its quadratic a view's misfit is at a point, each block over its scale: what the laws do
    /// beyond first order.
    double calcExcess(const TestView& view, const TestPoint& point, const Eigen::VectorXd& estimate,
                      const BlockScales& scales) const;

    /// −2 log likelihood of blocks whose scale is not known but follows from their misfit: the integral of dχ² / scale.
    double calcCost(const Information& all, const std::vector<double>& misfits) const;

    /// The same of all runs at a point.
    double calcCostAt(const TestPoint& point) const;

    /// Of a settled set, with a discrepancy whose size is not known: log likelihood of all runs, prior and Occam
    /// factor.
    double calcLogEvidence(const SetState& state) const;

    /// A quadratic's estimate at the scales that it leaves. @param solve the estimate at given scales
    SetSolution solveSettled(const Information& all, const std::function<SetSolution(const BlockScales&)>& solve) const;
    /// Its log evidence, as that of a settled set.
    double calcLogEvidence(const Information& all, const SetSolution& solution) const;

    /// −2 log prior of an estimate under a set, but for a constant.
    double calcPriorSquare(const Eigen::VectorXd& estimate, const HypothesisSet& set) const;

private:
    /// Whether a step was worth it, and whether the next may be: where the quadratic fails, small gains follow small
    /// ones for as long as they are taken. Contrary: what the equations bear out leaves more than there was.
    enum class Step { none, contrary, last, onwards };

    /// What a step of some damping came to. Less damped steps from the same state come to it again where they lose what
    /// they promise: the equations of all runs take most of a diagnosis' time.
    struct TriedStep {
        double damping, promised, gain;  ///< by the quadratic; by the equations
        double fall;                     ///< of what is left, prior included
        bool falls;                      ///< what is left, where it must
    };

    struct Settling {
        int steps = 0;
        bool at_rest = false;
    };
    /// @param is_worth_more asked after each step, with its damping
    Settling settle(SetState& state, int most, bool with_validation,
                    const std::function<bool(double)>& is_worth_more) const;
    /// χ² and count of each block at a point.
    Information calcActual(const TestPoint& point, bool with_validation) const;
    /// @param step from where the quadratic was formed; @param actual at `estimate`
    double calcExcess(const Information& quadratic, const Eigen::VectorXd& step, const Information& actual,
                      const Eigen::VectorXd& estimate, const BlockScales& scales, Growth growth) const;
    BlockScales settleScales(const Information& all, const std::function<SetSolution(const BlockScales&)>& solve) const;
    BlockScales settleScales(const Information& all, const HypothesisSet& set, const Eigen::VectorXd& estimate) const;
    /// Brings a state that steps leave where it is to the contacts that steps do not see (untouched_stops.hpp).
    /// @return whether one leaves less
    bool reachStops(SetState& state, bool with_validation) const;
    /// @param[in,out] tried from this state with the present discrepancy
    Step improve(SetState& state, bool with_validation, double damping, std::vector<TriedStep>& tried) const;
    /// @param[in,out] tried from this point with these scales
    /// @param[out] equations of the point that a step led to
    Step advance(const Information& all, const HypothesisSet& set, const BlockScales& scales, double least,
                 bool with_validation, double first_damping, std::vector<TriedStep>& tried, TestPoint& point,
                 PointEquations& equations) const;

    const TestProblem& problem_;
    double alike_ = 1;
};

}  // namespace wems::identify::updating
