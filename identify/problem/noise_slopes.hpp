/// @file
/// What the noise of the regressors adds to the slope of the misfit in each number, in the mean.
///
/// The equations are homogeneous in the motion, whose noise stands on both sides (errors in variables): the diagonal of
/// 2 Re L⁻¹ ∂A P Aᴴ L⁻ᴴ, summed over the bins, with A, P and L of run_noise.hpp.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/problem/run_noise.hpp"
#include "identify/problem/sensor_columns.hpp"
#include "identify/problem/unknown.hpp"

namespace wems::identify {

inline constexpr int kLevelBands = 4;  ///< of each run, in which the noise's level is known apart

class NoiseSlopes {
public:
    /// Of each of the whitened rows and bands.
    using Slope = Eigen::Matrix<double, 12, kLevelBands>;

    NoiseSlopes(const OpenLoopRun& run, const MountModel& model, const EquationSpectra& spectra, const RunNoise& noise);

    /// Of a change of an axis' law: by its equivalent dynamic stiffness.
    Slope calcLawSlope(const TestState& from, const TestState& to, int connection, int axis, double step) const;
    Slope calcPositionSlope(int connection, int moved) const;
    /// Of a change of the mass matrix, or of what multiplies the angular velocity in the moments.
    Slope calcInertiaSlope(const Matrix6& dM, const Eigen::Matrix3d& gyroscopic) const;
    /// Of a mode: at each bin its change is Σ a cᵀ of the interface's receptance and Σ a c_Lᵀ of the load's.
    /// @param which 0 frequency, 1 damping ratio, 2 + entry of the shape
    Slope calcModeSlope(int mode, int which) const;
    Slope calcLoadSlope() const;
    /// Of a sensor's error: each channel's change follows from the motion and moves it.
    Slope calcSensorSlope(const SensorEffect& effect) const;

private:
    /// (L⁻¹ left) ⊙ (right · U): of a term left rightᵀ of the dynamic stiffness between the parts.
    Eigen::Matrix<std::complex<double>, 12, 1> calcProduct(Eigen::Index b, const Vector6& left,
                                                           const Vector6& right) const;
    /// What small motion about the measured one meets in the mean, at each bin. Dry friction is left out: it takes a
    /// velocity without noise.
    Eigen::VectorXcd calcDynamicStiffness(AxisLaw law, Eigen::Index row) const;
    Eigen::Index bandOf(Eigen::Index b) const { return b * kLevelBands / spectra_.binCount(); }

    const OpenLoopRun& open_;
    const MountModel& model_;
    const EquationSpectra& spectra_;
    const RunNoise* noise_;
    Matrix6 M_;
    std::vector<Eigen::MatrixXcd> axis_products_;  // of each axis' direction with itself, 12 x bins
};

}  // namespace wems::identify
