#include "identify/problem/second_order.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "models/bryant.hpp"

namespace wems::identify {
namespace {

// Of a mixed difference, in rad, rad/s, m/s² and so on: outputs are quadratic in all but the rotation, whose terms of
// fourth order are a millionth of the second.
constexpr double kStep = 1e-3;

/// What an output can be a product of, beside forces: rotation, angular velocity and acceleration, acceleration, and
/// the other part's rotation and displacement.
enum Turning { rotation, velocity, acceleration, push, other_rotation, other_place, kTurnings };

/// An output has no more time derivatives than an acceleration, and a force none.
struct Kind {
    Eigen::Index coordinate;  // three of each Turning, then forces
    std::size_t derivative;   // of the signal
};

std::vector<Kind> listKinds(Eigen::Index forces) {
    constexpr struct {
        Turning turning;
        std::size_t derivative;
    } kPairs[] = {{rotation, 0},     {rotation, 1}, {rotation, 2},       {velocity, 0},   {velocity, 1},
                  {acceleration, 0}, {push, 0},     {other_rotation, 0}, {other_place, 0}};
    std::vector<Kind> kinds;
    for (const auto& pair : kPairs)
        for (Eigen::Index axis = 0; axis < 3; ++axis) kinds.push_back({3 * pair.turning + axis, pair.derivative});
    for (Eigen::Index f = 0; f < forces; ++f) kinds.push_back({3 * kTurnings + f, 0});
    return kinds;
}

/// A motion of one coordinate, moved along a direction by a signal with one derivative.
TurningInstant makeInstant(Eigen::Index forces, const Kind& kind, double value, int direction, double moved) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(3 * kTurnings + forces);
    x[kind.coordinate] = value;
    Vector6 q[3] = {Vector6::Zero(), Vector6::Zero(), Vector6::Zero()};
    q[kind.derivative][direction] = moved;
    const Eigen::Vector3d turn = q[0].tail<3>(), rate = q[1].tail<3>(), w = x.segment<3>(3 * velocity),
                          alpha = x.segment<3>(3 * acceleration);
    TurningInstant at;
    at.unmoved_R = rotationFromVector(x.segment<3>(3 * rotation));
    at.R = rotationFromVector(turn) * at.unmoved_R;
    at.p = q[0].head<3>();
    at.w = w + rate + turn.cross(w);
    at.a = x.segment<3>(3 * push) + q[2].head<3>();
    at.alpha = alpha + q[2].tail<3>() + rate.cross(w) + turn.cross(alpha);
    at.other_R = rotationFromVector(x.segment<3>(3 * other_rotation));
    at.other_p = x.segment<3>(3 * other_place);
    at.forces = x.tail(forces);
    return at;
}

/// Mixed second derivatives by a kind of product: outputs x 6 directions. @param[out] largest of the outputs
Eigen::MatrixXd differentiate(const TurningOutputs& outputs, Eigen::Index forces, const Kind& kind, double& largest) {
    Eigen::MatrixXd coefficients;
    for (int direction = 0; direction < 6; ++direction)
        for (const double sign : {1.0, -1.0}) {
            const Eigen::VectorXd ahead = outputs(makeInstant(forces, kind, sign * kStep, direction, kStep));
            const Eigen::VectorXd behind = outputs(makeInstant(forces, kind, sign * kStep, direction, -kStep));
            largest = std::max({largest, ahead.cwiseAbs().maxCoeff(), behind.cwiseAbs().maxCoeff()});
            if (coefficients.size() == 0) coefficients.setZero(ahead.size(), 6);
            coefficients.col(direction) += sign / (4 * kStep * kStep) * (ahead - behind);
        }
    return coefficients;
}

}  // namespace

SecondOrder::SecondOrder(const SmoothPart& part, const SmoothPart& other, const Eigen::MatrixXd& forces,
                         const Signals& signals, const EquationSpectra& spectra, const TurningOutputs& outputs) {
    const Eigen::Index samples = part.p.cols(), bins = spectra.binCount();
    Eigen::MatrixXd coordinates(samples, 3 * kTurnings + forces.rows());  // as Kind counts them
    coordinates << part.theta.transpose(), part.w.transpose(), part.alpha.transpose(), part.a.transpose(),
        other.theta.transpose(), (other.p - part.p).transpose(), forces.transpose();
    std::vector<Eigen::MatrixXf> products;
    for (const Kind& kind : listKinds(forces.rows())) {
        double largest = 0;
        Eigen::MatrixXd coefficients = differentiate(outputs, forces.rows(), kind, largest);
        // What rounding makes of a product that is not there: a few operations, each of one part in 1 / epsilon of the
        // output, over the steps.
        constexpr double kRounding = 10 * std::numeric_limits<double>::epsilon() / (kStep * kStep);
        if (coefficients.cwiseAbs().maxCoeff() <= kRounding * largest) continue;
        Eigen::MatrixXd product = coordinates.col(kind.coordinate).asDiagonal() * signals.at(kind.derivative);
        product.rowwise() -= product.colwise().mean().eval();
        const Eigen::MatrixXcd spectrum = spectra.transformSamples(product);
        products.emplace_back(6, 2 * bins);
        products.back() << spectrum.real().cast<float>(), spectrum.imag().cast<float>();
        coefficients_.push_back(std::move(coefficients));
    }
    products_.resize(6 * static_cast<Eigen::Index>(products.size()), 2 * bins);
    for (std::size_t i = 0; i < products.size(); ++i)
        products_.middleRows(6 * static_cast<Eigen::Index>(i), 6) = products[i];
}

Eigen::MatrixXcf SecondOrder::calc(const Matrix6& C) const {
    if (coefficients_.empty()) return {};
    // An error of one channel moves the part along one direction by one signal: C = U S Vᵀ has few of each. The signals
    // are taken together first.
    const Eigen::JacobiSVD<Matrix6> svd(C, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Index rank = svd.rank(), kinds = coefficients_.size();
    const Eigen::MatrixXd U = svd.matrixU().leftCols(rank) * svd.singularValues().head(rank).asDiagonal();
    Eigen::MatrixXf weights(coefficients_.front().rows(), rank * kinds);
    for (Eigen::Index i = 0; i < kinds; ++i)
        weights.middleCols(rank * i, rank) = (coefficients_[static_cast<std::size_t>(i)] * U).cast<float>();
    const Eigen::MatrixXf signals =
        svd.matrixV().leftCols(rank).transpose().cast<float>() * products_.reshaped(6, kinds * products_.cols());
    const Eigen::MatrixXf all = weights * signals.reshaped(rank * kinds, products_.cols());
    const Eigen::Index bins = all.cols() / 2;
    Eigen::MatrixXcf result(all.rows(), bins);
    result.real() = all.leftCols(bins);
    result.imag() = all.rightCols(bins);
    return result;
}

}  // namespace wems::identify
