#include "identify/forward/step_size.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "models/bryant.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

// Step times highest natural frequency.
constexpr double frequency_step = 0.8;
// Step times highest damping rate; the method is stable up to 2.78.
constexpr double damping_step = 1.5;
// Steps for each sample, at most. What settles within a thousandth of the interval between two samples differs from a
// rigid connection by about a thousandth of the motion, which is what simulation and recording are compared to. Two
// orders above dry friction of 12 N that turns at 1 mm/s, sampled at 1 kHz.
constexpr double most_steps = 1000;

double calcLargestStiffness(const AxisForce& force) {
    const AxisLaw& law = force.law();
    double positive = 0, negative = 0;
    for (const Stop& stop : law.stops)
        (stop.side == Side::positive ? positive : negative) += std::max(0.0, stop.stiffness);
    double stiffness = law.stiffness + std::max(0.0, force.curve().largestStiffness()) + std::max(positive, negative);
    for (const MaxwellBranch& branch : force.branches()) stiffness += branch.stiffness;
    return stiffness + force.draggedStiffness(true);
}

double calcLargestDamping(const AxisLaw& law) {
    double damping = law.damping;
    if (law.friction && !law.friction->presliding_stiffness)
        damping += law.friction->force / law.friction->transition_velocity;
    return damping;
}

/// Largest eigenvalue of a symmetric matrix.
double calcLargestEigenvalue(const Eigen::MatrixXd& matrix) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff();
}

}  // namespace

FastestRates calcFastestRates(const MountModel& model) {
    const Eigen::Index modes = model.bracket.size();
    // Columns scaled by mass^-1/2, so that the eigenvalues of K and C are those of M^-1 K and M^-1 C.
    const Eigen::LLT<Eigen::Matrix3d> inertia(model.body.inertia);
    const Eigen::Matrix3d inverse_root = inertia.matrixL().solve(Eigen::Matrix3d::Identity());
    Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(6 + modes, 6 + modes);
    Eigen::MatrixXd damping = stiffness;
    double fastest_state = 0;
    for (const Connection& connection : model.connections) {
        Eigen::MatrixXd J(3, 6 + modes);
        J.leftCols<3>() = Eigen::Matrix3d::Identity() / std::sqrt(model.body.mass);
        J.middleCols<3>(3) =
            -crossMatrix(connection.position - model.body.center_of_gravity) * inverse_root.transpose();
        for (Eigen::Index j = 0; j < modes; ++j) {
            const BracketMode& mode = model.bracket[j];
            J.col(6 + j) = -(mode.translation + mode.rotation.cross(connection.position));
        }
        for (int axis = 0; axis < 3; ++axis) {
            const AxisForce force(connection.axis[axis]);
            stiffness += calcLargestStiffness(force) * J.row(axis).transpose() * J.row(axis);
            damping += calcLargestDamping(force.law()) * J.row(axis).transpose() * J.row(axis);
            for (const MaxwellBranch& branch : force.branches())
                fastest_state = std::max(fastest_state, 1 / branch.time_constant);
        }
    }
    for (Eigen::Index j = 0; j < modes; ++j) {
        const BracketMode& mode = model.bracket[j];
        const double omega = kTwoPi * mode.frequency;
        stiffness(6 + j, 6 + j) += omega * omega;
        damping(6 + j, 6 + j) += 2 * mode.damping_ratio * omega;
    }
    return {std::sqrt(std::max(0.0, calcLargestEigenvalue(stiffness))),
            std::max(fastest_state, calcLargestEigenvalue(damping))};
}

int chooseStepsPerSample(const MountModel& model, double interval) {
    const FastestRates rates = calcFastestRates(model);
    const double steps = std::max(rates.frequency * interval / frequency_step, rates.damping * interval / damping_step);
    if (!(steps <= most_steps)) {
        const bool oscillates = rates.frequency / frequency_step > rates.damping / damping_step;
        throw SimulationDiverged("the model is too stiff to be simulated: a rate of " +
                                 formatNumber(oscillates ? rates.frequency : rates.damping, 3) +
                                 " 1/s, more than a thousand times that of the samples");
    }
    return std::max(1, static_cast<int>(std::ceil(steps - 1e-9)));
}

}  // namespace wems::identify
