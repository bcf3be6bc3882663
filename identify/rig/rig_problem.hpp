/// @file
/// A rig that moves along one axis: every number of its model against the free response that was measured.
///
/// The residual is the simulated minus the measured relative displacement along the free axis, less its mean in each
/// run (the zero of the sensor), from free simulations that the recorded load or the recorded motion of the fixed part
/// drives: m q'' + f(q, q') = u(t). No derivative of a recording is taken, so that a few samples in a period suffice
/// where the equations of motion along the measured motion would need twenty.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "identify/diagnose/free_error.hpp"
#include "identify/residual/residual_problem.hpp"
#include "identify/rig/rig_response.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// The axis along which alone the mobile part moves; nothing if it moves in another way, or the fixed part has a
/// bracket.
std::optional<int> findRigAxis(const MountModel& model);

class RigProblem : public ResidualProblem {
public:
    /// @param validation may be empty: the identification runs judge
    /// @throws InputError if the motion of a run cannot be recovered, or nothing moves
    RigProblem(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
               const MountModel& model);

    const std::vector<RunMotion>& motions() const { return motions_; }
    std::size_t identificationCount() const { return identification_count_; }
    int axis() const { return axis_; }

    /// The model that values of the rows make, without what has no force.
    MountModel modelAt(const Eigen::VectorXd& values) const;

    GroupError calcErrors(const Eigen::VectorXd& values) const override;
    GroupError calcNoiseFloor() const override;
    double calcJudgedDifference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const override;

protected:
    Eigen::VectorXd calcResidual(const Eigen::VectorXd& values) const override;
    double calcSignalSquare() const override;

private:
    /// The simulated response of a run along the axis, as the error compares it.
    Eigen::VectorXd respond(std::size_t run, const MountModel& model) const;
    /// Simulated minus measured without their means, as a sensor with the gain and delay of the rows has it.
    Eigen::VectorXd calcRunResidual(std::size_t run, const MountModel& model, double gain, double delay) const;
    std::size_t firstJudge() const;
    void addSensorRows(const MountModel& model);
    void addHypotheses(const MountModel& model, bool loaded);

    int axis_ = 0;
    std::size_t identification_count_ = 0;
    MountModel believed_;
    std::vector<RunMotion> motions_;
    std::vector<FreeRun> runs_;
    std::vector<RigRun> drives_;
    std::vector<Eigen::VectorXd> measured_;  ///< m, along the axis, as the error compares it
    TestScales scales_;
    double positive_reach_ = 0, negative_reach_ = 0;
    std::string sensor_;  ///< `mobile.1.z`, or `mobile` where there are several
};

}  // namespace wems::identify
