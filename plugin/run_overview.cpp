#include "plugin/run_overview.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/common/format_number.hpp"
#include "models/report/html_report.hpp"

namespace wems::plugin {

RunOverview::RunOverview(const Recording& header, std::size_t samples)
    : length_(samples / most_stretches + 1), present_(header.channels.size()) {
    for (const Channel& channel : header.channels) channels_.push_back({channel.name, {}, {}});
}

void RunOverview::add(const Recording& rows) {
    std::vector<double> values(channels_.size());
    for (std::size_t k = 0; k < rows.time.size(); ++k) {
        for (std::size_t c = 0; c < channels_.size(); ++c) values[c] = rows.channels[c].values[k];
        add(rows.time[k], values);
    }
}

void RunOverview::add(double time, const std::vector<double>& values) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
        const Extreme sample{time, values[c]};
        Stretch& stretch = present_[c];
        if (filled_ == 0) stretch = {sample, sample};
        if (sample.value < stretch.lowest.value) stretch.lowest = sample;
        if (sample.value > stretch.highest.value) stretch.highest = sample;
    }
    if (++filled_ < length_) return;
    for (std::size_t c = 0; c < channels_.size(); ++c) close(c);
    filled_ = 0;
}

void RunOverview::close(std::size_t channel) {
    auto [first, last] = std::pair(present_[channel].lowest, present_[channel].highest);
    if (first.time > last.time) std::swap(first, last);
    ThinnedChannel& target = channels_[channel];
    const auto append = [&target](const Extreme& extreme) {
        target.time.push_back(extreme.time);
        target.values.push_back(extreme.value);
    };
    append(first);
    if (last.time > first.time) append(last);
}

const ThinnedChannel* RunOverview::find(const std::string& name) const {
    const auto found = std::find_if(channels_.begin(), channels_.end(),
                                    [&](const ThinnedChannel& channel) { return channel.name == name; });
    return found == channels_.end() ? nullptr : &*found;
}

namespace {

constexpr double kStill = 1e-4;         // of the largest: an axis that moves less has nothing to show
constexpr double kMostStretches = 400;  // of an envelope

Recording makeNames(const MountModel& model) {
    Recording names;
    for (const char* quantity : {"relative.", "force."})
        for (const Connection& connection : model.connections)
            for (const char* axis : kAxes) {
                Channel channel;
                channel.name = quantity + connection.name + "." + axis;
                names.channels.push_back(std::move(channel));
            }
    return names;
}

std::string atFrequency(const Drive& drive, double time) {
    const double hertz = drive.calcFrequency(time);
    return std::isfinite(hertz) ? " at " + formatNumber(hertz, 4) + " Hz" : "";
}

/// Largest magnitude of each stretch, which is a period or longer.
Series makeEnvelope(const std::string& name, const ThinnedChannel& channel, const Drive& drive, double factor) {
    Series series{name, {}, {}};
    const std::size_t count = channel.values.size();
    if (count == 0) return series;
    const double shortest = (channel.time.back() - channel.time.front()) / kMostStretches;
    for (std::size_t from = 0; from < count;) {
        const double length = std::max(shortest, 1 / drive.calcFrequency(channel.time[from]));
        std::size_t best = from, to = from;
        for (; to < count && channel.time[to] - channel.time[from] <= length; ++to)
            if (std::abs(channel.values[to]) > std::abs(channel.values[best])) best = to;
        series.x.push_back(channel.time[best]);
        series.y.push_back(factor * std::abs(channel.values[best]));
        from = to;
    }
    return series;
}

}  // namespace

bool isSwept(const Drive& drive) {
    const double start = drive.calcFrequency(0), end = drive.calcFrequency(drive.duration());
    return std::isfinite(start) && start != end;
}

ConnectionOverview::ConnectionOverview(const MountModel& model, std::size_t samples)
    : model_(model),
      history_(makeNames(model), samples),
      row_(6 * model.connections.size()),
      axes_(3 * model.connections.size()) {}

void ConnectionOverview::add(double time, const DeviceMotion& motion) {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
        const auto connection = i / 3;
        const Eigen::Index axis = i % 3;
        const double q = motion.relative[connection].q[axis];
        const double f = motion.force(axis, connection);
        row_[i] = q;
        row_[axes_.size() + i] = f;
        AxisExtremes& extremes = axes_[i];
        if (q < extremes.lowest) {
            extremes.lowest = q;
            extremes.lowest_time = time;
        }
        if (q > extremes.highest) {
            extremes.highest = q;
            extremes.highest_time = time;
        }
        if (std::abs(f) > std::abs(extremes.largest_force)) extremes.largest_force = f;
        farthest_ = std::max(farthest_, std::abs(q));
        strongest_ = std::max(strongest_, std::abs(f));
    }
    history_.add(time, row_);
}

