#include "identify/problem/slow_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <complex>
#include <vector>

#include "identify/motion/fourier.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/axis_law.hpp"
#include "models/bryant.hpp"

namespace wems::identify {

namespace {

constexpr int kIterations = 20;  // steps that never overshoot, and shrink as a geometric series

Eigen::MatrixXd calcRelative(const RunMotion& run, const MountModel& model) {
    const auto samples = run.mobile.p.cols();
    Eigen::MatrixXd q(3 * model.connections.size(), samples);
    for (Eigen::Index k = 0; k < samples; ++k) {
        const Eigen::Matrix3d R_GM = rotationFromVector(run.mobile.theta.col(k)),
                              R_GF = rotationFromVector(run.fixed.theta.col(k));
        for (std::size_t i = 0; i < model.connections.size(); ++i) {
            const Eigen::Vector3d r = model.connections[i].position;
            q.block<3, 1>(3 * i, k) =
                R_GF.transpose() * (run.mobile.p.col(k) + R_GM * r - run.fixed.p.col(k) - R_GF * r);
        }
    }
    return q;
}

/// Largest mean of `values` over any window of so many samples.
double calcLargestMean(const Eigen::VectorXd& values, Eigen::Index window) {
    double sum = 0, largest = 0;
    for (Eigen::Index k = 0; k < values.size(); ++k) {
        sum += values[k];
        if (k >= window) sum -= values[k - window];
        largest = std::max(largest, sum / static_cast<double>(window));
    }
    return largest;
}

}  // namespace

void restoreSlowMotion(RunMotion& run, const MountModel& model) {
    if (run.mobile.displacement_measured || !(run.trusted_from > 0)) return;
    const Eigen::MatrixXd measured = calcRelative(run, model);
    Eigen::Matrix<double, 6, Eigen::Dynamic> directions(6, measured.rows());
    std::vector<AxisForce> laws;
    for (Eigen::Index i = 0; i < measured.rows(); ++i) {
        const std::size_t connection = i / 3;
        directions.col(i) = calcAxisDirection(model, static_cast<int>(i / 3), static_cast<int>(i % 3));
        laws.emplace_back(model.connections[connection].axis[i % 3]);
    }
    const Fourier fourier(static_cast<int>(measured.cols()));
    const auto slow_bins = std::min<Eigen::Index>(
        fourier.binCount(), static_cast<Eigen::Index>(run.trusted_from * fourier.size() * run.interval) + 1);
    const auto window = std::max<Eigen::Index>(1, static_cast<Eigen::Index>(1 / (run.trusted_from * run.interval)));
    Eigen::MatrixXd acceleration(6, measured.cols());
    acceleration << run.mobile.a, run.mobile.alpha;
    const Eigen::MatrixXd inertia = calcMassMatrix(model.body) * acceleration;
    Eigen::MatrixXd slow = Eigen::MatrixXd::Zero(6, measured.cols());
    for (int iteration = 0; iteration < kIterations; ++iteration) {
        // Steps by a stiffness at least as large as the mean one at any time: they never overshoot.
        Eigen::MatrixXd force = measured + directions.transpose() * slow;
        Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
        Eigen::VectorXd tangent(force.cols());
        for (Eigen::Index i = 0; i < force.rows(); ++i) {
            const auto& law = laws[i];
            for (Eigen::Index k = 0; k < force.cols(); ++k) {
                tangent[k] = std::max(0.0, law.calcStaticStiffness(force(i, k)));
                force(i, k) = law.calcStaticForce(force(i, k));
            }
            stiffness += calcLargestMean(tangent, window) * directions.col(i) * directions.col(i).transpose();
        }
        const Eigen::LLT<Eigen::Matrix<double, 6, 6>> factor(stiffness);
        if (factor.info() != Eigen::Success) return;
        Eigen::MatrixXcd spectra = fourier.forward(inertia + directions * force);
        spectra.rightCols(spectra.cols() - slow_bins).setZero();
        slow -= factor.solve(fourier.inverse(spectra, static_cast<int>(measured.cols())));
    }
    run.mobile.p += slow.topRows(3);
    run.mobile.theta += slow.bottomRows(3);
    run.notes.emplace_back("mobile part: the displacement below that follows from the balance of the model's forces");
}

}  // namespace wems::identify
