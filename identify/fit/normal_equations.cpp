#include "identify/fit/normal_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "identify/motion/parallel.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

const AxisLaw& lawOf(const MountModel& model, const StopTerm& term) {
    return model.connections.at(term.connection).axis.at(term.axis);
}

}  // namespace

const Stop& stopOf(const MountModel& model, const StopTerm& term) {
    return lawOf(model, term).stops.at(term.stop);
}

NormalEquations::NormalEquations(std::vector<RunEquations> runs)
    : runs_(std::move(runs)), whitenings_(runs_.size(), Matrix6d::Identity()), columns_(runs_.size()) {
    updateLinear();
}

int NormalEquations::outputCount() const {
    int count = 0;
    for (const auto& run : runs_) count += run.outputs;
    return count;
}

void NormalEquations::updateLinear() {
    const int linear = layout().count();
    std::vector<Eigen::MatrixXd> products(runs_.size(), Eigen::MatrixXd::Zero(linear, linear));
    runParallel(runs_.size(), [&](std::size_t r) {
        products[r].selfadjointView<Eigen::Lower>().rankUpdate(runs_[r].columns.transpose());
    });
    gram_ = Eigen::MatrixXd::Zero(linear, linear);
    for (const auto& product : products) gram_ += product.selfadjointView<Eigen::Lower>();
}

void NormalEquations::whiten(const std::vector<Matrix6d>& transforms) {
    runParallel(runs_.size(), [&](std::size_t r) {
        auto& columns = runs_[r].columns;
        Eigen::Matrix<double, 6, Eigen::Dynamic> rows(6, columns.cols());
        for (int n = 0; n < runs_[r].outputs; ++n) {
            rows.noalias() = transforms[r] * columns.middleRows<6>(6L * n);
            columns.middleRows<6>(6L * n) = rows;
        }
        whitenings_[r] = transforms[r] * whitenings_[r];
    });
    stops_.clear();
    clearances_.clear();
    for (auto& columns : columns_) columns.clear();
    updateLinear();
}

void NormalEquations::setStops(const MountModel& model, std::vector<StopTerm> stops) {
    const int linear = layout().count(), count = static_cast<int>(stops.size());
    std::vector<int> kept(linear);  // old columns that stay, in the new order; -1: new
    for (int c = 0; c < linear; ++c) kept[c] = c;
    std::vector<double> clearances;
    std::vector<std::vector<StopColumn>> columns(runs_.size());
    std::vector<int> slopes;
    for (const StopTerm& stop : stops) {
        const auto old = std::find(stops_.begin(), stops_.end(), stop);
        const std::size_t s = old - stops_.begin();
        const bool stays = old != stops_.end();
        kept.push_back(stays ? valueColumn(s) : -1);
        slopes.push_back(stays ? slopeColumn(s) : -1);
        clearances.push_back(stays ? clearances_[s] : -1);
        for (std::size_t r = 0; r < runs_.size(); ++r)
            columns[r].push_back(stays ? std::move(columns_[r][s]) : StopColumn{});
    }
    kept.insert(kept.end(), slopes.begin(), slopes.end());
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(linear + 2 * count, linear + 2 * count);
    for (Eigen::Index i = 0; i < gram.rows(); ++i)
        for (Eigen::Index j = 0; j < gram.cols(); ++j) {
            const int a = kept[i], b = kept[j];
            if (a >= 0 && b >= 0) gram(i, j) = gram_(a, b);
        }
    gram_ = std::move(gram);
    stops_ = std::move(stops);
    clearances_ = std::move(clearances);
    columns_ = std::move(columns);
    updateStops(model);
}

void NormalEquations::updateStops(const MountModel& model) {
    std::vector<std::size_t> changed;
    for (std::size_t s = 0; s < stops_.size(); ++s)
        if (stopOf(model, stops_[s]).clearance != clearances_[s]) changed.push_back(s);
    if (changed.empty()) return;
    runParallel(runs_.size(), [&](std::size_t r) {
        for (const std::size_t s : changed) {
            const auto& history = runs_[r].axes[stops_[s].historyIndex()];
            columns_[r][s] = makeStopColumn(history, runs_[r].test_function, runs_[r].outputs, stopOf(model, stops_[s]),
                                            lawOf(model, stops_[s]).offset);
            transform(columns_[r][s], whitenings_[r]);
        }
    });
    for (const std::size_t s : changed) clearances_[s] = stopOf(model, stops_[s]).clearance;
    for (const std::size_t s : changed) updateProducts(s);
}

