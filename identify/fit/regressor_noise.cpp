#include "identify/fit/regressor_noise.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <complex>

#include "models/bryant.hpp"
#include "models/pi.hpp"

namespace wems::identify {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::complex;

/// Products of the transfer functions of displacement, velocity and acceleration columns for one white source.
Eigen::Matrix3d integrateTransfers(const RunMotion& motion, const PartMotion& part, const TestFunction& test_function,
                                   bool from_displacement) {
    constexpr int points = 2000;
    const double nyquist = 0.5 / motion.interval, step = nyquist / points;
    Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
    for (int n = 0; n < points; ++n) {
        const double frequency = (n + 0.5) * step, omega = kTwoPi * frequency;
        const complex<double> derivative(0, omega);
        const double smooth = test_function.response(frequency);
        std::array<complex<double>, 3> transfer{};
        if (part.displacement_measured && !part.acceleration_measured) {
            if (!from_displacement) break;
            transfer = {smooth, smooth * derivative, smooth * derivative * derivative};
        } else if (!part.displacement_measured) {
            if (from_displacement) break;
            const double passed = frequency > motion.trusted_from ? smooth : 0.0;
            transfer = {passed / (derivative * derivative), passed / derivative, smooth};
        } else {  // both: each weighed by its variance at this frequency
            const double ratio = std::pow(omega * omega * part.displacement_noise / part.acceleration_noise, 2);
            const double share = 1 / (1 + ratio);  // of the displacement in the fused motion
            if (from_displacement)
                transfer = {smooth * share, smooth * share * derivative, 0};
            else
                transfer = {smooth * (1 - share) / (derivative * derivative), smooth * (1 - share) / derivative,
                            smooth};
        }
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) products(i, j) += (transfer.at(i) * std::conj(transfer.at(j))).real();
    }
    return products * step / nyquist;
}

/// Response of a column to noise of the mobile part's and the fixed part's pose, and which derivative of it.
struct Sensitivity {
    Matrix6d mobile = Matrix6d::Zero(), fixed = Matrix6d::Zero();
    int derivative = 0;
};

std::vector<Sensitivity> makeSensitivities(const ColumnLayout& layout, const MountModel& model) {
    std::vector<Sensitivity> sensitivities(layout.count());
    const auto at = [&](int column) -> Sensitivity& { return sensitivities[column]; };
    std::array<Matrix6d, 10> body;
    body.fill(Matrix6d::Zero());
    body[0].topLeftCorner<3, 3>().setIdentity();
    for (int j = 0; j < 3; ++j) {
        const Matrix3d cross = crossMatrix(Vector3d::Unit(j));
        body.at(1 + j).topRightCorner<3, 3>() = -cross;
        body.at(1 + j).bottomLeftCorner<3, 3>() = cross;
    }
    constexpr std::array<int, 6> rows{0, 1, 2, 0, 0, 1}, columns{0, 1, 2, 1, 2, 2};
    for (std::size_t j = 0; j < 6; ++j)
        body.at(4 + j)(3 + rows.at(j), 3 + columns.at(j)) = body.at(4 + j)(3 + columns.at(j), 3 + rows.at(j)) = 1;
    const auto moments = calcMoments(model.body);
    if (layout.free_body) {
        for (int j = 0; j < 10; ++j) at(layout.mass() + j) = {body.at(j), Matrix6d::Zero(), 2};
    } else {
        at(layout.known()).derivative = 2;
        at(layout.known()).mobile = model.body.mass * body[0];
        for (int j = 0; j < 9; ++j) at(layout.known()).mobile += moments(j) * body.at(1 + j);
    }
    for (int axis = 0; axis < layout.axes; ++axis) {
        Vector6d pattern;
        const Vector3d direction = Vector3d::Unit(axis % 3);
        pattern << direction, model.connections[axis / 3].position.cross(direction);
        at(layout.stiffness(axis)) = {pattern * pattern.transpose(), -pattern * pattern.transpose(), 0};
        at(layout.damping(axis)) = {pattern * pattern.transpose(), -pattern * pattern.transpose(), 1};
    }
    return sensitivities;
}

}  // namespace

Eigen::MatrixXd calcNoiseProducts(const RunMotion& motion, const MountModel& model, const RunEquations& equations,
                                  const Matrix6d& whitening) {
    const auto sensitivities = makeSensitivities(equations.layout, model);
    const Eigen::Index count = sensitivities.size();
    Eigen::MatrixXd products = Eigen::MatrixXd::Zero(count, count);
    const Matrix6d weight = whitening.transpose() * whitening;
    for (const bool mobile : {true, false}) {
        const PartMotion& part = mobile ? motion.mobile : motion.fixed;
        for (const bool from_displacement : {true, false}) {
            const bool measured = from_displacement ? part.displacement_measured : part.acceleration_measured;
            const double noise = from_displacement ? part.displacement_noise : part.acceleration_noise;
            if (!measured || !std::isfinite(noise) || noise <= 0) continue;
            const Eigen::Matrix3d transfers =
                noise * noise * integrateTransfers(motion, part, equations.test_function, from_displacement);
            const Matrix6d& pose = from_displacement ? part.displacement_covariance : part.acceleration_covariance;
            for (Eigen::Index j = 0; j < count; ++j) {
                const Sensitivity& a = sensitivities[j];
                const Matrix6d weighted = pose * (mobile ? a.mobile : a.fixed).transpose() * weight;
                for (Eigen::Index l = 0; l <= j; ++l) {
                    const Sensitivity& b = sensitivities[l];
                    const double transfer = transfers(a.derivative, b.derivative);
                    if (transfer == 0) continue;
                    products(j, l) += transfer * weighted.cwiseProduct((mobile ? b.mobile : b.fixed).transpose()).sum();
                }
            }
        }
    }
    return equations.outputs * Eigen::MatrixXd(products.selfadjointView<Eigen::Lower>());
}

}  // namespace wems::identify
