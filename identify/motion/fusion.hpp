/// @file
/// One coordinate measured twice, as a displacement and as an acceleration.
///
/// The estimate minimises
///
///     Σ_k (x_k − x̃_k)² / σ_x²  +  Σ_k ((x_{k+1} − 2 x_k + x_{k−1})/h² − b_k)² / σ_k²
///
/// with b the hat-weighted mean of the acceleration that the second difference of a smooth x equals exactly,
/// b = ã + δ²ã/12 − δ⁴ã/240 + 31 δ⁶ã/60480 (Numerov's relation and its next two terms). Displacement rules below
/// ω = √(σ_a/σ_x), acceleration above. Both measure the same motion, so the estimate has no bias in any band below a
/// quarter of the sampling rate (0.3 % there). Where ã has kinks (a stop is reached) sampled accelerations miss part of
/// the impulse; σ_k grows there by what the sixth difference of ã says of it, so that the displacement decides.
/// The velocity follows from x and ã by the compact difference (x_{k+1} − x_{k−1})/2h − h (μδ/6 − 7 μδ³/360 +
/// 37 μδ⁵/10080) ã: 1.7 % low at a quarter of the sampling rate, 0.1 % at an eighth.
///
/// Pentadiagonal Cholesky, O(N).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wems::identify {

/// How a recording shows that a stop is reached: abruptly, as samples of a motion with kinks, which miss part of the
/// impulse, or as an anti-alias filter has rounded it, of which samples miss nothing.
enum class ContactEdges { sampled, filtered };

struct FusedSignal {
    Eigen::VectorXd x, v;
    /// w_k = (σ_x / (σ_k h²))², of the accelerations' relation at each sample over the displacement there; zero at the
    /// ends.
    Eigen::VectorXd weights;
};

/// @param sigma_x, sigma_a noise (RMS) of the two measurements; > 0
/// @param edges σ_k grows at kinks of `sampled` edges alone
/// @param h sample interval, s; at least 8 samples
FusedSignal fuseDisplacementAndAcceleration(const Eigen::VectorXd& x_measured, double sigma_x,
                                            const Eigen::VectorXd& a_measured, double sigma_a, double h,
                                            ContactEdges edges = ContactEdges::sampled);

/// I + Dᵀ diag(w) D, D the rows (1, −2, 1) centred on samples 1 … n−2, as LDLᵀ with two subdiagonals.
class Pentadiagonal {
public:
    explicit Pentadiagonal(const Eigen::Ref<const Eigen::VectorXd>& weights);
    /// In place.
    void solve(Eigen::VectorXd& r) const;

private:
    std::vector<double> d_, l1_, l2_;
};

/// The fusion as the linear operator that its weights make of it, backwards: what a weighted sum of x takes of each
/// measured displacement and of each measured acceleration.
class FusionAdjoint {
public:
    FusionAdjoint(Eigen::VectorXd weights, double h);
    /// @param[in,out] influence of x; afterwards of the measured displacements
    /// @return of the measured accelerations
    Eigen::VectorXd apply(Eigen::VectorXd& influence) const;

private:
    Eigen::VectorXd weights_;
    double h_;
    Pentadiagonal equations_;
};

}  // namespace wems::identify
