/// @file
/// Runs as free simulations are compared with: as they were recorded, but for the faults of sensors that a set of
/// causes names. Those belong to the set-up (contract, section 6), and what they have wrong is no error of the model.
/// What sensors have wrong within their tolerance stays in the recordings.
#pragma once

#include <cstddef>
#include <vector>

#include "identify/updating/test_problem.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify::updating {

/// Some neighbouring runs of a problem, which must outlive this.
class FreeRuns {
public:
    /// @param first index among the problem's runs
    FreeRuns(const TestProblem& problem, std::size_t first, std::size_t count);
    FreeRuns(const FreeRuns&) = delete;
    FreeRuns& operator=(const FreeRuns&) = delete;

    std::size_t first() const { return first_; }
    /// Of a model, against the runs as they were recorded.
    FreeError calcError(const MountModel& model) const { return calcFreeError(recorded_, model); }
    /// Of a point's model, against the runs without the faults of sensors that the set names.
    FreeError calcError(const TestPoint& point, const HypothesisSet& set) const;
    /// What a model makes of the noise in what drives (driven_noise.hpp), of the squared error.
    DrivenNoise calcDriven(const MountModel& model, unsigned seed) const;
    /// The noise floor with that.
    double calcNoiseFloor(const MountModel& model, unsigned seed) const;

    /// Runs without those faults, and the motions that they point at.
    struct Corrected {
        std::vector<TestProblem::ExactRun> exact;
        std::vector<FreeRun> runs;
    };
    Corrected correct(const TestPoint& point, const HypothesisSet& set) const;

private:
    const TestProblem& problem_;
    std::size_t first_;
    std::vector<FreeRun> recorded_;
};

}  // namespace wems::identify::updating
