#include "identify/fit/equation_of_motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {

namespace {

/// Centred quintic B-spline and its derivatives from truncated powers: Σ (−1)^k C(6,k) (x + 3 − k)₊^n / n!, summed from
/// the nearer end of the support so that nothing cancels badly.
double calcSpline(double x, int derivative) {
    const double sign = x > 0 && derivative == 1 ? -1.0 : 1.0;
    const double y = 3 - std::abs(x);  // distance from the nearer end; the spline is even
    constexpr std::array<double, 4> binomial{1, -6, 15, -20};
    constexpr std::array<double, 3> factorial{120, 24, 6};
    double sum = 0;
    for (int k = 0; k < 4 && y > k; ++k) sum += binomial.at(k) * std::pow(y - k, 5 - derivative);
    return sign * sum / factorial.at(derivative);
}

}  // namespace

TestFunction::TestFunction(int knot_samples, double interval)
    : knot_samples_(std::max(1, knot_samples)), half_(3 * knot_samples_ - 1), interval_(interval) {
    const double h = knot_samples_;
    for (int j = -half_; j <= half_; ++j) {
        value_.push_back(calcSpline(j / h, 0) / h);
        first_.push_back(calcSpline(j / h, 1) / (h * h * interval_));
        second_.push_back(calcSpline(j / h, 2) / (h * h * h * interval_ * interval_));
    }
}

int TestFunction::stride() const {
    return std::max(1, knot_samples_ / 2);
}

int TestFunction::outputCount(int samples) const {
    return samples <= 2 * half_ ? 0 : (samples - 2 * half_ - 1) / stride() + 1;
}

double TestFunction::response(double frequency) const {
    const double x = kPi * frequency * knot_samples_ * interval_;
    return std::abs(x) < 1e-9 ? 1.0 : std::pow(std::sin(x) / x, 6);
}

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using MapRow = Eigen::Map<Eigen::RowVectorXd>;

constexpr std::array<int, 6> inertia_rows{0, 1, 2, 0, 0, 1};
constexpr std::array<int, 6> inertia_columns{0, 1, 2, 1, 2, 2};

/// E_j u for the j-th basis matrix of symmetric 3 × 3 matrices.
Vector3d applyInertiaBasis(int j, const Vector3d& u) {
    const int row = inertia_rows.at(j), column = inertia_columns.at(j);
    Vector3d result = Vector3d::Zero();
    result(row) = u(column);
    if (row != column) result(column) = u(row);
    return result;
}

/// Signals of one sample, by the derivative of φ that they are averaged with.
/// value: all columns with the body's ten, 6 numbers each. first: known 6, inertia 6 × 3 (moments), axes 6 each.
/// second: p, R (by columns), θ.
class SampleRows {
public:
    SampleRows(const RunMotion& motion, const MountModel& model, const RelativeHistory& relative,
               const LawHistory& laws)
        : motion_(motion),
          model_(model),
          relative_(relative),
          laws_(laws),
          axes_(static_cast<int>(relative.q.cols())),
          accelerations_(motion.mobile.acceleration_measured) {}

    int valueSize() const { return 6 * (11 + 2 * axes_); }
    int firstSize() const { return 24 + 6 * axes_; }
    static int secondSize() { return 15; }

