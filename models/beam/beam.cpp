#include "models/beam/beam.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "models/common/units.hpp"

namespace wems {

BeamMatrices assembleBeam(const Beam& beam) {
    const double l = beam.length / beam.elements, area = beam.width * beam.thickness;
    const double second_moment = beam.width * beam.thickness * beam.thickness * beam.thickness / 12;
    Eigen::Matrix4d mass, stiffness;
    mass << 156, 22 * l, 54, -13 * l,           //
        22 * l, 4 * l * l, 13 * l, -3 * l * l,  //
        54, 13 * l, 156, -22 * l,               //
        -13 * l, -3 * l * l, -22 * l, 4 * l * l;
    mass *= beam.density * area * l / 420;
    stiffness << 12, 6 * l, -12, 6 * l,       //
        6 * l, 4 * l * l, -6 * l, 2 * l * l,  //
        -12, -6 * l, 12, -6 * l,              //
        6 * l, 2 * l * l, -6 * l, 4 * l * l;
    stiffness *= beam.modulus * second_moment / (l * l * l);

    const int all = beam.coordinates() + 2;  // the clamped node too
    Eigen::MatrixXd M = Eigen::MatrixXd::Zero(all, all), K = M;
    for (int e = 0; e < beam.elements; ++e) {
        M.block<4, 4>(2L * e, 2L * e) += mass;
        K.block<4, 4>(2L * e, 2L * e) += stiffness;
    }
    const int kept = beam.coordinates();
    return {M.bottomRightCorner(kept, kept), K.bottomRightCorner(kept, kept)};
}

Eigen::VectorXd findBeamFrequencies(const Beam& beam) {
    const BeamMatrices matrices = assembleBeam(beam);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> modes(matrices.stiffness, matrices.mass,
                                                                          Eigen::EigenvaluesOnly);
    return modes.eigenvalues().cwiseSqrt() / (kTwoPi);
}

namespace {

/// One state of the beam; a satisfies the equation of motion at the state's time.
struct BeamState {
    Eigen::VectorXd q, v, a;
};

class Newmark {
public:
    Newmark(const Beam& beam, double step)
        : tip_(Beam::deflection(beam.elements)), cubic_(beam.tip_cubic), step_(step), matrices_(assembleBeam(beam)) {
        damping_ = beam.stiffness_damping * matrices_.stiffness;
        // Average acceleration: q+ = q~ + h²/4 a+, v+ = v~ + h/2 a+.
        const Eigen::MatrixXd effective = matrices_.mass + step / 2 * damping_ + step * step / 4 * matrices_.stiffness;
        inverse_ = effective.inverse();
    }

    void advance(BeamState& state, const Eigen::VectorXd& force) const {
        const Eigen::VectorXd q = state.q + step_ * state.v + step_ * step_ / 4 * state.a;
        const Eigen::VectorXd v = state.v + step_ / 2 * state.a;
        const Eigen::VectorXd linear = inverse_ * (force - damping_ * v - matrices_.stiffness * q);
        // The spring acts on one coordinate: a scalar equation for its displacement.
        const double compliance = step_ * step_ / 4 * inverse_(tip_, tip_);
        const double free = q(tip_) + step_ * step_ / 4 * linear(tip_);
        double w = state.q(tip_);
        for (int i = 0; i < 50; ++i) {
            const double change = (w + compliance * cubic_ * w * w * w - free) / (1 + 3 * compliance * cubic_ * w * w);
            w -= change;
            if (std::abs(change) <= 1e-16 * std::abs(w)) break;
        }
        state.a = linear - inverse_.col(tip_) * (cubic_ * w * w * w);
        state.q = q + step_ * step_ / 4 * state.a;
        state.v = v + step_ / 2 * state.a;
    }

private:
    int tip_;
    double cubic_, step_;
    BeamMatrices matrices_;
    Eigen::MatrixXd damping_, inverse_;
};

}  // namespace

Recording simulateBeam(const Beam& beam, const Signal& signal, const BeamRun& run) {
    const double interval = 1 / run.sample_rate, step = interval / run.steps_per_sample;
    const auto samples = static_cast<std::size_t>(std::floor(signal.duration() * run.sample_rate)) + 1;
    const Newmark integrator(beam, step);
    BeamState state;
    state.q = state.v = state.a = Eigen::VectorXd::Zero(beam.coordinates());

    Recording recording;
    recording.metadata["beam"] = "last two nodes, x at the upper surface";
    recording.time.resize(samples);
    const std::array<const char*, 6> quantities{"z", "vz", "az", "x", "vx", "ax"};
    const std::array<const char*, 3> units{"m", "m/s", "m/s^2"};
    for (const int node : {beam.elements - 1, beam.elements})
        for (std::size_t j = 0; j < quantities.size(); ++j)
            recording.channels.push_back({"mobile." + std::to_string(node) + "." + quantities.at(j), units.at(j % 3),
                                          std::vector<double>(samples), 0});
    recording.channels.push_back({"load.fz", "N", std::vector<double>(samples), 0});

    Eigen::VectorXd force = Eigen::VectorXd::Zero(beam.coordinates());
    const auto load = Beam::deflection(beam.load_node);
    for (std::size_t k = 0; k < samples; ++k) {
        const double start = static_cast<double>(k) * interval;
        std::size_t channel = 0;
        for (const int node : {beam.elements - 1, beam.elements}) {
            const int w = Beam::deflection(node), theta = Beam::rotation(node);
            const double lever = -beam.thickness / 2;
            for (const double value : {state.q(w), state.v(w), state.a(w), lever * state.q(theta),
                                       lever * state.v(theta), lever * state.a(theta)})
                recording.channels[channel++].values[k] = value;
        }
        recording.time[k] = start;
        recording.channels[channel].values[k] = run.force * signal.value(start);
        for (int s = 1; s <= run.steps_per_sample; ++s) {
            force(load) = run.force * signal.value(start + s * step);
            integrator.advance(state, force);
        }
    }
    return recording;
}

}  // namespace wems
