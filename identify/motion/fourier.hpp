/// @file
/// Discrete Fourier transforms of the rows of a matrix.
#pragma once

#include <Eigen/Core>

#include "identify/motion/real_transform.hpp"

namespace wems::identify {

/// Real rows ↔ complex spectra, zero-padded to a size with small prime factors. Transforming is const and may be done
/// by several threads at once.
class Fourier {
public:
    /// @param samples least number of samples; size() ≥ samples
    explicit Fourier(int samples);

    int size() const { return static_cast<int>(transform_.length()); }
    int binCount() const { return size() / 2 + 1; }

    /// X_k = Σ_n x_n exp(−2πi k n / size): rows x binCount().
    Eigen::MatrixXcd forward(const Eigen::Ref<const Eigen::MatrixXd>& rows) const;
    /// The same of rows that are multiplied by a window, from a bin on.
    /// @param window as long as the rows
    Eigen::MatrixXcd forward(const Eigen::Ref<const Eigen::MatrixXd>& rows,
                             const Eigen::Ref<const Eigen::VectorXd>& window, Eigen::Index first,
                             Eigen::Index count) const;
    /// The same of samples x rows.
    Eigen::MatrixXcd forwardSamples(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                    const Eigen::Ref<const Eigen::VectorXd>& window, Eigen::Index first,
                                    Eigen::Index count) const;
    /// The inverse, its first `samples` columns.
    Eigen::MatrixXd inverse(const Eigen::Ref<const Eigen::MatrixXcd>& spectra, int samples) const;

private:
    RealTransform transform_;
};

/// Power of each row at each bin, smoothed by a moving average of 2 half + 1 bins.
Eigen::MatrixXd smoothPower(const Eigen::MatrixXcd& spectra, Eigen::Index half);

}  // namespace wems::identify
