#include "identify/forward/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/motion.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {

namespace {

/// Half octaves from the lowest swept frequency up; fewer than a hundred samples make no band.
std::vector<BandError> makeBands(const Eigen::VectorXd& frequency) {
    std::vector<BandError> bands;
    double lowest = std::numeric_limits<double>::infinity(), highest = 0;
    for (const double f : frequency) {
        if (!(f > 0)) continue;
        lowest = std::min(lowest, f);
        highest = std::max(highest, f);
    }
    if (!(highest > lowest)) return bands;
    const double octaves = std::log2(highest / lowest);
    const int count = std::max(1, static_cast<int>(std::lround(2 * octaves)));
    for (int i = 0; i < count; ++i)
        bands.push_back({lowest * std::exp2(octaves * i / count), lowest * std::exp2(octaves * (i + 1) / count), 0});
    bands.back().to = highest;
    return bands;
}

std::size_t findBand(const std::vector<BandError>& bands, double frequency) {
    std::size_t band = 0;
    while (band < bands.size() && frequency >= bands[band].to) ++band;
    return band < bands.size() || bands.empty() || frequency > bands.back().to ? band : bands.size() - 1;
}

/// Errors of one channel, or of all together.
struct Sums {
    explicit Sums(std::size_t bands) : band(bands) {}
    void add(const Sums& other) {
        all.add(other.all);
        free.add(other.free);
        contact.add(other.contact);
        for (std::size_t i = 0; i < band.size(); ++i) band[i].add(other.band[i]);
    }
    ErrorSum all, free, contact;
    std::vector<ErrorSum> band;
};

std::vector<BandError> evaluateBands(const Sums& sums, std::vector<BandError> bands) {
    std::vector<BandError> found;
    for (std::size_t i = 0; i < bands.size(); ++i) {
        if (sums.band[i].empty()) continue;
        bands[i].error = sums.band[i].value();
        found.push_back(bands[i]);
    }
    return found;
}

std::optional<double> evaluate(const ErrorSum& sum) {
    if (sum.empty()) return std::nullopt;
    return sum.value();
}

/// The measured samples that are compared.
struct Window {
    std::size_t first, count;
};

Window findWindow(const RelativeDisplacement& measured, const RelativeDisplacement& simulated) {
    const double rounding = 1e-6 * measured.interval();
    const auto first = std::lower_bound(measured.time.begin(), measured.time.end(), simulated.time.front() - rounding);
    const auto last = std::upper_bound(measured.time.begin(), measured.time.end(), simulated.time.back() + rounding);
    const auto describe = [](const RelativeDisplacement& side) {
        return formatNumber(side.time.front(), 6) + " to " + formatNumber(side.time.back(), 6) + " s";
    };
    if (last - first < 2)
        throw InputError({simulated.file, 0, "time"},
                         "covers " + describe(simulated) + ", the measured recording " + describe(measured),
                         "recordings whose times overlap");
    return {static_cast<std::size_t>(first - measured.time.begin()), static_cast<std::size_t>(last - first)};
}

std::vector<std::string> collectNotes(const RelativeDisplacement& measured, const RelativeDisplacement& simulated,
                                      const Window& window) {
    std::vector<std::string> notes;
    for (const auto* side : {&measured, &simulated})
        for (const auto& note : side->notes) notes.push_back(side->file + ": " + note);
    if (window.count < measured.time.size() || simulated.time.back() > measured.time.back() + simulated.interval() ||
        simulated.time.front() < measured.time.front() - simulated.interval())
        notes.push_back("the time ranges differ: compared from " + formatNumber(measured.time[window.first], 6) +
                        " to " + formatNumber(measured.time[window.first + window.count - 1], 6) + " s");
    if (std::abs(simulated.interval() / measured.interval() - 1) > 1e-6)
        notes.push_back("the sample rates differ (" + formatNumber(1 / measured.interval(), 6) + " and " +
                        formatNumber(1 / simulated.interval(), 6) + " Hz): the simulated recording is interpolated");
    for (const auto& name : simulated.names) {
        if (std::find(measured.names.begin(), measured.names.end(), name) == measured.names.end())
            notes.push_back(name + " was simulated but not measured: left out");
    }
    return notes;
}

/// What was done, as a note.
std::string removeSlowMotionOfBoth(RelativeDisplacement& measured, RelativeDisplacement& simulated) {
    const double lowest = measured.lowest_frequency > 0 ? measured.lowest_frequency : simulated.lowest_frequency;
    if (!(lowest > 0))
        throw InputError({measured.file, 0, "load"},
                         "only accelerations were recorded, and the lowest excited frequency cannot be told",
                         "a load or base channel, or displacements");
    removeSlowMotion(measured, lowest);
    removeSlowMotion(simulated, lowest);
    return "only accelerations were recorded: displacements are compared above " + formatNumber(0.9 * lowest, 3) +
           " Hz";
}

/// The simulated row at the measured times of the window.
Eigen::VectorXd interpolateRow(const RelativeDisplacement& simulated, Eigen::Index row, const std::vector<double>& time,
                               const Window& window) {
    const Eigen::RowVectorXd values = simulated.q.row(row);
    const std::vector<double> samples(values.begin(), values.end());
    const double interval = simulated.interval();
    Eigen::VectorXd result(window.count);
    for (std::size_t k = 0; k < window.count; ++k) {
        const double position = (time[window.first + k] - simulated.time.front()) / interval;
        const auto nearest = static_cast<std::size_t>(std::lround(std::max(0.0, position)));
        if (nearest < samples.size() && std::abs(position - static_cast<double>(nearest)) < 1e-6) {
            result[k] = samples[nearest];
        } else {
            const auto below = std::min(static_cast<std::size_t>(std::max(0.0, position)), samples.size() - 2);
            result[k] = interpolateCubic(simulated.time, samples, below, time[window.first + k]);
        }
    }
    return result;
}

Eigen::Index findRow(const RelativeDisplacement& simulated, const std::string& name) {
    const auto at = std::find(simulated.names.begin(), simulated.names.end(), name);
    if (at == simulated.names.end())
        throw InputError({simulated.file, 0, "mobile." + name},
                         "this channel of the measured recording is missing in the simulated one",
                         "every axis of every connection that was measured");
    return at - simulated.names.begin();
}

}  // namespace

