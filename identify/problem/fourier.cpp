#include "identify/problem/fourier.hpp"

#include <complex>
#include <vector>

#include "identify/motion/fftw_plan.hpp"

namespace wems::identify {
namespace {

int fastSize(int least) {
    for (int size = least + least % 2;; size += 2) {
        int rest = size;
        for (const int prime : {2, 3, 5, 7})
            while (rest % prime == 0) rest /= prime;
        if (rest == 1) return size;
    }
}

}  // namespace

struct Fourier::Plans {
    int size;
    fftw_plan forward, inverse;

    explicit Plans(int samples) : size(fastSize(samples)) {
        std::vector<double> real(size);
        std::vector<std::complex<double>> complex(size / 2 + 1);
        const unsigned flags = FFTW_ESTIMATE | FFTW_UNALIGNED;
        forward = fftw_plan_dft_r2c_1d(size, real.data(), asFftw(complex.data()), flags);
        inverse = fftw_plan_dft_c2r_1d(size, asFftw(complex.data()), real.data(), flags);
    }
    ~Plans() {
        fftw_destroy_plan(forward);
        fftw_destroy_plan(inverse);
    }
    Plans(const Plans&) = delete;
    Plans& operator=(const Plans&) = delete;
};

Fourier::Fourier(int samples) : plans_(std::make_unique<Plans>(samples)) {}
Fourier::~Fourier() = default;
Fourier::Fourier(Fourier&&) noexcept = default;
Fourier& Fourier::operator=(Fourier&&) noexcept = default;

int Fourier::size() const {
    return plans_->size;
}

Eigen::MatrixXcd Fourier::forward(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
    Eigen::MatrixXcd result(rows.rows(), binCount());
    Eigen::VectorXd real = Eigen::VectorXd::Zero(size());
    Eigen::VectorXcd complex(binCount());
    for (Eigen::Index r = 0; r < rows.rows(); ++r) {
        real.head(rows.cols()) = rows.row(r);
        real.tail(size() - rows.cols()).setZero();
        fftw_execute_dft_r2c(plans_->forward, real.data(), asFftw(complex.data()));
        result.row(r) = complex;
    }
    return result;
}

Eigen::MatrixXd Fourier::inverse(const Eigen::Ref<const Eigen::MatrixXcd>& spectra, int samples) const {
    Eigen::MatrixXd result(spectra.rows(), samples);
    Eigen::VectorXd real(size());
    Eigen::VectorXcd complex(binCount());
    for (Eigen::Index r = 0; r < spectra.rows(); ++r) {
        complex = spectra.row(r);
        fftw_execute_dft_c2r(plans_->inverse, asFftw(complex.data()), real.data());
        result.row(r) = real.head(samples) / size();
    }
    return result;
}

Eigen::MatrixXd smoothPower(const Eigen::MatrixXcd& spectra, Eigen::Index half) {
    const Eigen::MatrixXd power = spectra.cwiseAbs2();
    Eigen::MatrixXd result(power.rows(), power.cols());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(power.rows());
    Eigen::Index first = 0, last = -1;
    for (Eigen::Index k = 0; k < power.cols(); ++k) {
        while (last < std::min(power.cols() - 1, k + half)) sum += power.col(++last);
        while (first < k - half) sum -= power.col(first++);
        result.col(k) = (sum / static_cast<double>(last - first + 1)).cwiseMax(0.0);
    }
    return result;
}

}  // namespace wems::identify
