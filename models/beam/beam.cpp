#include "models/beam/beam.hpp"

#include <Eigen/Eigenvalues>

#include "models/pi.hpp"

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

}  // namespace wems
