#include "identify/fit/normal_equations.hpp"

#include <algorithm>

#include "identify/motion/parallel.hpp"
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

}  // namespace wems::identify
