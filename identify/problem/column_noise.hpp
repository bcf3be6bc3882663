/// @file
/// What the noise of the motion and of the load makes of the columns (errors in variables).
///
/// The equations are homogeneous in the motion: a column is linear in what was measured, J_i = Σ L⁻¹ u (vᵀ x), x the
/// two motions and the load, whose noise has the covariance P and makes the residual's. It adds
///
///     s_i  = ½ rᵀ R⁻¹ ∂_i R R⁻¹ r             to J_iᵀ R⁻¹ r,
///     N_ij = Σ 2 Re (L⁻¹ u_i)ᴴ (L⁻¹ u_j) (v_iᵀ P v_j*)*   to J_iᵀ R⁻¹ J_j
///
/// (Fuller, Measurement Error Models, 1987, section 2.2): along a direction in which the columns' signals cancel, the
/// noise alone stands in JᵀR⁻¹J and would pass for knowledge. The mean of s_i over draws is ½ tr(R⁻¹ ∂_i R); with the
/// residual that there is, J_iᵀR⁻¹r − s_i is the slope of ½ rᵀR⁻¹r with R following the state, so that steps lead to
/// its minimum, and a noise that is not quite what R says of it, at some frequencies, biases nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "identify/problem/linearised_run.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/run_noise.hpp"
#include "identify/problem/sensor_columns.hpp"

namespace wems::identify {

inline constexpr int kLevelBands = 4;  ///< of each run, in which the noise's level is known apart

class ColumnNoise {
public:
    /// A column's change at a bin: left (rightᵀ x), left whitened, x the mobile part's and the fixed part's motion (6
    /// each) and the load (3).
    struct Term {
        Eigen::Matrix<std::complex<double>, 12, 1> left;
        Eigen::Matrix<double, 15, 1> right;
    };
    using Terms = std::vector<Term>;
    /// Terms of a column at a bin.
    using Column = std::function<Terms(Eigen::Index bin)>;
    /// Of the mount's rows, of the bracket's, in each band.
    using Slope = Eigen::Matrix<double, 2, kLevelBands>;

    /// @param residual whitened, 12 x bins
    ColumnNoise(const OpenLoopRun& run, const MountModel& model, const EquationSpectra& spectra, const RunNoise& noise,
                const Eigen::MatrixXcd& residual);

    /// A change of an axis' law: by its equivalent dynamic stiffness.
    struct LawChange {
        int connection, axis;
        std::shared_ptr<const Eigen::VectorXcd> stiffness;  ///< at each bin; null: none
    };
    LawChange calcLawChange(const TestState& from, const TestState& to, int connection, int axis, double step) const;
    Column makeLaw(const LawChange& change) const;
    Column makePosition(int connection, int moved) const;
    /// A change of the mass matrix, or of what multiplies the angular velocity in the moments.
    Column makeInertia(const Matrix6& dM, const Eigen::Matrix3d& gyroscopic) const;
    /// A mode: at each bin its change is Σ a cᵀ of the interface's receptance and Σ a c_Lᵀ of the load's.
    struct ModeChange {
        int mode, which;  ///< which: 0 frequency, 1 damping ratio, 2 + entry of the shape
    };
    Column makeMode(const ModeChange& change) const;
    /// @param axis of the load whose gain it is; 3: of all
    Column makeLoad(double factor, int axis) const;
    /// A sensor's error: each channel's change follows from the motion and moves it.
    Column makeSensor(const SensorEffect& effect) const;

    Slope calcSlope(const Column& column) const;
    /// Of makeLaw(change).
    Slope calcSlope(const LawChange& change) const;
    /// Of makeMode(change).
    Slope calcSlope(const ModeChange& change) const;
    /// Of makeSensor(effect).
    Slope calcSlope(const SensorEffect& effect);
    /// By the noise that an axis' stiffness beyond its mean spreads over all frequencies: R holds its power times d dᵀ,
    /// which a change of the law moves as the square of that stiffness.
    Slope calcContactSlope(const TestState& from, const TestState& to, int connection, int axis, double step) const;
    /// Of each band, what the residual leaves over its noise.
    Slope calcLevels() const;
    /// N of the whitened rows from `first` (6 of them).
    /// @param columns null: without noise
    Eigen::MatrixXd calcProducts(const std::vector<Column>& columns, Eigen::Index first) const;

private:
    Eigen::Index bandOf(Eigen::Index b) const { return b * kLevelBands / spectra_.binCount(); }
    /// factor (a cᵀ of the interface, a c_Lᵀ of the load): c above c_L.
    struct Outer {
        std::complex<double> factor;
        Vector6 a;
        Eigen::Matrix<double, 9, 1> c;
    };
    std::vector<Outer> calcOuters(const ModeChange& change, Eigen::Index bin) const;
    /// What c above c_L meets of motion and load: 9 x 15.
    Eigen::Matrix<double, 9, 15> calcModeInputs(Eigen::Index bin) const;
    /// Of a term at the i-th product: of the mount's rows, of the bracket's, complex.
    Eigen::Vector2cd calcProduct(std::size_t i, const Term& term) const;

    const OpenLoopRun& open_;
    const MountModel& model_;
    const EquationSpectra& spectra_;
    const RunNoise* noise_;
    const Eigen::MatrixXcd& residual_;
    Matrix6 M_;
    Eigen::Index slope_step_ = 1;  ///< bins
    /// rightᵀ (product) left is what a term adds to s: of all rows, and beside them of the mount's alone. From each bin
    /// that slopes are taken at, summed to the next.
    using Product = Eigen::Matrix<std::complex<double>, 15, 18, Eigen::RowMajor>;
    std::vector<Product, Eigen::aligned_allocator<Product>> products_;
    /// signalᵀ (product) direction is what a change of a channel that moves its part's motion adds to s, of all rows
    /// beside those of the mount: of the mobile part, of the fixed part.
    using MotionProduct = Eigen::Matrix<std::complex<double>, 6, 12>;
    std::vector<MotionProduct, Eigen::aligned_allocator<MotionProduct>> motion_products_[2];
    /// Sums of those, in each band, with a weight that many changes of channels share.
    struct WeightedProducts {
        std::shared_ptr<const Eigen::VectorXcd> weight;  // kept, so that its address stays its own
        std::array<MotionProduct, kLevelBands> bands;
    };
    const WeightedProducts& calcWeighted(const std::shared_ptr<const Eigen::VectorXcd>& weight, Part part);
    std::map<std::pair<const Eigen::VectorXcd*, Part>, WeightedProducts> weighted_;
    /// cᵀ (product) a is what an outer product adds to s, of the bracket's rows.
    using ModeProduct = Eigen::Matrix<std::complex<double>, 9, 6>;
    std::vector<ModeProduct, Eigen::aligned_allocator<ModeProduct>> mode_products_;
    /// calcProduct of a unit stiffness along each axis: bins of the slopes x axes.
    std::vector<std::vector<Eigen::Vector2cd>> axis_products_;
};

}  // namespace wems::identify
