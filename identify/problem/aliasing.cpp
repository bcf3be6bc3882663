#include "identify/problem/aliasing.hpp"

#include "identify/problem/fourier.hpp"

namespace wems::identify {
namespace {

constexpr double kFrom = 0.4, kTo = 0.49;  // of the sampling rate: where folding is seen
constexpr double kFolded = 0.06;           // of the power there: near zero frequency

}  // namespace

Eigen::Matrix<double, 12, 12> calcAliasing(const RunMotion& run) {
    Eigen::MatrixXd acceleration = Eigen::MatrixXd::Zero(12, run.mobile.a.cols());
    bool integrated = false;
    const auto fill = [&](const PartMotion& part, Eigen::Index row) {
        if (part.displacement_measured || !part.acceleration_measured) return;
        acceleration.middleRows(row, 3) = part.a;
        acceleration.middleRows(row + 3, 3) = part.alpha;
        integrated = true;
    };
    fill(run.mobile, 0);
    fill(run.fixed, 6);
    if (!integrated) return Eigen::Matrix<double, 12, 12>::Zero();
    const Fourier fourier(static_cast<int>(acceleration.cols()));
    const auto first = static_cast<Eigen::Index>(kFrom * fourier.size()),
               last = static_cast<Eigen::Index>(kTo * fourier.size());
    const Eigen::MatrixXcd seen = fourier.forward(acceleration).middleCols(first, last - first);
    const double count = static_cast<double>(seen.cols()) * static_cast<double>(acceleration.cols());
    return kFolded / count * (seen * seen.adjoint()).real();
}

}  // namespace wems::identify