void NormalEquations::updateProducts(std::size_t stop) {
    const int linear = layout().count(), value = valueColumn(stop), slope = slopeColumn(stop);
    Eigen::RowVectorXd value_row = Eigen::RowVectorXd::Zero(linear), slope_row = value_row;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
        const StopColumn& column = columns_[r][stop];
        for (std::size_t n = 0; n < column.output.size(); ++n) {
            const auto rows = runs_[r].columns.middleRows<6>(6L * column.output[n]);
            value_row.noalias() += column.value.col(n).transpose() * rows;
            slope_row.noalias() += column.slope.col(n).transpose() * rows;
        }
    }
    gram_.row(value).head(linear) = value_row;
    gram_.row(slope).head(linear) = slope_row;
    gram_.col(value).head(linear) = value_row.transpose();
    gram_.col(slope).head(linear) = slope_row.transpose();
    for (std::size_t other = 0; other < stops_.size(); ++other) {
        StopProducts sum;
        for (std::size_t r = 0; r < runs_.size(); ++r) {
            const auto products = multiply(columns_[r][stop], columns_[r][other], runs_[r].outputs);
            sum.value_value += products.value_value;
            sum.value_slope += products.value_slope;
            sum.slope_value += products.slope_value;
            sum.slope_slope += products.slope_slope;
        }
        const int other_value = valueColumn(other), other_slope = slopeColumn(other);
        gram_(value, other_value) = gram_(other_value, value) = sum.value_value;
        gram_(value, other_slope) = gram_(other_slope, value) = sum.value_slope;
        gram_(slope, other_value) = gram_(other_value, slope) = sum.slope_value;
        gram_(slope, other_slope) = gram_(other_slope, slope) = sum.slope_slope;
    }
}

Eigen::VectorXd NormalEquations::makeCoefficients(const MountModel& model) const {
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(gram_.cols());
    coefficients.head(layout().count()) = identify::makeCoefficients(layout(), model);
    for (std::size_t s = 0; s < stops_.size(); ++s) coefficients(valueColumn(s)) = stopOf(model, stops_[s]).stiffness;
    return coefficients;
}

Eigen::MatrixXd NormalEquations::makeJacobian(const MountModel& model, const std::vector<Parameter>& parameters) const {
    Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(gram_.cols(), parameters.size());
    for (std::size_t p = 0; p < parameters.size(); ++p) {
        const Parameter& parameter = parameters[p];
        const Eigen::Index column = p;
        const int axis = 3 * parameter.connection + parameter.axis;
        switch (parameter.kind) {
            case ParameterKind::stiffness:
                jacobian(layout().stiffness(axis), column) = 1;
                break;
            case ParameterKind::damping:
                jacobian(layout().damping(axis), column) = 1;
                break;
            case ParameterKind::other:
                throw std::logic_error("no equation of motion is linear in " + parameter.name);
            case ParameterKind::center_of_gravity:
            case ParameterKind::inertia: {
                // The moments are quadratic in these parameters: a central difference is exact.
                const double step = calcScale(model, parameter), value = getParameter(model, parameter.name);
                MountModel up = model, down = model;
                setParameter(up, parameter.name, value + step);
                setParameter(down, parameter.name, value - step);
                jacobian.col(column).segment<9>(layout().firstMoment(0)) =
                    (calcMoments(up.body) - calcMoments(down.body)) / (2 * step);
                break;
            }
            default:
                for (std::size_t s = 0; s < stops_.size(); ++s) {
                    const StopTerm& term = stops_[s];
                    if (term.connection != parameter.connection || term.axis != parameter.axis ||
                        term.stop != parameter.stop)
                        continue;
                    if (parameter.kind == ParameterKind::clearance)
                        jacobian(slopeColumn(s), column) = stopOf(model, term).stiffness;
                    else
                        jacobian(valueColumn(s), column) = 1;
                }
        }
    }
    return jacobian;
}

RowMatrix NormalEquations::apply(std::size_t run, const Eigen::MatrixXd& combination) const {
    return apply(run, combination, 0, runs_[run].outputs);
}

RowMatrix NormalEquations::apply(std::size_t run, const Eigen::MatrixXd& combination, int first, int count) const {
    RowMatrix result = runs_[run].columns.middleRows(6L * first, 6L * count) * combination.topRows(layout().count());
    for (std::size_t s = 0; s < stops_.size(); ++s) {
        const StopColumn& column = columns_[run][s];
        const Eigen::RowVectorXd value = combination.row(valueColumn(s)), slope = combination.row(slopeColumn(s));
        if (value.isZero(0) && slope.isZero(0)) continue;
        const auto begin = std::lower_bound(column.output.begin(), column.output.end(), first);
        for (auto output = begin; output != column.output.end() && *output < first + count; ++output) {
            const Eigen::Index k = output - column.output.begin();
            result.middleRows<6>(6L * (*output - first)) += column.value.col(k) * value + column.slope.col(k) * slope;
        }
        const RowMatrix mean = column.value_mean * value + column.slope_mean * slope;
        for (int n = 0; n < count; ++n) result.middleRows<6>(6L * n) -= mean;
    }
    return result;
}

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
