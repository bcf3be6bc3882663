/// @file
/// Discrete Fourier transform of real samples (FFTW): the one place where plans are made.
#pragma once

#include <Eigen/Core>
#include <memory>

namespace wems::identify {

/// Both directions for one number of samples. Transforming is const and may be done by several threads at once.
class RealTransform {
public:
    /// @param length number of samples, at least 1
    explicit RealTransform(Eigen::Index length);
    ~RealTransform();
    RealTransform(RealTransform&&) noexcept;
    RealTransform& operator=(RealTransform&&) noexcept;
    RealTransform(const RealTransform&) = delete;
    RealTransform& operator=(const RealTransform&) = delete;

    Eigen::Index length() const { return length_; }
    Eigen::Index binCount() const { return length_ / 2 + 1; }

    /// X_k = Σ_n x_n exp(−2πi k n / length), k = 0 … length / 2. Fewer samples than length() are continued by zeros.
    Eigen::VectorXcd forward(const Eigen::Ref<const Eigen::VectorXd>& samples) const;
    /// The samples of which forward() makes these bins.
    Eigen::VectorXd inverse(const Eigen::Ref<const Eigen::VectorXcd>& bins) const;

private:
    struct Plans;
    Eigen::Index length_;
    std::unique_ptr<Plans> plans_;
};

}  // namespace wems::identify
