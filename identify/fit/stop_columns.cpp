#include "identify/fit/stop_columns.hpp"

#include <algorithm>

namespace wems::identify {

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
