/// @file
/// A first look at every candidate: how much of the residual would it take away, and with what values?
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "identify/exact/catalogue.hpp"
#include "identify/exact/open_loop_problem.hpp"

namespace wems::identify {

// Changes of the mount's residual where the law of some axes changes, quickly and to first order in the rotations.
//
// A force history f at axis a of connection i is a wrench along the fixed direction d = (e_a ; r_i × e_a), but for
// rotations of some hundredths of a radian. Its whitened spectrum is then W(ω) d F(ω): one transform in place of six,
// and the products with the calibration columns are those of F with (W d)ᴴ N, which do not depend on the force. Good
// for a first look at hundreds of candidates; fits take OpenLoopProblem::calcDifference.

class LawDifferences {
public:
    /// @param problem must outlive this
    explicit LawDifferences(const OpenLoopProblem& problem, const MountModel& model);

    /// Residual of `to` minus that of `from`, which differ in laws alone; values empty if no force differs. What was
    /// computed is remembered. May be called by several threads at once.
    WhiteVector calc(const MountModel& from, const MountModel& to) const;

    /// Drops what was remembered of other laws than those of `model`. Not while others call calc().
    void keepOnly(const MountModel& model);

private:
    /// A change of one axis' law: the force's spectrum in each run, empty where the force does not change.
    struct Change {
        AxisLaw from, to;
        std::vector<Eigen::VectorXcf> spectra;
        std::vector<Eigen::VectorXd> slow;  ///< the slow motion that balances it, where it was not measured
        Eigen::VectorXd calibration;
    };
    /// What does not depend on the force, for each run: W d (6 x bins) and its products with the calibration columns
    /// (columns x bins).
    struct Axis {
        std::vector<Eigen::MatrixXcf> white, calibration;
        std::vector<std::shared_ptr<const Change>> known;
        AxisLaw present;  ///< the law whose force is kept
        std::vector<Eigen::VectorXd> present_force;
    };
    std::shared_ptr<const Change> find(std::size_t axis, const AxisLaw& from, const AxisLaw& to) const;
    std::shared_ptr<const Change> make(std::size_t axis, const AxisLaw& from, const AxisLaw& to) const;

    const OpenLoopProblem* problem_;
    mutable std::vector<Axis> axes_;
    mutable std::mutex mutex_;
};

/// A candidate with the values that one step of linear least squares gives.
struct Screened {
    std::size_t candidate = 0;   ///< index in the list
    std::vector<double> values;  ///< of its knobs
    double gain = 0;             ///< decrease of the sum of squares that linearisation promises
};

/// The best start of each candidate, to first order in rotations, sorted by falling gain less `price` for each knob.
/// Uses two threads.
std::vector<Screened> screenCandidates(const OpenLoopProblem& problem, LawDifferences& laws, const MountModel& model,
                                       const WhiteVector& residual, const std::vector<Candidate>& candidates,
                                       double price);

}  // namespace wems::identify
