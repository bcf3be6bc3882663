/// @file
/// The law of one element against the force that its tests measured: every number of the law with its tolerance, every
/// mechanism that it may lack (below).
///
/// The residual is the measured force minus that of the law along the measured motion, less its mean in each test (the
/// zero of the load cell, a weight); identify/residual/residual_problem.hpp says what is made of it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/problem/unknown.hpp"
#include "identify/residual/residual_problem.hpp"
#include "identify/solve/evidence.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

// What the law of an element on a test machine may have wrong or lack, as hypotheses (contract, section 5).

/// What the tests did.
struct ElementReach {
    std::string place;                  ///< `1.z`
    double lowest = 0, highest = 0;     ///< Hz, of the strokes
    double positive = 0, negative = 0;  ///< m, largest displacement towards either side
    double displacement = 0;            ///< m, the larger of both
};

/// @param table rows of the law, and the delay of the force's channel
/// @param believed with a stop on either side, of no stiffness where the model has none
std::vector<Hypothesis> listElementHypotheses(const UnknownTable& table, const AxisLaw& believed,
                                              const ElementReach& reach);

class ElementProblem : public ResidualProblem {
public:
    /// @param judges may be the tests themselves
    /// @param model whose law of that connection and axis is believed
    /// @throws InputError if nothing moves
    ElementProblem(std::vector<ComponentData> tests, std::vector<ComponentData> judges, const MountModel& model,
                   std::size_t connection, int axis);

    const std::vector<ComponentData>& tests() const { return tests_; }
    const std::vector<ComponentData>& judges() const { return judges_; }
    /// `1.z`
    const std::string& place() const { return place_; }

    /// The law that values of the rows make, without what has no force.
    AxisLaw lawAt(const Eigen::VectorXd& values) const;
    /// How late the force's channel is, s.
    double delayAt(const Eigen::VectorXd& values) const;

    GroupError calcErrors(const Eigen::VectorXd& values) const override;
    GroupError calcNoiseFloor() const override;
    double calcJudgedDifference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const override;

protected:
    Eigen::VectorXd calcResidual(const Eigen::VectorXd& values) const override;
    double calcSignalSquare() const override;

private:
    void addDelayRow(const MountModel& model);

    std::vector<ComponentData> tests_, judges_;
    std::vector<Eigen::Index> starts_;
    TestState believed_;
    std::size_t axis_;
    std::string place_;
    TestScales scales_;
    double positive_reach_ = 0, negative_reach_ = 0;  // m
};

/// Root relative squared error of a law along tests: RMS of measured minus calculated force, less its mean in each
/// test, over that of the measured force about its mean.
/// @param delay of the force's channel, s
double calcElementError(const AxisLaw& law, double delay, const std::vector<ComponentData>& tests);

/// What white noise of the force alone would leave, as a root relative squared error: third differences of a force that
/// is sampled finely hold little else, with a variance of 20 σ².
double calcForceNoise(const std::vector<ComponentData>& tests);

/// Measured minus calculated force along one test, less its mean, N.
Eigen::VectorXd calcForceError(const AxisLaw& law, double delay, const ComponentData& test);

}  // namespace wems::identify
