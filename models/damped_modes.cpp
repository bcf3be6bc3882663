#include "models/damped_modes.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "models/common/units.hpp"

namespace wems {
namespace {

Eigen::RowVectorXd findRow(const LinearSystem& system, const LinearBranch& branch) {
    return system.ends[branch.connection].row(branch.axis);
}

/// The system with its branches frozen at omega.
LinearSystem freeze(const LinearSystem& system, double omega) {
    LinearSystem frozen = system;
    for (const LinearBranch& b : system.branches) {
        const Eigen::MatrixXd square = findRow(system, b).transpose() * findRow(system, b);
        const double u = omega * b.branch.time_constant;
        frozen.stiffness += b.branch.stiffness * u * u / (1 + u * u) * square;
        frozen.damping += b.branch.stiffness * b.branch.time_constant / (1 + u * u) * square;
    }
    return frozen;
}

/// Of each normal mode frequency, shape and damping with the branches as they are at that frequency.
std::vector<DampedMode> findNormalModes(const LinearSystem& system) {
    constexpr int most_iterations = 100;
    constexpr double converged = 1e-13;
    std::vector<DampedMode> modes;
    for (Eigen::Index k = 0; k < system.mass.rows(); ++k) {
        double frequency = 0;
        LinearSystem frozen = system;
        LinearModes all = findLinearModes(frozen);
        for (int i = 0; i < most_iterations; ++i) {
            const double last = frequency;
            frequency = all.frequency[k];
            if (std::abs(frequency - last) <= converged * frequency || system.branches.empty()) break;
            frozen = freeze(system, kTwoPi * frequency);
            all = findLinearModes(frozen);
        }
        DampedMode mode;
        mode.normal_shape = all.shape.col(k);
        // Rounding of a free direction is the square root of the stiffest mode's.
        mode.undamped_frequency = frequency > 1e-6 * all.frequency[all.frequency.size() - 1] ? frequency : 0;
        mode.effective_mass = (mode.normal_shape.transpose() * system.base).transpose().cwiseAbs2();
        mode.frequency = mode.undamped_frequency;
        if (mode.frequency > 0)
            mode.damping_ratio =
                mode.normal_shape.dot(frozen.damping * mode.normal_shape) / (2 * kTwoPi * mode.frequency);
        mode.shape = mode.normal_shape.cast<std::complex<double>>();
        modes.push_back(mode);
    }
    return modes;
}

/// Turns and scales a shape so that the largest motion of a connection's end is 1, real.
void normalise(const LinearSystem& system, Eigen::VectorXcd& shape) {
    std::complex<double> largest = 0;
    for (std::size_t i = 0; i < system.ends.size(); ++i) {
        for (const auto& end : {system.mobile_ends[i], system.fixed_ends[i]}) {
            const Eigen::Vector3cd motion = end * shape;
            for (const auto& value : motion)
                if (std::abs(value) > (1 + 1e-9) * std::abs(largest)) largest = value;  // the first of equal ones
        }
    }
    if (std::abs(largest) > 0) shape /= largest;
}

struct Match {
    double likeness;
    std::size_t pole, mode;
};

}  // namespace

Eigen::MatrixXd makeStateMatrix(const LinearSystem& system) {
    const Eigen::Index n = system.mass.rows(), states = static_cast<Eigen::Index>(system.branches.size());
    const Eigen::LLT<Eigen::MatrixXd> mass(system.mass);
    Eigen::MatrixXd stiffness = system.stiffness;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n + states, 2 * n + states);
    for (Eigen::Index s = 0; s < states; ++s) {
        const LinearBranch& b = system.branches[s];
        const Eigen::RowVectorXd row = findRow(system, b);
        stiffness += b.branch.stiffness * row.transpose() * row;
        A.block(n, 2 * n + s, n, 1) = mass.solve(b.branch.stiffness * row.transpose());
        A.block(2 * n + s, 0, 1, n) = row / b.branch.time_constant;
        A(2 * n + s, 2 * n + s) = -1 / b.branch.time_constant;
    }
    A.block(0, n, n, n).setIdentity();
    A.block(n, 0, n, n) = -mass.solve(stiffness);
    A.block(n, n, n, n) = -mass.solve(system.damping);
    return A;
}

