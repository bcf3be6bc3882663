#include "identify/motion/fourier.hpp"

#include <algorithm>

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

Fourier::Fourier(int samples) : transform_(fastSize(samples)) {}

Eigen::MatrixXcd Fourier::forward(const Eigen::Ref<const Eigen::MatrixXd>& rows) const {
    Eigen::MatrixXcd result(rows.rows(), binCount());
    for (Eigen::Index r = 0; r < rows.rows(); ++r) result.row(r) = transform_.forward(rows.row(r).transpose());
    return result;
}

Eigen::MatrixXcd Fourier::forward(const Eigen::Ref<const Eigen::MatrixXd>& rows,
                                  const Eigen::Ref<const Eigen::VectorXd>& window, Eigen::Index first,
                                  Eigen::Index count) const {
    return forwardSamples(rows.transpose(), window, first, count);
}

Eigen::MatrixXcd Fourier::forwardSamples(const Eigen::Ref<const Eigen::MatrixXd>& samples,
                                         const Eigen::Ref<const Eigen::VectorXd>& window, Eigen::Index first,
                                         Eigen::Index count) const {
    Eigen::MatrixXcd result(samples.cols(), count);
    Eigen::VectorXd windowed(samples.rows());
    for (Eigen::Index r = 0; r < samples.cols(); ++r) {
        windowed = samples.col(r).cwiseProduct(window);
        result.row(r) = transform_.forward(windowed).segment(first, count).transpose();
    }
    return result;
}

Eigen::MatrixXd Fourier::inverse(const Eigen::Ref<const Eigen::MatrixXcd>& spectra, int samples) const {
    Eigen::MatrixXd result(spectra.rows(), samples);
    for (Eigen::Index r = 0; r < spectra.rows(); ++r)
        result.row(r) = transform_.inverse(spectra.row(r).transpose()).head(samples);
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
