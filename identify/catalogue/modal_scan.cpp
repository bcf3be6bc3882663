#include "identify/catalogue/modal_scan.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/problem/bracket_equation.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

constexpr double kBandRatio = 0.004;       // width of a band over its frequency: well below that of a resonance
constexpr double kGridRatio = 0.03;        // spacing of the scan …
constexpr double kGridDamping = 0.02;      // … which a resonance of this damping ratio does not slip through
constexpr double kFarthestMode = 1.5;      // a mode above the band still shows by its flexibility
constexpr double kLargestDamping = 0.2;    // of a structure
constexpr double kSmallestDamping = 1e-3;  // likewise
constexpr double kRidge = 1e-6;            // of the diagonal: what no input excited stays at zero
constexpr int kShapeSteps = 20;            // most, each damped until it gains
constexpr int kRefinements = 12;           // the step halves each time nothing is gained: 4e-6 of the frequency

/// d vec(φ pᵀ) / dp.
Eigen::MatrixXd calcShapeJacobian(const Eigen::VectorXd& p) {
    const Eigen::Index n = p.size();
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6 * n, n);
    for (Eigen::Index j = 0; j < n; ++j) {
        jacobian.block<6, 6>(6 * j, 0).diagonal().array() += p[j];
        jacobian.block<6, 1>(6 * j, j) += p.head<6>();
    }
    return jacobian;
}

Eigen::VectorXd flatten(const Eigen::VectorXd& p) {
    const Eigen::MatrixXd A = p.head<6>() * p.transpose();
    return Eigen::Map<const Eigen::VectorXd>(A.data(), A.size());
}

}  // namespace

ModalScan::ModalScan(double lowest, double highest, Eigen::Index inputs, double lever)
    : lowest_(lowest), highest_(highest), inputs_(inputs), lever_(lever) {
    bands_.resize(static_cast<std::size_t>(std::log(highest / lowest) / kBandRatio) + 1);
    for (auto& band : bands_) {
        band.normal = Eigen::MatrixXd::Zero(6 * inputs, 6 * inputs);
        band.right = Eigen::MatrixXcd::Zero(6, inputs);
    }
}

void ModalScan::add(double frequency, const Eigen::Ref<const Eigen::VectorXcd>& input, const Matrix6c& factor,
                    const Vector6c& white_residual) {
    if (frequency < lowest_ || frequency > highest_) return;
    auto& band =
        bands_[std::min(bands_.size() - 1, static_cast<std::size_t>(std::log(frequency / lowest_) / kBandRatio))];
    band.frequency += frequency;
    ++band.count;
    const Matrix6c weight = factor.adjoint() * factor;
    band.right -= factor.adjoint() * white_residual * input.adjoint();
    for (Eigen::Index j = 0; j < inputs_; ++j)
        for (Eigen::Index l = 0; l <= j; ++l)
            band.normal.block<6, 6>(6 * j, 6 * l) += (std::conj(input[j]) * input[l] * weight).real();
}

ModalGuess ModalScan::fit(double frequency, double damping_ratio) const {
    BracketMode mode;
    mode.frequency = frequency;
    mode.damping_ratio = damping_ratio;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(6 * inputs_, 6 * inputs_);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(6, inputs_);
    for (const auto& band : bands_) {
        if (band.count == 0) continue;
        const auto response = calcModalResponse(mode, kTwoPi * band.frequency / band.count);
        normal += std::norm(response) * band.normal;
        sum += (std::conj(response) * band.right).real();
    }
    normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
    const Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(sum.data(), sum.size());
    ModalGuess guess{frequency, damping_ratio, {}, 0};

    Eigen::MatrixXd regular = normal;
    regular.diagonal() *= 1 + kRidge;
    regular.diagonal().array() += 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
    const Eigen::VectorXd flat = regular.ldlt().solve(right);
    Eigen::MatrixXd A = Eigen::Map<const Eigen::MatrixXd>(flat.data(), 6, inputs_);
    Eigen::VectorXd scale = Eigen::VectorXd::Ones(inputs_);
    scale.segment<3>(3).setConstant(lever_);
    A = scale.head<6>().asDiagonal() * A * scale.asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd u = svd.matrixU().col(0), v = svd.singularValues()[0] * svd.matrixV().col(0);
    const double square = v.head<6>().dot(u);
    if (!(square > 0)) return guess;
    Eigen::VectorXd p = v / std::sqrt(square);
    p.head<6>() = u * std::sqrt(square);
    p = p.cwiseQuotient(scale).eval();

    const auto calcGain = [&](const Eigen::VectorXd& at) {
        const Eigen::VectorXd vec = flatten(at);
        return 2 * right.dot(vec) - vec.dot(normal * vec);
    };
    double gain = calcGain(p), damping = 1e-3;
    for (int i = 0; i < kShapeSteps && damping < 1e6; ++i) {
        const Eigen::MatrixXd jacobian = calcShapeJacobian(p);
        Eigen::MatrixXd hessian = jacobian.transpose() * normal * jacobian;
        hessian.diagonal() *= 1 + damping;
        hessian.diagonal().array() += 1e-12 * hessian.diagonal().maxCoeff() + 1e-300;
        const Eigen::VectorXd next = p + hessian.ldlt().solve(jacobian.transpose() * (right - normal * flatten(p)));
        const double better = calcGain(next);
        if (!(better > gain)) {
            damping *= 10;
            continue;
        }
        const bool done = better - gain < 1e-4 * better;
        p = next;
        gain = better;
        damping *= 0.2;
        if (done) break;
    }
    guess.participation = p;
    guess.gain = std::max(0.0, gain);
    return guess;
}

ModalGuess ModalScan::refine(ModalGuess guess) const {
    double step = 0.5 * kGridRatio, factor = 2;
    for (int i = 0; i < kRefinements; ++i) {
        bool moved = false;
        for (const auto& [f, z] :
             {std::pair{1 + step, 1.0}, std::pair{1 - step, 1.0}, std::pair{1.0, factor}, std::pair{1.0, 1 / factor}}) {
            const double damping = std::clamp(guess.damping_ratio * z, kSmallestDamping, kLargestDamping);
            const auto next = fit(guess.frequency * f, damping);
            if (next.gain <= guess.gain) continue;
            guess = next;
            moved = true;
        }
        if (moved) continue;
        step *= 0.5;
        factor = std::sqrt(factor);
    }
    return guess;
}

std::vector<ModalGuess> ModalScan::findBest(std::size_t count) const {
    std::vector<ModalGuess> grid, best;
    for (double f = lowest_; f < kFarthestMode * highest_; f *= 1 + kGridRatio) grid.push_back(fit(f, kGridDamping));
    for (std::size_t i = 0; i < grid.size(); ++i) {
        const bool above_left = i == 0 || grid[i].gain > grid[i - 1].gain;
        const bool above_right = i + 1 == grid.size() || grid[i].gain >= grid[i + 1].gain;
        if (grid[i].gain > 0 && above_left && above_right) best.push_back(grid[i]);
    }
    const auto byGain = [](const ModalGuess& a, const ModalGuess& b) { return a.gain > b.gain; };
    std::sort(best.begin(), best.end(), byGain);
    if (best.size() > count) best.resize(count);
    for (auto& guess : best) guess = refine(guess);
    std::sort(best.begin(), best.end(), byGain);
    return best;
}

}  // namespace wems::identify