    void fill(Eigen::Index k, double* value, double* first, double* second) const {
        const Matrix3d R_GM = rotationFromVector(motion_.mobile.theta.col(k));
        const Matrix3d R_GF = rotationFromVector(motion_.fixed.theta.col(k));
        std::fill(value, value + 66, 0.0);
        std::fill(first, first + 24, 0.0);
        fillBody(k, R_GM, value, first, second);
        fillAxes(k, R_GM, R_GF, value, first);
    }

private:
    void fillBody(Eigen::Index k, const Matrix3d& R, double* value, double* first, double* second) const {
        const auto column = [&](double* base, int c) { return Eigen::Map<Vector3d>(base + 6 * c); };
        const auto moment = [&](double* base, int c) { return Eigen::Map<Vector3d>(base + 6 * c + 3); };
        const Vector3d w = motion_.mobile.w.col(k), a = motion_.mobile.a.col(k), alpha = motion_.mobile.alpha.col(k);
        const Vector3d h = R * model_.body.spin;
        const Vector3d& g = model_.gravity;
        if (accelerations_) {
            column(value, 1) = a - g;
            for (int j = 0; j < 3; ++j) {
                const Vector3d e = R.col(j);
                column(value, 2 + j) = alpha.cross(e) + w.cross(w.cross(e));
                moment(value, 2 + j) = e.cross(a - g);
            }
            const Vector3d w_M = R.transpose() * w, alpha_M = R.transpose() * alpha;
            for (int j = 0; j < 6; ++j)
                moment(value, 5 + j) = R * (applyInertiaBasis(j, alpha_M) + w_M.cross(applyInertiaBasis(j, w_M)));
            moment(value, 0) = w.cross(h);
            return;
        }
        column(value, 1) = -g;
        for (int j = 0; j < 3; ++j) moment(value, 2 + j) = (R.col(j) - Vector3d::Unit(j)).cross(a) - R.col(j).cross(g);
        const Vector3d theta = motion_.mobile.theta.col(k);
        const Vector3d rate = w - 0.5 * theta.cross(w) + theta.cross(theta.cross(w)) / 12;  // θ' to O(θ⁴)
        const Vector3d w_M = R.transpose() * w;
        for (int j = 0; j < 6; ++j)
            Eigen::Map<Vector3d>(first + 6 + 3 * j) = R * applyInertiaBasis(j, w_M) - applyInertiaBasis(j, rate);
        Eigen::Map<Vector3d>(first + 3) = h;
        Eigen::Map<Vector3d>{second} = motion_.mobile.p.col(k);
        Eigen::Map<Matrix3d>{second + 3} = R;
        Eigen::Map<Vector3d>(second + 12) = theta;
    }

    void fillAxes(Eigen::Index k, const Matrix3d& R_GM, const Matrix3d& R_GF, double* value, double* first) const {
        const Vector3d w_M = motion_.mobile.w.col(k), w_F = motion_.fixed.w.col(k);
        double* elastic = value + 66;
        double* damping = elastic + 6 * axes_;
        double* displacement = first + 24;
        Eigen::Map<Vector6d> known(value);
        for (int axis = 0; axis < axes_; ++axis) {
            const Vector3d lever = R_GM * model_.connections[axis / 3].position;
            const Vector3d direction = R_GF.col(axis % 3);
            const Vector3d direction_rate = w_F.cross(direction);
            Vector6d pattern, pattern_rate;
            pattern << direction, lever.cross(direction);
            pattern_rate << direction_rate, w_M.cross(lever).cross(direction) + lever.cross(direction_rate);
            const double q = relative_.q(k, axis);
            Eigen::Map<Vector6d>(displacement + 6 * axis) = pattern * q;
            Eigen::Map<Vector6d>(elastic + 6 * axis) =
                pattern * (laws_.elastic_is_displacement ? q : laws_.unit_elastic(k, axis));
            Eigen::Map<Vector6d>(damping + 6 * axis) = -pattern_rate * q;
            if (!laws_.known_is_zero) known += pattern * laws_.known(k, axis);
        }
    }

    const RunMotion& motion_;
    const MountModel& model_;
    const RelativeHistory& relative_;
    const LawHistory& laws_;
    int axes_;
    bool accelerations_;
};

/// Averages of the three groups, put together into 6 rows of all columns (the body's ten included).
void assembleOutput(bool accelerations, int axes, const Eigen::RowVectorXd& value, const Eigen::RowVectorXd& first,
                    const Eigen::RowVectorXd& second, Eigen::Matrix<double, 6, Eigen::Dynamic>& out) {
    for (int c = 0; c < out.cols(); ++c) out.col(c) = value.segment<6>(6 * c).transpose();
    const int damping = 11 + axes;
    for (int axis = 0; axis < axes; ++axis) out.col(damping + axis) -= first.segment<6>(24 + 6 * axis).transpose();
    if (accelerations) return;
    out.col(0) -= first.segment<6>(0).transpose();
    const Vector3d p = second.segment<3>(0).transpose(), theta = second.segment<3>(12).transpose();
    out.col(1).head<3>() += p;
    for (int j = 0; j < 3; ++j) {
        out.col(2 + j).head<3>() += second.segment<3>(3 + 3 * j).transpose();
        out.col(2 + j).tail<3>() += Vector3d::Unit(j).cross(p);
    }
    for (int j = 0; j < 6; ++j)
        out.col(5 + j).tail<3>() += applyInertiaBasis(j, theta) - first.segment<3>(6 + 3 * j).transpose();
}

/// A constant wrench or a constant offset of a sensor tells nothing about the mount.
void removeMeans(RunEquations& equations) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> mean =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, equations.columns.cols());
    for (int n = 0; n < equations.outputs; ++n) mean += equations.columns.middleRows<6>(6L * n);
    mean /= std::max(1, equations.outputs);
    for (int n = 0; n < equations.outputs; ++n) equations.columns.middleRows<6>(6L * n) -= mean;
}

