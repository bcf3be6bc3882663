/// @file
/// All runs of a test with the unknowns of its model and sensors: what `diagnose` asks, and what a state answers.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "identify/catalogue/hypotheses.hpp"
#include "identify/problem/linearised_run.hpp"
#include "identify/solve/evidence.hpp"
#include "identify/updating/linked_numbers.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify::updating {

/// Values of all unknowns: the table's rows, and the load's gains over frequency.
struct TestPoint {
    TestState state{MountModel{}, SensorErrors(SensorLayout{})};
    Eigen::VectorXd values;  ///< of each column; those of probes are zero
};

/// Sums over the runs of either kind.
struct TestInformation {
    Information identification, validation;
};

/// What all runs say about a point, its information about the believed values.
struct TestView : TestInformation {
    std::vector<LinearisedRun> runs;  ///< identification runs, then validation runs
    TestPoint at;
};

/// What misfit and columns of a point share.
struct PointEquations {
    std::shared_ptr<const std::vector<TestRun>> runs;  ///< as the point's sensors had them
    std::vector<std::shared_ptr<Lineariser>> at;       ///< of each run
};

/// χ² and count alone.
struct TestMisfit : TestInformation {
    PointEquations equations;
};

/// What is believed of the numbers that no hypothesis of a set moves. The corner of AC coupling, which no model states,
/// is free in either case.
enum class Numbers { exact, within_tolerances };

/// A copy shares the recordings; what it adopts, seeks and assumes is its own.
class TestProblem {
public:
    /// @throws InputError if the motion of a run cannot be recovered
    TestProblem(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                const MountModel& model, Numbers numbers = Numbers::within_tolerances);

    Numbers numbers() const { return numbers_; }
    void assume(Numbers numbers) { numbers_ = numbers; }
    /// Whether the model states that nothing has a tolerance: exact numbers are then all there is.
    bool exactlyKnown() const { return exactly_known_; }
    const UnknownTable& table() const { return table_; }
    const std::vector<Hypothesis>& hypotheses() const { return catalogue_.hypotheses; }
    const SensorLayout& layout() const { return layout_; }
    const std::vector<TestRun>& runs() const { return *runs_; }
    std::size_t identificationCount() const { return identification_count_; }
    /// Prior standard deviation of each column.
    Eigen::VectorXd deviations() const;
    /// What the prior knows under a set about an estimate (linked_numbers.hpp).
    std::vector<Direction> tolerances(const HypothesisSet& set, const Eigen::VectorXd& estimate) const;
    /// The same where a column is free.
    Eigen::VectorXd reaches() const;

    TestPoint believedPoint() const;
    /// Where an estimate (from the believed values) lies under a set of hypotheses. Values stay within their limits.
    TestPoint pointAt(const Eigen::VectorXd& estimate, const HypothesisSet& set) const;
    /// The inverse of pointAt within the limits: values minus believed ones.
    Eigen::VectorXd estimateOf(const TestPoint& point) const;
    /// The nearest point that a set can state: what neither a tolerance nor the set moves is as believed, and numbers
    /// that it moves by one factor have one, to their tolerances.
    TestPoint reduce(const TestPoint& point, const HypothesisSet& set) const;
    /// Of what drives a run: white noise of the density in the middle of what it is excited by.
    DriveNoise calcDriveNoise(std::size_t run) const;
    /// The motion of a run, which may drive it, and its relative displacements (calcMeasuredRelative) as exact sensors
    /// would have shown them.
    struct ExactRun {
        RunMotion motion;
        Eigen::MatrixXd relative;
    };
    ExactRun calcExactRun(std::size_t run, const TestPoint& point) const;
    /// All runs as exact sensors would have recorded them. The last ones are kept: not to be called by two threads.
    std::shared_ptr<const std::vector<TestRun>> correctRuns(const TestPoint& point) const;
    /// A point under a set with its members as far off as their probes were, if any has such.
    std::optional<TestPoint> goToProbes(const TestPoint& point, const HypothesisSet& set) const;
    /// What the hypotheses and the table were before an adoption.
    struct Memento {
        std::vector<Hypothesis> hypotheses;
        std::vector<double> believed;
    };
    /// What a taken hypothesis sought far from the state becomes part of the table; its directions are then tangents.
    /// What another had so made part of it is so no more.
    Memento adopt(const HypothesisSet& set);
    void restore(const Memento& memento);
    Memento remember() const;
    /// What the adoption of a hypothesis had set is, at a point, as it was before.
    void release(TestPoint& point, int hypothesis) const;
    /// Seeks a mode that the bracket lacks in what its equation leaves at a point; the hypothesis of one then starts
    /// from there. Nothing where a set holds that hypothesis already.
    void seekMissingMode(const TestPoint& point, const HypothesisSet& set);

    /// With the columns of all hypotheses.
    TestView view(const TestPoint& point) const;
    /// With those alone that tolerances and the members of a set move: for the steps of this set.
    /// @param equations of the point, as its misfit left them; formed here if empty
    TestView view(const TestPoint& point, const HypothesisSet& set, PointEquations equations = {}) const;
    /// With those of a set, and of further forces.
    TestView view(const TestPoint& point, const HypothesisSet& set, const std::vector<AddedCurve>& curves) const;
    /// What the equations leave, with no columns but those of further forces.
    TestView viewAlone(const TestPoint& point, const std::vector<AddedCurve>& curves = {}) const;
    /// χ² and count of each block, without derivatives, each run corrected and weighed as the point itself has it.
    TestMisfit misfit(const TestPoint& point) const;
    /// Gives back the memory of the recordings as the last point's sensors had them.
    void forgetCorrected() const { corrected_.reset(); }

    /// The model of a point as it is written and simulated: without what has no force.
    MountModel cleanModel(const TestPoint& point) const;

private:
    TestView view(const TestPoint& point, ColumnSet columns, PointEquations equations) const;
    /// Those that tolerances and the members of a set move.
    ColumnSet columnsOf(const HypothesisSet& set) const;
    PointEquations formEquations(const TestPoint& point) const;
    bool isAdopted(int hypothesis) const;
    /// Prior standard deviation of each column by itself, outside all hypotheses.
    Eigen::VectorXd ownDeviations() const;
    /// Measures the channels' noise again without what the sensors' errors make. A sweep shows its noise where it is
    /// not; under a drive that fills its band the errors are always there, and passed for noise.
    void calibrateNoise();
    /// A run as exact sensors would have recorded it, where they err.
    TestRun correctRun(const TestRun& run, const TestPoint& point) const;

    MountModel believed_;
    SensorLayout layout_;
    std::shared_ptr<const std::vector<TestRun>> runs_;
    std::size_t identification_count_ = 0;
    Numbers numbers_ = Numbers::within_tolerances;
    bool exactly_known_ = false;
    UnknownTable table_;
    CarriedRows carried_;
    Catalogue catalogue_;
    Memento pristine_;  // before any adoption
    struct CorrectedRuns {
        SensorErrors errors;
        std::shared_ptr<const std::vector<TestRun>> runs;
    };
    mutable std::optional<CorrectedRuns> corrected_;
};

}  // namespace wems::identify::updating
