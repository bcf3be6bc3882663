#include "identify/motion/real_transform.hpp"

#include <fftw3.h>

#include <complex>

namespace wems::identify {

namespace {

/// The layouts are the same (FFTW manual, section 4.1.1).
fftw_complex* asFftw(std::complex<double>* data) {
    return reinterpret_cast<fftw_complex*>(data);
}

}  // namespace

struct RealTransform::Plans {
    fftw_plan forward, inverse;

    explicit Plans(Eigen::Index length) {
        fftw_make_planner_thread_safe();
        Eigen::VectorXd samples(length);
        Eigen::VectorXcd bins(length / 2 + 1);
        const auto size = static_cast<int>(length);
        // Without trying. For what Eigen allocates alone: it aligns as FFTW's SIMD asks for (FFTW manual, section 4.6).
        constexpr unsigned flags = FFTW_ESTIMATE;
        forward = fftw_plan_dft_r2c_1d(size, samples.data(), asFftw(bins.data()), flags);
        inverse = fftw_plan_dft_c2r_1d(size, asFftw(bins.data()), samples.data(), flags);
    }
    ~Plans() {
        fftw_destroy_plan(forward);
        fftw_destroy_plan(inverse);
    }
    Plans(const Plans&) = delete;
    Plans& operator=(const Plans&) = delete;
};

RealTransform::RealTransform(Eigen::Index length) : length_(length), plans_(std::make_unique<Plans>(length)) {}
RealTransform::~RealTransform() = default;
RealTransform::RealTransform(RealTransform&&) noexcept = default;
RealTransform& RealTransform::operator=(RealTransform&&) noexcept = default;

Eigen::VectorXcd RealTransform::forward(const Eigen::Ref<const Eigen::VectorXd>& samples) const {
    Eigen::VectorXd padded = Eigen::VectorXd::Zero(length_);
    padded.head(samples.size()) = samples;
    Eigen::VectorXcd bins(binCount());
    fftw_execute_dft_r2c(plans_->forward, padded.data(), asFftw(bins.data()));
    return bins;
}

Eigen::VectorXd RealTransform::inverse(const Eigen::Ref<const Eigen::VectorXcd>& bins) const {
    Eigen::VectorXcd overwritten = bins;  // by FFTW
    Eigen::VectorXd samples(length_);
    fftw_execute_dft_c2r(plans_->inverse, asFftw(overwritten.data()), samples.data());
    return samples / static_cast<double>(length_);
}

}  // namespace wems::identify
