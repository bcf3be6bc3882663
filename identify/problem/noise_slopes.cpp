#include "identify/problem/noise_slopes.hpp"

#include <Eigen/Dense>
#include <cmath>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/mount_equation.hpp"
#include "models/axis_law.hpp"
#include "models/pi.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;
using Vector12c = Eigen::Matrix<Complex, 12, 1>;

}  // namespace

NoiseSlopes::NoiseSlopes(const OpenLoopRun& run, const MountModel& model, const EquationSpectra& spectra,
                         const RunNoise& noise)
    : open_(run), model_(model), spectra_(spectra), noise_(&noise), M_(calcMassMatrix(model.body)) {
    for (int row = 0; row < 3 * static_cast<int>(model.connections.size()); ++row) {
        const Vector6 d = calcAxisDirection(model, row / 3, row % 3);
        Eigen::MatrixXcd products(12, spectra.binCount());
        for (Eigen::Index b = 0; b < products.cols(); ++b) products.col(b) = calcProduct(b, d, d);
        axis_products_.push_back(std::move(products));
    }
}

NoiseSlopes::Slope NoiseSlopes::calcLawSlope(const TestState& from, const TestState& to, int connection, int axis,
                                             double step) const {
    const auto c = static_cast<std::size_t>(connection), a = static_cast<std::size_t>(axis);
    const Eigen::Index row = 3 * connection + axis;
    const Eigen::VectorXcd change = (calcDynamicStiffness(to.model.connections[c].axis[a], row) -
                                     calcDynamicStiffness(from.model.connections[c].axis[a], row)) /
                                    step;
    Slope sum = Slope::Zero();
    for (Eigen::Index b = 0; b < change.size(); ++b)
        sum.col(bandOf(b)) += 2 * (axis_products_[static_cast<std::size_t>(row)].col(b) * change[b]).real();
    return sum;
}

NoiseSlopes::Slope NoiseSlopes::calcPositionSlope(int connection, int moved) const {
    Slope sum = Slope::Zero();
    const Eigen::Vector3d e = Eigen::Vector3d::Unit(moved);
    const auto& laws = model_.connections[static_cast<std::size_t>(connection)].axis;
    for (int a = 0; a < 3; ++a) {
        const Vector6 d = calcAxisDirection(model_, connection, a);
        Vector6 change;
        change << Eigen::Vector3d::Zero(), e.cross(Eigen::Vector3d::Unit(a));
        const auto& law = laws[static_cast<std::size_t>(a)];
        for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
            const Complex stiffness(law.stiffness, spectra_.angular(b) * law.damping);
            sum.col(bandOf(b)) += 2 * (stiffness * (calcProduct(b, change, d) + calcProduct(b, d, change))).real();
        }
    }
    return sum;
}

NoiseSlopes::Slope NoiseSlopes::calcInertiaSlope(const Matrix6& dM, const Eigen::Matrix3d& gyroscopic) const {
    Slope sum = Slope::Zero();
    for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
        const double w = spectra_.angular(b);
        Eigen::Matrix<Complex, 12, 6> change;
        change << -w * w * dM.cast<Complex>(), w * w * noise_->receptance(b) * dM.cast<Complex>();
        change.block<3, 3>(3, 3) += Complex(0, w) * gyroscopic.cast<Complex>();
        const Eigen::Matrix<Complex, 12, 6> left = noise_->whitener(b) * change;
        const Eigen::Matrix<Complex, 12, 6> right = noise_->regressorNoise(b).topRows<6>().transpose();
        for (int c = 0; c < 6; ++c) sum.col(bandOf(b)) += 2 * left.col(c).cwiseProduct(right.col(c)).real();
    }
    return sum;
}

