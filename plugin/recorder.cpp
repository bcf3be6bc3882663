#include "plugin/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace wems::plugin {

double getNoiseLevel(const SensorNoise& noise, const ChannelName& name) {
    if (name.part == Part::load) return noise.load;
    if (name.part == Part::base) return noise.base;
    if (name.derivative == Derivative::velocity) return noise.velocity;
    return name.derivative == Derivative::acceleration ? noise.acceleration : noise.displacement;
}

namespace {

std::mt19937_64 makeGenerator(std::uint64_t seed, const ChannelName& name) {
    std::vector<std::uint32_t> material{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U)};
    for (const char letter : formatChannelName(name)) material.push_back(static_cast<unsigned char>(letter));
    std::seed_seq sequence(material.begin(), material.end());
    return std::mt19937_64(sequence);
}

}  // namespace

ChannelNoise::ChannelNoise(const SensorNoise& noise, std::uint64_t seed, const ChannelName& name)
    : present_(getNoiseLevel(noise, name) > 0),
      generator_(makeGenerator(seed, name)),
      normal_(0, present_ ? getNoiseLevel(noise, name) : 1) {}

void ChannelNoise::add(std::vector<double>& values) {
    if (!present_) return;
    for (double& value : values) value += normal_(generator_);
}

namespace {

class RecorderReporter : public SimTK::ScheduledEventReporter {
public:
    explicit RecorderReporter(Recorder& recorder) : recorder_(recorder) {}
    void handleEvent(const SimTK::State& state) const override { recorder_.takeSample(state); }
    SimTK::Real getNextEventTime(const SimTK::State& state, bool include_current) const override {
        return recorder_.findNextTime(state.getTime(), include_current);
    }

private:
    Recorder& recorder_;
};

const Eigen::Vector3d& pickVector(const DeviceMotion& motion, const ChannelName& name, std::size_t connection) {
    if (name.part == Part::load) return motion.load;
    if (name.part == Part::base) return motion.base;
    const PointMotion& point = name.part == Part::mobile ? motion.mobile[connection] : motion.fixed[connection];
    if (name.derivative == Derivative::velocity) return point.velocity;
    return name.derivative == Derivative::acceleration ? point.acceleration : point.displacement;
}

}  // namespace

std::vector<SensorChannel> makeSensorChannels(const MountModel& model, const ChannelSelection& selection, bool has_load,
                                              bool has_base) {
    std::vector<Derivative> derivatives;
    if (selection.displacement) derivatives.push_back(Derivative::displacement);
    if (selection.velocity) derivatives.push_back(Derivative::velocity);
    if (selection.acceleration) derivatives.push_back(Derivative::acceleration);

    std::vector<SensorChannel> channels;
    const auto addTriax = [&](Part part, const std::string& connection, Derivative derivative) {
        for (int axis = 0; axis < 3; ++axis) {
            SensorChannel channel;
            channel.name = {part, connection, axis, derivative};
            channel.reading = readingOf(model.sensors, formatChannelName(channel.name));
            channels.push_back(channel);
        }
    };
    for (const Part part : {Part::mobile, Part::fixed})
        for (const Connection& connection : model.connections)
            for (const Derivative derivative : derivatives) addTriax(part, connection.name, derivative);
    if (has_load) addTriax(Part::load, "", Derivative::force);
    if (has_base) addTriax(Part::base, "", Derivative::acceleration);
    return channels;
}

Recorder::Recorder(const Device& device, std::vector<SensorChannel> channels, SampleTimes times, RowTaker take)
    : device_(device),
      channels_(std::move(channels)),
      times_(std::move(times)),
      take_(std::move(take)),
      values_(channels_.size()) {
    std::set<double> delays{0.0};  // the true motion itself is watched at every row
    for (const SensorChannel& channel : channels_) delays.insert(channel.reading.delay);
    for (const double delay : delays) {
        if (delay == 0) undelayed_ = cursors_.size();
        cursors_.push_back({delay});
    }
    for (const SensorChannel& channel : channels_) {
        delay_of_channel_.push_back(std::distance(delays.begin(), delays.find(channel.reading.delay)));
        connection_of_channel_.push_back(
            channel.name.connection.empty()
                ? 0
                : static_cast<std::size_t>(device.model().connectionIndex(channel.name.connection)));
    }

    for (int i = 0; i < static_cast<int>(device.model().connections.size()); ++i) {
        for (int axis = 0; axis < 3; ++axis) {
            largest_.push_back({i, axis, 0, 0});
            const AxisLaw& law = device.model().connections[i].axis[axis];
            for (std::size_t stop = 0; stop < law.stops.size(); ++stop) {
                StopContact contact;
                contact.connection = i;
                contact.axis = axis;
                contact.stop = stop;
                contacts_.push_back(contact);
            }
        }
    }
}

