#include "models/linear_response.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "models/common/units.hpp"
#include "models/mount_forces.hpp"

namespace wems {

namespace {

using Complex = std::complex<double>;

Complex calcBranchStiffness(const MaxwellBranch& branch, double omega) {
    const Complex product(0, omega * branch.time_constant);
    return branch.stiffness * product / (1.0 + product);
}

}  // namespace

Eigen::MatrixXcd calcDynamicStiffness(const LinearSystem& system, double omega) {
    Eigen::MatrixXcd dynamic =
        (system.stiffness - omega * omega * system.mass).cast<Complex>() + Complex(0, omega) * system.damping;
    for (const LinearBranch& branch : system.branches) {
        const Eigen::RowVectorXd row = system.ends[branch.connection].row(branch.axis);
        dynamic += calcBranchStiffness(branch.branch, omega) * (row.transpose() * row).cast<Complex>();
    }
    return dynamic;
}

LinearDynamics::LinearDynamics(const MountModel& model) : system_(linearizeExactly(model)) {
    const MountForces laws(model);
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    FrameMotion fixed;
    if (!model.bracket.empty())
        fixed = Bracket(model.bracket).calcMotion(rest.eta, Eigen::VectorXd::Zero(rest.eta.size()));
    for (int i = 0; i < laws.connectionCount(); ++i) {
        const Eigen::Vector3d q = calcRelativeMotion(rest.mobile, fixed, model.connections[i].position).q;
        Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero(), damping = stiffness;
        for (int k = 0; k < 3; ++k) {
            const AxisForce& axis = laws.axis(i, k);
            const double* z = rest.states.data() + laws.stateOffset(i, k);
            stiffness(k, k) = axis.calcStaticStiffness(q[k]) + axis.draggedStiffness();
            damping(k, k) = axis.calcDamping(q[k], 0, 0, z);
        }
        stiffness_.push_back(stiffness);
        damping_.push_back(damping);
    }
}

Eigen::VectorXcd LinearDynamics::calcMotion(double frequency, const HarmonicInput& input) const {
    const Eigen::VectorXd force = system_.load * input.load + system_.base * input.base;
    return calcDynamicStiffness(system_, kTwoPi * frequency).partialPivLu().solve(force.cast<Complex>());
}

std::vector<ConnectionResponse> LinearDynamics::calcResponse(double frequency, const HarmonicInput& input) const {
    const double omega = kTwoPi * frequency;
    const Eigen::VectorXcd x = calcMotion(frequency, input);
    std::vector<ConnectionResponse> response;
    for (std::size_t i = 0; i < system_.ends.size(); ++i) {
        ConnectionResponse end;
        end.relative = system_.ends[i] * x;
        end.force = (stiffness_[i] + Complex(0, omega) * damping_[i]) * end.relative;
        end.mobile_acceleration = input.base - omega * omega * (system_.mobile_ends[i] * x);
        end.fixed_acceleration = input.base - omega * omega * (system_.fixed_ends[i] * x);
        response.push_back(end);
    }
    for (const LinearBranch& branch : system_.branches) {
        ConnectionResponse& end = response[branch.connection];
        end.force[branch.axis] += calcBranchStiffness(branch.branch, omega) * end.relative[branch.axis];
    }
    return response;
}

namespace {

/// Nodes and weights of Gauss–Legendre on [−1, 1], half of them (Abramowitz and Stegun, table 25.4, n = 8).
constexpr std::array<double, 4> kNode{0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> kWeight{0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};

/// ∫ |H|² S df and ∫ f² |H|² S df: two columns.
class MeanSquares {
public:
    MeanSquares(const LinearDynamics& dynamics, const HarmonicInput& direction, const PowerSpectrum& spectrum)
        : dynamics_(dynamics), direction_(direction), spectrum_(spectrum) {}

    Eigen::ArrayX2d integrate() const {
        // A panel for each half octave between breakpoints, so that no resonance is overlooked at first sight: eight
        // nodes a panel are closer than a resonance is wide, or halving finds the difference.
        std::vector<double> ends;
        for (std::size_t i = 0; i + 1 < spectrum_.frequency().size(); ++i) {
            const double a = std::log(spectrum_.frequency()[i]), b = std::log(spectrum_.frequency()[i + 1]);
            const int count = static_cast<int>(std::ceil((b - a) / (panel_octaves * std::log(2.0))));
            for (int k = 0; k < count; ++k) ends.push_back(a + (b - a) * k / count);
        }
        ends.push_back(std::log(spectrum_.highest()));
        std::vector<Eigen::ArrayX2d> panels;
        Eigen::ArrayX2d whole;
        for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
            panels.push_back(sum(ends[i], ends[i + 1]));
            whole = i == 0 ? panels[0] : (whole + panels[i]).eval();
        }
        Eigen::ArrayX2d result = Eigen::ArrayX2d::Zero(whole.rows(), 2);
        for (std::size_t i = 0; i + 1 < ends.size(); ++i)
            result += refine(ends[i], ends[i + 1], panels[i], whole, deepest_halving);
        return result;
    }

private:
    static constexpr double panel_octaves = 0.05;
    static constexpr double tolerance = 1e-10;
    static constexpr int deepest_halving = 24;

    Eigen::ArrayX2d sum(double a, double b) const {
        Eigen::ArrayX2d total;
        for (std::size_t i = 0; i < kNode.size(); ++i)
            for (const double sign : {-1.0, 1.0}) {
                const double f = std::exp(0.5 * (a + b) + 0.5 * (b - a) * sign * kNode[i]);
                const Eigen::ArrayXd square = listOutputs(dynamics_.calcResponse(f, direction_)).cwiseAbs2();
                const double weight = 0.5 * (b - a) * kWeight[i] * f * spectrum_.calcValue(f);
                if (total.size() == 0) total = Eigen::ArrayX2d::Zero(square.size(), 2);
                total.col(0) += weight * square;
                total.col(1) += weight * f * f * square;
            }
        return total;
    }

    Eigen::ArrayX2d refine(double a, double b, const Eigen::ArrayX2d& coarse, const Eigen::ArrayX2d& whole,
                           int halvings) const {
        const double middle = 0.5 * (a + b);
        const Eigen::ArrayX2d left = sum(a, middle), right = sum(middle, b);
        Eigen::ArrayX2d fine = left + right;
        if (halvings == 0 || ((fine - coarse).abs() <= tolerance * whole).all()) return fine;
        return refine(a, middle, left, whole, halvings - 1) + refine(middle, b, right, whole, halvings - 1);
    }

    const LinearDynamics& dynamics_;
    const HarmonicInput& direction_;
    const PowerSpectrum& spectrum_;
};

}  // namespace

Eigen::VectorXcd listOutputs(const std::vector<ConnectionResponse>& response) {
    Eigen::VectorXcd outputs(kOutputsPerConnection * static_cast<Eigen::Index>(response.size()));
    Eigen::Index at = 0;
    for (const ConnectionResponse& end : response) {
        outputs.segment<kOutputsPerConnection>(at) << end.relative, end.force, end.mobile_acceleration,
            end.fixed_acceleration;
        at += kOutputsPerConnection;
    }
    return outputs;
}

RandomResponse calcRandomResponse(const LinearDynamics& dynamics, const HarmonicInput& direction,
                                  const PowerSpectrum& spectrum, const std::vector<double>& frequency) {
    RandomResponse response;
    response.frequency = frequency;
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const Eigen::VectorXd square = listOutputs(dynamics.calcResponse(frequency[k], direction)).cwiseAbs2();
        if (k == 0) response.density.resize(square.size(), frequency.size());
        response.density.col(k) = spectrum.calcValue(frequency[k]) * square;
    }
    const Eigen::ArrayX2d squares = MeanSquares(dynamics, direction, spectrum).integrate();
    response.rms = squares.col(0).sqrt();
    response.rate = (squares.col(0) > 0).select((squares.col(1) / squares.col(0)).sqrt(), 0);
    return response;
}

}  // namespace wems