std::vector<DampedMode> findDampedModes(const LinearSystem& system) {
    std::vector<DampedMode> modes = findNormalModes(system);
    const Eigen::Index n = system.mass.rows();

    // In normal coordinates and units of the stiffest mode's time the matrix is well scaled: x = Φ y, x' = Ω Φ y'.
    const LinearModes basis = findLinearModes(system);
    const double unit = std::max(kTwoPi * basis.frequency[n - 1], 1e-300);
    const Eigen::Index states = system.branches.size();
    Eigen::MatrixXd to = Eigen::MatrixXd::Zero(2 * n + states, 2 * n + states), from = to;
    to.block(0, 0, n, n) = basis.shape;
    to.block(n, n, n, n) = unit * basis.shape;
    from.block(0, 0, n, n) = basis.shape.transpose() * system.mass;
    from.block(n, n, n, n) = from.block(0, 0, n, n) / unit;
    for (Eigen::Index s = 0; s < states; ++s) {
        const LinearBranch& b = system.branches[s];
        const double size = (findRow(system, b) * basis.shape).norm();
        to(2 * n + s, 2 * n + s) = size > 0 ? size : 1;
        from(2 * n + s, 2 * n + s) = 1 / to(2 * n + s, 2 * n + s);
    }
    const Eigen::EigenSolver<Eigen::MatrixXd> solver((from * makeStateMatrix(system) * to / unit).eval());

    std::vector<std::pair<std::complex<double>, Eigen::VectorXcd>> poles;
    for (Eigen::Index j = 0; j < solver.eigenvalues().size(); ++j) {
        const std::complex<double> pole = unit * solver.eigenvalues()[j];
        // Double poles at zero come out as pairs as large as the root of rounding.
        if (pole.imag() <= 0 || std::abs(pole) < 1e-6 * unit) continue;
        poles.emplace_back(pole, basis.shape * solver.eigenvectors().col(j).head(n));
    }
    std::vector<Match> matches;
    for (std::size_t p = 0; p < poles.size(); ++p) {
        const Eigen::VectorXcd weighted = system.mass * poles[p].second;
        const double square = poles[p].second.dot(weighted).real();
        for (std::size_t k = 0; k < modes.size(); ++k) {
            if (modes[k].undamped_frequency == 0) continue;
            const double shape = std::norm(weighted.dot(modes[k].normal_shape.cast<std::complex<double>>())) / square;
            // Of modes that share a shape (springs in series) the frequency decides.
            const double apart = std::log(std::abs(poles[p].first) / kTwoPi / modes[k].undamped_frequency);
            matches.push_back({shape * std::exp(-apart * apart), p, k});
        }
    }
    std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.likeness > b.likeness; });
    std::vector<bool> pole_used(poles.size(), false), mode_used(modes.size(), false);
    for (const Match& match : matches) {
        if (pole_used[match.pole] || mode_used[match.mode]) continue;
        pole_used[match.pole] = mode_used[match.mode] = true;
        const auto& [pole, shape] = poles[match.pole];
        DampedMode& mode = modes[match.mode];
        mode.frequency = std::abs(pole) / kTwoPi;
        mode.damping_ratio = -pole.real() / std::abs(pole);
        mode.damped_frequency = pole.imag() / kTwoPi;
        mode.shape = shape;
    }
    for (std::size_t k = 0; k < modes.size(); ++k) {
        normalise(system, modes[k].shape);
        // Without a pole that oscillates the normal mode's ratio stands, at least 1.
        if (!mode_used[k] && modes[k].frequency > 0) modes[k].damping_ratio = std::max(1.0, modes[k].damping_ratio);
    }
    std::stable_sort(modes.begin(), modes.end(),
                     [](const DampedMode& a, const DampedMode& b) { return a.frequency < b.frequency; });
    return modes;
}

}  // namespace wems
