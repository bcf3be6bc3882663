/// @file
/// The most probable numbers of one set of causes: steps of Gauss and Newton on the posterior, damped as Levenberg's
/// (1944) while the equations are far from satisfied and where steps lose what they promise. Each is tried by the
/// equations themselves, with the size of the discrepancy following what the set leaves.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <vector>

#include "identify/updating/set_evidence.hpp"
#include "identify/updating/test_problem.hpp"

namespace wems::identify::updating {

/// A set of causes, where its numbers lie, and what all runs say about that point.
struct SetState {
    HypothesisSet set;
    TestPoint point;
    TestView view;  ///< at `point`
    BlockScales scales;
};

/// Gauss–Newton steps of a set that begins near its best numbers.
inline constexpr int kMostRefining = 3;

/// Log evidence that a further step would still change.
inline constexpr double kSettled = 0.5;

class Settler {
public:
    explicit Settler(const TestProblem& problem);

    /// Steps until one changes the evidence by less than a half, or would do so, `most` at most. The view keeps the
    /// columns of the set alone, if a step was taken, and has them of the point where it ends.
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
    /// Circling: columns formed anew offer as much as before the last steps.
    enum class Step { none, circling, contrary, last, onwards };

    /// What a step of some damping came to. Less damped steps from the same state come to it again where they lose what
    /// they promise: the equations of all runs take most of a diagnosis' time.
    struct TriedStep {
        double damping, promised, gain;  ///< by the quadratic; by the equations
        double fall;                     ///< of what is left, prior included
        bool falls;                      ///< what is left, where it must
    };

    struct StepMemory {
        std::vector<TriedStep> tried;                              ///< from the present state
        double offered = std::numeric_limits<double>::infinity();  ///< of a whole step, by columns formed for it
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
    /// A step of a state, with the columns that it has. Those of earlier points are believed as long as the equations
    /// bear out what a step of them promises.
    /// @param[in,out] memory of steps from this state with the present discrepancy
    Step improve(SetState& state, bool with_validation, double damping, StepMemory& memory) const;
    /// The same of a state whose columns are those of an earlier point: none where a step does not keep its promise.
    Step improveHeld(SetState& state, bool with_validation, double damping) const;
    /// Columns of its own for a state that has those of an earlier point.
    void lookAgain(SetState& state) const;
    /// Log evidence by the present quadratic from which on a step is worth it.
    double calcLeast(const Information& all, const std::vector<double>& misfits) const;
    /// @param held whether the quadratic's columns are those of an earlier point
    /// @param[in,out] memory of steps from this point with these scales
    /// @param[out] reached the equations of the point that a step led to
    Step advance(const Information& all, const HypothesisSet& set, const BlockScales& scales, double least,
                 bool with_validation, double first_damping, bool held, StepMemory& memory, TestPoint& point,
                 TestMisfit& reached) const;

    const TestProblem& problem_;
    double alike_ = 1;
};

}  // namespace wems::identify::updating
