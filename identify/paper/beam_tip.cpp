#include "identify/paper/beam_tip.hpp"

#include <string>

#include "identify/paper/truncated_svd.hpp"
#include "models/common/error.hpp"

namespace wems::identify {
namespace {

Eigen::VectorXd readChannel(const Recording& recording, int node, const std::string& quantity) {
    const std::string name = "mobile." + std::to_string(node) + "." + quantity;
    const Channel* channel = recording.find(name);
    if (channel == nullptr)
        throw InputError({recording.file, 0, name}, "this channel is missing",
                         "z, vz, az and, at the upper surface, x, vx, ax of the last two nodes");
    return Eigen::Map<const Eigen::VectorXd>(channel->values.data(), channel->values.size());
}

/// Row of the tip's deflection in `matrix` times the coordinates, read from channels z… and x… with prefix v or a.
Eigen::VectorXd applyRow(const Recording& recording, const Beam& beam, const Eigen::MatrixXd& matrix,
                         const std::string& prefix) {
    const int tip = Beam::deflection(beam.elements);
    const double lever = -beam.thickness / 2;
    Eigen::VectorXd sum;
    for (const int node : {beam.elements - 1, beam.elements}) {
        const Eigen::VectorXd part =
            matrix(tip, Beam::deflection(node)) * readChannel(recording, node, prefix + "z") +
            matrix(tip, Beam::rotation(node)) / lever * readChannel(recording, node, prefix + "x");
        if (sum.size() == 0) sum = Eigen::VectorXd::Zero(part.size());
        sum += part;
    }
    return sum;
}

TipSpring fitSpring(const Eigen::VectorXd& inertia, const Eigen::VectorXd& elastic, const Eigen::VectorXd& viscous,
                    const Eigen::VectorXd& w) {
    Eigen::MatrixXd columns(w.size(), 3);
    columns << elastic, viscous, w.array().cube().matrix();
    const Eigen::RowVectorXd norms = columns.colwise().norm().cwiseMax(1e-300);
    const TruncatedSolution solution = solveTruncated(columns.array().rowwise() / norms.array(), -inertia, 3);
    TipSpring spring;
    spring.stiffness = solution.x(0) / norms(0);
    spring.damping = solution.x(1) / norms(1);
    spring.cubic = solution.x(2) / norms(2);
    spring.residual_fraction = solution.residual_fraction;
    spring.deflection = w;
    spring.force = -inertia - spring.stiffness * elastic - spring.damping * viscous;
    return spring;
}

}  // namespace

BeamTip identifyBeamTip(const Recording& recording, const Beam& beam) {
    const BeamMatrices matrices = assembleBeam(beam);
    const int tip = Beam::deflection(beam.elements);
    const Eigen::VectorXd w = readChannel(recording, beam.elements, "z");
    BeamTip result;
    result.complete =
        fitSpring(applyRow(recording, beam, matrices.mass, "a"), applyRow(recording, beam, matrices.stiffness, ""),
                  applyRow(recording, beam, matrices.stiffness, "v"), w);
    const Eigen::VectorXd inertia = matrices.mass(tip, tip) * readChannel(recording, beam.elements, "az");
    result.truncated = fitSpring(inertia, w, readChannel(recording, beam.elements, "vz"), w);
    result.truncated.force = -inertia;
    return result;
}

}  // namespace wems::identify