bool ConnectionOverview::moves(std::size_t axis) const {
    return axes_[axis].largest() > kStill * farthest_ || std::abs(axes_[axis].largest_force) > kStill * strongest_;
}

std::string ConnectionOverview::nameAxis(std::size_t axis) const {
    return model_.connections[axis / 3].name + "." + kAxes[axis % 3];
}

std::vector<ConnectionOverview::Margin> ConnectionOverview::listMargins(std::size_t axis) const {
    const AxisLaw& law = model_.connections[axis / 3].axis[axis % 3];
    std::vector<Margin> margins;
    for (const Stop& stop : law.stops) {
        const bool positive = stop.side == Side::positive;
        const double reach = positive ? axes_[axis].highest + law.offset : -(axes_[axis].lowest + law.offset);
        margins.push_back({nameAxis(axis) + (positive ? ".+" : ".-"), stop.clearance - reach,
                           (positive ? axes_[axis].highest_time : axes_[axis].lowest_time)});
    }
    return margins;
}

std::string ConnectionOverview::makeHeadline(const Drive& drive) const {
    Margin least;
    least.left = INFINITY;
    std::size_t strongest = 0;
    for (std::size_t i = 0; i < axes_.size(); ++i) {
        if (std::abs(axes_[i].largest_force) > std::abs(axes_[strongest].largest_force)) strongest = i;
        for (const Margin& margin : listMargins(i))
            if (margin.left < least.left) least = margin;
    }
    std::string text;
    if (!std::isfinite(least.left)) {
        text = "The connections move by up to " + formatNumber(1e3 * farthest_, 3) + " mm";
    } else if (least.left < 0) {
        text = "Stop " + least.stop + " is pressed by " + formatNumber(-1e3 * least.left, 3) + " mm" +
               atFrequency(drive, least.time);
    } else {
        text = "No stop is reached: " + formatNumber(1e3 * least.left, 3) + " mm are left at " + least.stop +
               ", the least of all";
    }
    return text + "; the largest force is " + formatNumber(std::abs(axes_[strongest].largest_force), 3) + " N at " +
           nameAxis(strongest) + ".";
}

Table ConnectionOverview::makeTable(const Drive& drive) const {
    Table table({"connection", "lowest [mm]", "highest [mm]", "largest at [Hz]", "largest force [N]", "left at - [mm]",
                 "left at + [mm]"});
    for (std::size_t i = 0; i < axes_.size(); ++i) {
        if (!moves(i)) continue;
        std::string left[2] = {"-", "-"};
        for (const Margin& margin : listMargins(i))
            left[margin.stop.back() == '+' ? 1 : 0] = formatNumber(1e3 * margin.left, 4);
        table.addRow({nameAxis(i), formatNumber(1e3 * axes_[i].lowest, 4), formatNumber(1e3 * axes_[i].highest, 4),
                      formatNumber(drive.calcFrequency(axes_[i].largestTime()), 4),
                      formatNumber(axes_[i].largest_force, 4), left[0], left[1]});
    }
    return table;
}

void ConnectionOverview::addPictures(HtmlReport& report, const Drive& drive, double time_offset) const {
    const bool swept = isSwept(drive);
    for (const bool force : {false, true}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            Plot plot;
            const std::string quantity =
                std::string(force ? "onnection force " : "elative displacement ") + kAxes[axis];
            plot.title = swept ? (force ? "Envelope: c" : "Envelope: r") + quantity : (force ? "C" : "R") + quantity;
            plot.x_label = swept ? "swept frequency [Hz]" : "time [s]";
            plot.y_label = force ? "force [N]" : "relative displacement [mm]";
            for (std::size_t c = 0; c < model_.connections.size(); ++c) {
                if (!moves(3 * c + axis)) continue;
                const std::string& name = model_.connections[c].name;
                const ThinnedChannel* channel =
                    history_.find((force ? "force." : "relative.") + name + "." + kAxes[axis]);
                if (channel == nullptr) continue;
                const double factor = force ? 1 : 1e3;
                Series series{name, channel->time, channel->values};
                if (swept) series = makeEnvelope(name, *channel, drive, factor);
                for (double& x : series.x) x = swept ? drive.calcFrequency(x) : x + time_offset;
                if (!swept)
                    for (double& y : series.y) y *= factor;
                plot.series.push_back(std::move(series));
            }
            if (!plot.series.empty()) report.addPlot(plot);
        }
    }
}

}  // namespace wems::plugin