double Recorder::endTime() const {
    return times_.empty() ? 0 : std::max(0.0, times_.back() - cursors_.front().delay);
}

SimTK::ScheduledEventReporter* Recorder::makeReporter() {
    return new RecorderReporter(*this);
}

double Recorder::findTime(const Cursor& cursor) const {
    return cursor.row == times_.size() ? SimTK::Infinity : std::max(0.0, times_[cursor.row] - cursor.delay);
}

const Recorder::Cursor& Recorder::findNext() const {
    return *std::min_element(cursors_.begin(), cursors_.end(),
                             [this](const Cursor& a, const Cursor& b) { return findTime(a) < findTime(b); });
}

double Recorder::findNextTime(double time, bool include_current) const {
    double next = SimTK::Infinity;
    for (Cursor cursor : cursors_) {
        // Rows before the start of a delayed sensor share one time; a few rows further there is another.
        while (cursor.row < times_.size() && (include_current ? findTime(cursor) < time : findTime(cursor) <= time))
            ++cursor.row;
        next = std::min(next, findTime(cursor));
    }
    return next;
}

void Recorder::takeSample(const SimTK::State& state) {
    const double time = state.getTime();
    if (findTime(findNext()) > time) return;
    const DeviceMotion motion = device_.calcMotion(state);
    for (std::size_t d = 0; d < cursors_.size(); ++d) {
        Cursor& cursor = cursors_[d];
        for (; findTime(cursor) <= time; ++cursor.row) {
            for (std::size_t i = 0; i < channels_.size(); ++i) {
                if (delay_of_channel_[i] != d) continue;
                const SensorChannel& channel = channels_[i];
                const Eigen::Vector3d& vector = pickVector(motion, channel.name, connection_of_channel_[i]);
                values_[i].push_back(channel.reading.gain * channel.reading.R_TS.row(channel.name.axis).dot(vector) +
                                     channel.reading.zero);
            }
            if (d == undelayed_) watchStops(motion, time);
        }
    }
    const auto last = std::min_element(cursors_.begin(), cursors_.end(),
                                       [](const Cursor& a, const Cursor& b) { return a.row < b.row; });
    const std::size_t ready = last->row - taken_;
    if (ready >= block_rows || last->row == times_.size()) handOn(ready);
    if (progress_) progress_(time);
}

void Recorder::handOn(std::size_t rows) {
    if (rows == 0) return;
    std::vector<double> times(rows);
    for (std::size_t k = 0; k < rows; ++k) times[k] = times_[taken_ + k];
    std::vector<std::vector<double>> values;
    for (std::vector<double>& column : values_) {
        const auto end = column.begin() + static_cast<std::ptrdiff_t>(rows);
        values.emplace_back(column.begin(), end);
        column.erase(column.begin(), end);
    }
    taken_ += rows;
    take_(std::move(times), std::move(values));
}

void Recorder::watchStops(const DeviceMotion& motion, double time) {
    if (observer_) observer_(time, motion);
    for (LargestDisplacement& largest : largest_) {
        const double q = motion.relative[largest.connection].q[largest.axis];
        if (std::abs(q) > std::abs(largest.value)) {
            largest.value = q;
            largest.time = time;
        }
    }
    for (StopContact& contact : contacts_) {
        const std::size_t connection = contact.connection;
        const AxisLaw& law = device_.model().connections[connection].axis[contact.axis];
        const Stop& stop = law.stops[contact.stop];
        const double q = motion.relative[connection].q[contact.axis] + law.offset;
        const double penetration = (stop.side == Side::positive ? q : -q) - stop.clearance;
        if (!(penetration > 0)) continue;
        auto& intervals = contact.intervals;
        if (intervals.empty() || time - intervals.back().last > StopContact::longest_pause)
            intervals.push_back({time, time, 0, 0, 0});
        StopContact::Interval& interval = intervals.back();
        if (interval.samples == 0 || interval.last != watched_) ++interval.visits;
        interval.last = time;
        interval.deepest = std::max(interval.deepest, penetration);
        ++interval.samples;
    }
    watched_ = time;
}

}  // namespace wems::plugin