double ErrorSum::value() const {
    return empty() ? std::numeric_limits<double>::quiet_NaN() : std::sqrt(difference_ / reference_);
}

std::vector<bool> findContact(const Eigen::MatrixXd& q, const MountModel& model) {
    std::vector<bool> touched(q.cols(), false);
    const Eigen::VectorXd rest = calcRestDisplacement(model);
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Eigen::Index row = 3 * i + axis;
            const AxisLaw& law = model.connections[i].axis[axis];
            for (const Stop& stop : law.stops) {
                const double direction = stop.side == Side::positive ? 1 : -1;
                const double threshold = stop.clearance - direction * (law.offset + rest[row]);
                for (Eigen::Index k = 0; k < q.cols(); ++k)
                    if (direction * q(row, k) > threshold) touched[k] = true;
            }
        }
    }
    return touched;
}

Comparison compare(RelativeDisplacement measured, RelativeDisplacement simulated, const MountModel* model) {
    Comparison result;
    const Window window = findWindow(measured, simulated);
    result.from = measured.time[window.first];
    result.to = measured.time[window.first + window.count - 1];
    result.notes = collectNotes(measured, simulated, window);
    std::vector<bool> touched;
    if (measured.from_accelerations || simulated.from_accelerations) {
        // The rest position is not known to the width of a gap then, so that there are no regimes.
        result.notes.push_back(removeSlowMotionOfBoth(measured, simulated));
    } else if (model != nullptr) {
        touched = findContact(measured.q, *model);
    }

    const auto first = static_cast<Eigen::Index>(window.first), count = static_cast<Eigen::Index>(window.count);
    result.time.assign(measured.time.begin() + first, measured.time.begin() + first + count);
    result.swept_frequency = measured.swept_frequency.segment(first, count);
    result.measured = measured.q.middleCols(first, count);
    result.simulated.resize(result.measured.rows(), count);
    const std::vector<BandError> bands = makeBands(measured.swept_frequency);
    Sums total(bands.size());
    for (std::size_t channel = 0; channel < measured.names.size(); ++channel) {
        const Eigen::Index row = channel;
        const Eigen::VectorXd values =
            interpolateRow(simulated, findRow(simulated, measured.names[channel]), measured.time, window);
        result.simulated.row(row) = values.transpose();
        Sums sums(bands.size());
        for (std::size_t k = 0; k < window.count; ++k) {
            const std::size_t sample = window.first + k;
            const double reference = measured.q(row, sample);
            const double difference = values[k] - reference;
            sums.all.add(difference, reference);
            if (!touched.empty()) (touched[sample] ? sums.contact : sums.free).add(difference, reference);
            const std::size_t band = findBand(bands, measured.swept_frequency[sample]);
            if (band < bands.size()) sums.band[band].add(difference, reference);
        }
        total.add(sums);
        const double rms = std::sqrt(sums.all.referenceSquares() / static_cast<double>(window.count));
        result.channels.push_back({measured.names[channel], sums.all.value(), rms, sums.all.differenceSquares(),
                                   evaluateBands(sums, bands), evaluate(sums.free), evaluate(sums.contact)});
    }
    const double squares = total.all.differenceSquares();
    for (ChannelError& channel : result.channels) channel.share = squares > 0 ? channel.share / squares : 0;
    result.error = total.all.value();
    result.bands = evaluateBands(total, bands);
    result.free = evaluate(total.free);
    result.contact = evaluate(total.contact);
    return result;
}