AxisHistory makeAxisHistory(const RunMotion& motion, const MountModel& model, const RelativeHistory& relative,
                            int axis) {
    constexpr double reach = 0.25;  // of the largest displacement: no stop of interest is closer
    AxisHistory history;
    const auto q = relative.q.col(axis);
    history.largest = q.maxCoeff();
    history.smallest = q.minCoeff();
    for (Eigen::Index k = 0; k < q.size(); ++k) {
        if (q(k) < reach * std::max(0.0, history.largest) && q(k) > reach * std::min(0.0, history.smallest)) continue;
        history.sample.push_back(static_cast<int>(k));
        history.q.push_back(q(k));
        history.v.push_back(relative.v(k, axis));
    }
    const Eigen::Index count = history.sample.size();
    history.pattern.resize(6, count);
    const Vector3d& position = model.connections[axis / 3].position;
    for (Eigen::Index n = 0; n < count; ++n) {
        const int k = history.sample[n];
        const Vector3d lever = rotationFromVector(motion.mobile.theta.col(k)) * position;
        const Vector3d direction = rotationFromVector(motion.fixed.theta.col(k)).col(axis % 3);
        history.pattern.col(n) << direction, lever.cross(direction);
    }
    return history;
}

}  // namespace

Eigen::Matrix<double, 9, 1> calcMoments(const MobileBody& body) {
    const Vector3d& c = body.center_of_gravity;
    const Matrix3d about_origin =
        body.inertia + body.mass * (c.squaredNorm() * Matrix3d::Identity() - c * c.transpose());
    Eigen::Matrix<double, 9, 1> moments;
    moments.head<3>() = body.mass * c;
    for (int j = 0; j < 6; ++j) moments(3 + j) = about_origin(inertia_rows.at(j), inertia_columns.at(j));
    return moments;
}

Eigen::VectorXd makeCoefficients(const ColumnLayout& layout, const MountModel& model) {
    Eigen::VectorXd coefficients = Eigen::VectorXd::Zero(layout.count());
    coefficients(layout.known()) = 1;
    if (layout.free_body) {
        coefficients(layout.mass()) = model.body.mass;
        coefficients.segment<9>(layout.firstMoment(0)) = calcMoments(model.body);
    }
    for (int axis = 0; axis < layout.axes; ++axis) {
        const AxisLaw& law = model.connections[axis / 3].axis.at(axis % 3);
        coefficients(layout.stiffness(axis)) = law.stiffness;
        coefficients(layout.damping(axis)) = law.damping;
    }
    return coefficients;
}

RunEquations makeEquations(const RunMotion& motion, const MountModel& model, const TestFunction& test_function,
                           bool free_body) {
    const RelativeHistory relative = calcRelativeHistory(motion, model);
    const LawHistory laws = calcLawHistory(model, relative, motion.time);
    const SampleRows rows(motion, model, relative, laws);
    const int axes = static_cast<int>(relative.q.cols()), samples = static_cast<int>(motion.time.size());
    const int stride = test_function.stride(), taps = 2 * test_function.half() + 1;

    RunEquations equations{{axes, free_body}, test_function, test_function.outputCount(samples), {}, {}};
    const ColumnLayout& layout = equations.layout;
    equations.columns.resize(6L * equations.outputs, layout.count());
    Eigen::Matrix<double, 10, 1> body;
    body << model.body.mass, calcMoments(model.body);

    constexpr int block = 256;  // outputs worked on at a time, so that their samples stay in the cache
    RowMatrix value, first, second;
    Eigen::RowVectorXd value_mean(rows.valueSize()), first_mean(rows.firstSize()),
        second_mean(SampleRows::secondSize());
    Eigen::Matrix<double, 6, Eigen::Dynamic> out(6, 11 + 2 * axes);
    for (int start = 0; start < equations.outputs; start += block) {
        const int stop = std::min(start + block, equations.outputs);
        const int begin = start * stride, count = (stop - 1 - start) * stride + taps;
        value.resize(count, rows.valueSize());
        first.resize(count, rows.firstSize());
        second.resize(count, SampleRows::secondSize());
        for (int k = 0; k < count; ++k)
            rows.fill(begin + k, value.row(k).data(), first.row(k).data(), second.row(k).data());
        for (int n = start; n < stop; ++n) {
            value_mean.setZero();
            first_mean.setZero();
            second_mean.setZero();
            for (int j = 0; j < taps; ++j) {
                const int k = (n - start) * stride + j;
                const std::size_t tap = j;
                value_mean.noalias() += test_function.value()[tap] * value.row(k);
                first_mean.noalias() += test_function.first()[tap] * first.row(k);
                if (!motion.mobile.acceleration_measured)
                    second_mean.noalias() += test_function.second()[tap] * second.row(k);
            }
            assembleOutput(motion.mobile.acceleration_measured, axes, value_mean, first_mean, second_mean, out);
            auto target = equations.columns.middleRows<6>(6L * n);
            if (free_body) {
                target = out;
            } else {
                target.col(0) = out.col(0) + out.middleCols<10>(1) * body;
                target.rightCols(2 * axes) = out.rightCols(2 * axes);
            }
        }
    }
    removeMeans(equations);
    for (int axis = 0; axis < axes; ++axis) {
        const bool stopped = !model.connections[axis / 3].axis.at(axis % 3).stops.empty();
        equations.axes.push_back(stopped ? makeAxisHistory(motion, model, relative, axis) : AxisHistory{});
    }
    return equations;
}