NoiseSlopes::Slope NoiseSlopes::calcModeSlope(int mode, int which) const {
    const BracketMode& own = model_.bracket[static_cast<std::size_t>(mode)];
    const Vector6 shape = calcShape(own);
    const Eigen::Vector3d load = own.load_translation;
    Slope sum = Slope::Zero();
    const auto addOuter = [&](Eigen::Index b, Complex factor, const Vector6& a, const Vector6& c,
                              const Eigen::Vector3d& c_load) {
        const Vector12c left = noise_->whitener(b).rightCols<6>() * a.cast<Complex>();
        const double w2 = spectra_.angular(b) * spectra_.angular(b);
        const Vector6 inertia = w2 * (M_ * c);
        Vector12c right = noise_->regressorNoise(b).topRows<6>().transpose() * inertia.cast<Complex>();
        right += noise_->loadNoise(b).transpose() * c_load.cast<Complex>();
        sum.col(bandOf(b)) += 2 * (factor * left.cwiseProduct(right)).real();
    };
    const double w0 = kTwoPi * own.frequency;
    for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
        const double w = spectra_.angular(b);
        const Complex h = calcModalResponse(own, w);
        if (which == 0)
            addOuter(b, -h * h * Complex(2 * w0, 2 * own.damping_ratio * w) * kTwoPi, shape, shape, load);
        else if (which == 1)
            addOuter(b, -h * h * Complex(0, 2 * w0 * w), shape, shape, load);
        else if (which < 8) {
            const Vector6 e = Vector6::Unit(which - 2);
            addOuter(b, h, e, shape, load);
            addOuter(b, h, shape, e, Eigen::Vector3d::Zero());
        } else {
            addOuter(b, h, shape, Vector6::Zero(), Eigen::Vector3d::Unit(which - 8));
        }
    }
    return sum;
}

NoiseSlopes::Slope NoiseSlopes::calcLoadSlope() const {
    Slope sum = Slope::Zero();
    for (const auto& own : model_.bracket) {
        const Vector6 shape = calcShape(own);
        for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
            const Vector12c left = noise_->whitener(b).rightCols<6>() * shape.cast<Complex>();
            const Vector12c right = noise_->loadNoise(b).transpose() * own.load_translation.cast<Complex>();
            sum.col(bandOf(b)) += 2 * (calcModalResponse(own, spectra_.angular(b)) * left.cwiseProduct(right)).real();
        }
    }
    return sum;
}

NoiseSlopes::Slope NoiseSlopes::calcSensorSlope(const SensorEffect& effect) const {
    Slope sum = Slope::Zero();
    const Eigen::Index first = effect.part == Part::mobile ? 0 : 6;
    for (const auto& change : effect.changes)
        for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
            const Vector12c left = noise_->whitenedMotion(b).middleCols<6>(first) * change.direction.cast<Complex>();
            const Vector12c right =
                noise_->regressorNoise(b).middleRows<6>(first).transpose() * change.signal.cast<Complex>();
            sum.col(bandOf(b)) -= 2 * (change.weight[b] * left.cwiseProduct(right)).real();
        }
    return sum;
}

Eigen::Matrix<std::complex<double>, 12, 1> NoiseSlopes::calcProduct(Eigen::Index b, const Vector6& left,
                                                                    const Vector6& right) const {
    const Matrix12c& U = noise_->regressorNoise(b);
    const Vector12c l = noise_->whitener(b).leftCols<6>() * left.cast<Complex>();
    const Vector12c r = (U.topRows<6>() - U.bottomRows<6>()).transpose() * right.cast<Complex>();
    return l.cwiseProduct(r);
}

Eigen::VectorXcd NoiseSlopes::calcDynamicStiffness(AxisLaw law, Eigen::Index row) const {
    law.friction.reset();
    const AxisForce force(law);
    const std::vector<double> z(static_cast<std::size_t>(force.stateCount()) + 1, 0.0);
    constexpr int kEvery = 4;  // samples; the mean of thousands needs no more
    double stiffness = 0, damping = 0, count = 0;
    for (int k = 0; k < open_.sampleCount(); k += kEvery) {
        stiffness += force.calcStiffness(open_.q(row, k), open_.v(row, k), open_.time[k], z.data());
        damping += force.calcDamping(open_.q(row, k), open_.v(row, k), open_.time[k], z.data());
        ++count;
    }
    Eigen::VectorXcd result(spectra_.binCount());
    for (Eigen::Index b = 0; b < result.size(); ++b) {
        const double w = spectra_.angular(b);
        result[b] = Complex(stiffness / count, w * damping / count);
        for (const auto& branch : force.branches())
            result[b] -= branch.stiffness / Complex(1, w * branch.time_constant);
    }
    return result;
}

}  // namespace wems::identify