namespace {

// Steps for each that the forward model takes for speed. Base sweeps deep into the stops, whose motion amplifies errors
// up to 400 times: 2e-3 to 1.4e-1 of the displacement became 2e-5 to 1e-3.
constexpr int finer = 3;

TimeGrid makeFineGrid(const RunMotion& run, const MountModel& model, int refinement) {
    TimeGrid grid = makeGrid(run, model);
    grid.steps_per_sample *= finer * refinement;
    return grid;
}

/// Adds what integrating the accelerations at the samples gives beside the displacement itself.
void addFolded(RelativeDisplacement& simulated, const MarkerMotion& markers, bool fixed_too) {
    // Below what comparisons leave, so that the high pass of the integration is not seen.
    const double lowest = 0.6 * simulated.lowest_frequency;
    for (Eigen::Index i = 0; i < simulated.q.rows(); ++i) {
        Eigen::VectorXd acceleration = markers.mobile_acceleration.row(i);
        Eigen::VectorXd displacement = markers.mobile_displacement.row(i);
        if (fixed_too) {
            acceleration -= markers.fixed_acceleration.row(i).transpose();
            displacement -= markers.fixed_displacement.row(i).transpose();
        }
        simulated.q.row(i) += integrateTwice(acceleration, simulated.interval(), lowest).x - displacement;
    }
}

}  // namespace

PreparedRun prepareRun(const RunMotion& run, const MountModel& model, double lowest_frequency, int refinement) {
    PreparedRun prepared{
        Drive::make(run, model, makeFineGrid(run, model, refinement)), calcRelativeDisplacement(run, model), {}, false};
    prepared.start = findStartMotion(run, model, prepared.drive);
    prepared.measured.lowest_frequency = lowest_frequency;
    prepared.fixed_integrated = run.fixed_trusted_from > 0;
    if (prepared.measured.from_accelerations) removeSlowMotion(prepared.measured, lowest_frequency);
    return prepared;
}

RelativeDisplacement simulateRun(const MountModel& model, const PreparedRun& run) {
    const ForwardModel forward(model);
    RelativeDisplacement simulated;
    simulated.file = run.measured.file;
    simulated.time = run.measured.time;
    simulated.names = run.measured.names;
    const ForwardState initial = makeInitialState(forward, run.start, run.drive);
    const bool integrated = run.measured.from_accelerations;
    const Simulation simulation = forward.simulate(run.drive, initial, 0, run.drive.grid().samples,
                                                   integrated ? Keep::states : Keep::displacement);
    simulated.q = simulation.q.colwise() - forward.restDisplacement();
    simulated.lowest_frequency = run.measured.lowest_frequency;
    if (integrated) {
        addFolded(simulated, forward.calcMarkers(simulation, run.drive), run.fixed_integrated);
        removeSlowMotion(simulated, simulated.lowest_frequency);
    }
    return simulated;
}

ErrorSum calcSimulationError(const MountModel& model, const PreparedRun& run) {
    const Eigen::MatrixXd q = simulateRun(model, run).q;
    ErrorSum sum;
    for (Eigen::Index k = 0; k < q.cols(); ++k)
        for (Eigen::Index i = 0; i < q.rows(); ++i) sum.add(q(i, k) - run.measured.q(i, k), run.measured.q(i, k));
    return sum;
}

}  // namespace wems::identify