StopColumn makeStopColumn(const AxisHistory& history, const TestFunction& test_function, int outputs, const Stop& stop,
                          double offset) {
    const double side = stop.side == Side::positive ? 1 : -1;
    const int stride = test_function.stride(), last_tap = 2 * test_function.half();
    struct Contact {
        int sample;
        Eigen::Index index;
        double value, slope;
    };
    std::vector<Contact> contacts;
    StopColumn column;
    for (std::size_t n = 0; n < history.sample.size(); ++n) {
        const double penetration = side * (history.q[n] + offset) - stop.clearance;
        const double factor = std::max(0.0, 1 + stop.dissipation * side * history.v[n]);
        if (penetration <= 0 || factor <= 0) continue;
        const int sample = history.sample[n];
        contacts.push_back({sample, static_cast<Eigen::Index>(n), side * penetration * factor, -side * factor});
        const int first = std::max(0, (sample - last_tap + stride - 1) / stride),
                  last = std::min(outputs - 1, sample / stride);
        for (int output = std::max(first, column.output.empty() ? 0 : column.output.back() + 1); output <= last;
             ++output)
            column.output.push_back(output);
    }
    const Eigen::Index count = column.output.size();
    column.value.setZero(6, count);
    column.slope.setZero(6, count);
    column.contact_share = static_cast<double>(contacts.size()) / std::max(1, outputs * stride);
    std::size_t slot = 0;
    for (const Contact& contact : contacts) {
        const int first = std::max(0, (contact.sample - last_tap + stride - 1) / stride);
        while (slot < column.output.size() && column.output[slot] < first) ++slot;
        for (std::size_t n = slot; n < column.output.size() && column.output[n] * stride <= contact.sample; ++n) {
            const double tap = test_function.value()[contact.sample - column.output[n] * stride];
            column.value.col(n) += tap * contact.value * history.pattern.col(contact.index);
            column.slope.col(n) += tap * contact.slope * history.pattern.col(contact.index);
        }
    }
    if (count > 0 && outputs > 0) {
        column.value_mean = column.value.rowwise().sum() / outputs;
        column.slope_mean = column.slope.rowwise().sum() / outputs;
    }
    return column;
}

void transform(StopColumn& column, const Matrix6d& transform) {
    column.value = transform * column.value;
    column.slope = transform * column.slope;
    column.value_mean = transform * column.value_mean;
    column.slope_mean = transform * column.slope_mean;
}

StopProducts multiply(const StopColumn& a, const StopColumn& b, int outputs) {
    StopProducts sum;
    std::size_t i = 0, j = 0;
    while (i < a.output.size() && j < b.output.size()) {
        if (a.output[i] < b.output[j]) {
            ++i;
        } else if (a.output[i] > b.output[j]) {
            ++j;
        } else {
            const auto ka = static_cast<Eigen::Index>(i++), kb = static_cast<Eigen::Index>(j++);
            sum.value_value += a.value.col(ka).dot(b.value.col(kb));
            sum.value_slope += a.value.col(ka).dot(b.slope.col(kb));
            sum.slope_value += a.slope.col(ka).dot(b.value.col(kb));
            sum.slope_slope += a.slope.col(ka).dot(b.slope.col(kb));
        }
    }
    sum.value_value -= outputs * a.value_mean.dot(b.value_mean);
    sum.value_slope -= outputs * a.value_mean.dot(b.slope_mean);
    sum.slope_value -= outputs * a.slope_mean.dot(b.value_mean);
    sum.slope_slope -= outputs * a.slope_mean.dot(b.slope_mean);
    return sum;
}

}  // namespace wems::identify
