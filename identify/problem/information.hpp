/// @file
/// What recordings say of the unknowns, to second order about a state: runs add.
///
///     −2 log p(data | θ + δ) ≈ Σ_blocks (χ² + 2 bᵀδ + δᵀA δ) / scale
///
/// with A = JᵀR⁻¹J, χ² = rᵀR⁻¹r of each block's residual r and its covariance R by noise, and b = JᵀR⁻¹r − s. The
/// second term, s = ½ rᵀR⁻¹ ∂R R⁻¹r, is what the noise of the regressors adds to JᵀR⁻¹r (errors in variables): without
/// it the equations, which are homogeneous, would prefer small masses and stiffnesses. The same noise stands in A, as N
/// (column_noise.hpp): along a direction in which the columns' signals cancel it would pass for knowledge.
#pragma once

#include <Eigen/Core>
#include <array>

namespace wems::identify {

/// Equations of different origin, whose misfit is told apart.
enum class Block { mount, bracket, mobile_sensors, fixed_sensors };
inline constexpr std::size_t kBlocks = 4;
constexpr std::size_t indexOf(Block block) {
    return static_cast<std::size_t>(block);
}

/// Standard deviation of the noise's level in a band: what its estimate by quartiles, the smoothing of its spectrum and
/// the anti-alias filter leave open. The misfits of exact models (0.8 to 1.1) lie within one and a half of it.
inline constexpr double kLevelDeviation = 0.3;

struct BlockInformation {
    Eigen::MatrixXd A;
    Eigen::VectorXd b;             ///< JᵀR⁻¹r
    Eigen::MatrixXd noise_slopes;  ///< s of each band of frequency of each run, whose noise is known apart
    Eigen::VectorXd noise_levels;  ///< of each of those bands: what is left there where s was formed, over the noise
    Eigen::MatrixXd noise;         ///< N: what of A the noise of the regressors makes; empty: nothing
    Eigen::VectorXd noise_right;  ///< by which N moves b: −N δ, δ from where the columns were formed; empty: nothing
    Eigen::MatrixXd growth;       ///< K: what of A the growth of R with a wrong model's residual takes; empty: nothing
    Eigen::VectorXd growth_right;  ///< −K δ, as that of N; empty: nothing
    Eigen::MatrixXd scatter;       ///< by which JᵀR⁻¹r varies beyond A, where noise comes in bursts; empty: none
    double chi_squared = 0;
    double count = 0;  ///< real values

    bool empty() const { return count == 0; }
    void add(const BlockInformation& other);
};

using Information = std::array<BlockInformation, kBlocks>;

void add(Information& sum, const Information& other);

/// K of a block about the point where it was formed. The least of rᵀR⁻¹r, R that of each point, is where R^{-½} r is
/// least. If R grows alike at all frequencies, its columns are those of r less r sᵀ / χ² (Gauss–Newton): of what a
/// wrong model leaves, d with J_dᵀd = b − s/m and d² = χ² (1 − 1/m), m the misfit, the product is A − K with K = ((b −
/// s/m) sᵀ + s (b − s/m)ᵀ − (1 − 1/m) s sᵀ) / χ². What noise leaves is N's. With A alone steps would go where R is
/// large, however badly the equations are satisfied there.
Eigen::MatrixXd calcGrowth(const BlockInformation& block);

/// How a block's values scatter beside what the noise's estimate says.
struct BlockScale {
    double scale = 1;  ///< by which its squares weigh less; 1 for a perfect model
    double level = 1;  ///< of what is left, over the noise
};
using BlockScales = std::array<BlockScale, kBlocks>;

/// What of a wrong model the growth of its covariance R explains.
enum class Growth {
    doubted,  ///< little: that a number grows R is no evidence for it
    followed  ///< all: a step of numbers that are sought is tried under the R of where it leads
};

/// All blocks together, each over its scale, b with its noise slopes taken off, A with the regressors' noise: A' = A −
/// N. The level of the noise in each band is known to a part τ only, so that b scatters by τ s more than by A, and
/// bursts of noise add theirs (V): A and b become A' C⁻¹ A' and A' C⁻¹ b with C = A + V + τ² Σ s sᵀ. What is a factor
/// on all forces, in which nothing but that level speaks, is then left to its prior. Where growth is followed, A is A −
/// K, and s in C is without what a wrong model adds to it. V, a variance of b, is over the square of the scale there:
/// over the scale it would outweigh A far from the truth, and steps would seek a small gradient, not a small χ². Where
/// growth is doubted, b scatters by what a wrong model leaves as by noise of that size, in bursts: (A + V) / scale.
/// @param reach standard deviation of each column where it is free
BlockInformation combine(const Information& information, const BlockScales& scales, const Eigen::VectorXd& reach,
                         Growth growth = Growth::doubted);

}  // namespace wems::identify
