#include "identify/commands/run_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "identify/forward/compare.hpp"
#include "identify/forward/forward_model.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/motion/spectrum.hpp"
#include "identify/problem/slow_motion.hpp"
#include "identify/verdict/free_error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/sensor_reading.hpp"

namespace wems::identify::commands {

namespace {

/// `4.z`, `4.z.+` and the like.
std::optional<AxisPlace> parsePlace(const std::string& place, const MountModel& model) {
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const AxisPlace candidate{i, axis};
            const std::string name = candidate.name(model);
            if (place == name || place.rfind(name + ".", 0) == 0) return candidate;
        }
    return std::nullopt;
}

}  // namespace

std::string AxisPlace::name(const MountModel& model) const {
    return model.connections[connection].name + "." + kAxes[axis];
}

std::vector<JudgedRun> prepareJudgedRuns(const std::vector<Recording>& recordings, const Diagnosis& diagnosis,
                                         std::size_t most) {
    std::vector<JudgedRun> runs;
    for (std::size_t r = 0; r < std::min(most, recordings.size()); ++r) {
        JudgedRun run{correctChannels(recordings[r], diagnosis.extended.sensors), {}};
        run.motion = estimateMotion(run.recording, diagnosis.extended);
        restoreSlowMotion(run.motion, diagnosis.extended);
        runs.push_back(std::move(run));
    }
    return runs;
}

std::optional<AxisPlace> findNamedAxis(const Diagnosis& diagnosis) {
    std::vector<std::string> places;
    for (const Cause& cause : diagnosis.causes) places.insert(places.end(), cause.where.begin(), cause.where.end());
    places.insert(places.end(), diagnosis.unexplained_where.begin(), diagnosis.unexplained_where.end());
    for (const std::string& place : places)
        if (const auto axis = parsePlace(place, diagnosis.extended)) return axis;
    return std::nullopt;
}

namespace {

constexpr Eigen::Index kWindows = 240;    // along a run
constexpr double kShortestWindow = 1.0;   // periods of the drive
constexpr double kLeastAmplitude = 0.01;  // of an order's largest: below it a phase is that of noise
constexpr double kLeastShare = 2e-3;      // likewise, of the first order's largest
constexpr double kDegrees = 180 / kPi;

/// Relative displacements (rows 3 i + axis, m) of one run; empty where a simulation grew beyond all bounds.
struct Simulated {
    std::string file;
    std::vector<double> time;
    Recording drive;  // with the swept frequency's source at these times
    SweptFrequency swept;
    Eigen::MatrixXd measured, before, after;

    bool sweeps() const { return swept.is_sine && swept.highest > 1.05 * swept.lowest; }
    std::string abscissa() const { return sweeps() ? "swept frequency [Hz]" : "time [s]"; }
};

void addChannels(Recording& recording, const std::string& name, const char* quantity, const Eigen::Matrix3Xd& rows) {
    for (Eigen::Index axis = 0; axis < std::min<Eigen::Index>(3, rows.cols()); ++axis) {
        const Eigen::VectorXd values = rows.row(axis).transpose();
        recording.channels.push_back({name + "." + quantity + "xyz"[axis], "", {values.begin(), values.end()}, 0});
    }
}

/// What may drive the run, at the times of its motion, which need not be the recorded ones.
Recording makeDriveRecording(const RunMotion& motion) {
    Recording recording;
    recording.file = motion.file;
    recording.time = motion.time;
    addChannels(recording, "load", "f", motion.load);
    addChannels(recording, "base", "a", motion.base);
    addChannels(recording, "fixed.origin", "", motion.fixed.p);
    addChannels(recording, "mobile.origin", "", motion.mobile.p);
    return recording;
}

Simulated simulate(const JudgedRun& judged, const MountModel& before, const MountModel& after) {
    const RunMotion& motion = judged.motion;
    Simulated result;
    result.file = motion.file;
    result.time = motion.time;
    result.drive = makeDriveRecording(motion);
    result.swept = findSweptFrequency(result.drive);
    const auto run = [&](const MountModel& model, Eigen::MatrixXd& q) {
        try {
            const PreparedRun prepared = prepareRun(motion, model, result.swept.lowest);
            if (prepared.measured.from_accelerations) result.measured = prepared.measured.q;
            q = simulateRun(model, prepared).q;
        } catch (const SimulationDiverged&) {
            q.resize(0, 0);
        }
    };
    // The channels themselves where they are displacements, as the error is defined.
    result.measured = calcMeasuredRelative(judged.recording, motion, after);
    run(before, result.before);
    run(after, result.after);
    return result;
}

/// Value of some rows in windows along a run.
struct Envelope {
    std::vector<double> at, value;
};

/// In windows of at least a period of the drive.
template <typename Function>
Envelope calcEnvelope(const Simulated& run, const Eigen::MatrixXd& rows, const Function& function) {
    Envelope envelope;
    const Eigen::Index count = rows.cols();
    const double interval = (run.time.back() - run.time.front()) / static_cast<double>(count - 1);
    for (Eigen::Index window = 0; window < kWindows; ++window) {
        const Eigen::Index middle = (2 * window + 1) * count / (2 * kWindows);
        const double hertz = run.swept.hertz.size() == count ? run.swept.hertz[middle] : NAN;
        if (run.sweeps() && !std::isfinite(hertz)) continue;
        const double period = hertz > 0 ? kShortestWindow / hertz : 0;
        const auto length = std::clamp<Eigen::Index>(std::lround(period / interval), count / kWindows + 1, count);
        const Eigen::Index first = std::clamp<Eigen::Index>(middle - length / 2, 0, count - length);
        envelope.at.push_back(run.sweeps() ? hertz : run.time[middle]);
        envelope.value.push_back(function(rows.middleCols(first, length)));
    }
    return envelope;
}

Series makeSeries(const std::string& name, Envelope envelope, int color) {
    return {name, std::move(envelope.at), std::move(envelope.value), false, color};
}

Plot plotError(const Simulated& run, double noise) {
    Plot plot{"Error of the free simulation, all connections and axes",
              run.abscissa(),
              "root mean square [mm]",
              {},
              false,
              true};
    const auto rms = [](const auto& rows) {
        return 1e3 * std::sqrt(rows.squaredNorm() / static_cast<double>(rows.size()));
    };
    const Envelope measured = calcEnvelope(run, run.measured, rms);
    plot.series.push_back(makeSeries("measured motion", measured, kMeasuredColor));
    if (run.before.size() > 0)
        plot.series.push_back(
            makeSeries("error before", calcEnvelope(run, run.before - run.measured, rms), kBeforeColor));
    if (run.after.size() > 0)
        plot.series.push_back(makeSeries("error after", calcEnvelope(run, run.after - run.measured, rms), kAfterColor));
    plot.series.push_back(
        makeSeries("noise alone", {measured.at, std::vector<double>(measured.at.size(), 1e3 * noise)}, kNoiseColor));
    return plot;
}

/// `visit` sees the measured rows and those of the simulations that there are.
template <typename Visitor>
void forEachCurve(const Simulated& run, const Visitor& visit) {
    visit("measured", run.measured, kMeasuredColor);
    if (run.before.size() > 0) visit("before", run.before, kBeforeColor);
    if (run.after.size() > 0) visit("after", run.after, kAfterColor);
}

Plot plotEnvelope(const Simulated& run, const AxisPlace& place, const std::string& name) {
    Plot plot{"Envelope of the motion at " + name, run.abscissa(), "largest displacement [mm]", {}, false};
    const auto peak = [](const auto& row) { return 1e3 * row.cwiseAbs().maxCoeff(); };
    forEachCurve(run, [&](const char* series, const Eigen::MatrixXd& rows, int color) {
        plot.series.push_back(makeSeries(series, calcEnvelope(run, rows.row(place.row()), peak), color));
    });
    return plot;
}

/// A gap where the phase leaves one end of its range and comes in at the other.
Series makePhase(const std::string& name, const OrderTracking& orders, const OrderTrack& track, int order, int color) {
    Series series{name, {}, {}, false, color};
    const auto largest = [&](int of_order) {
        const Eigen::ArrayXd amplitude = track.amplitude.row(of_order).transpose();
        return amplitude.isNaN().select(0, amplitude).maxCoeff();
    };
    const double least = std::max(kLeastAmplitude * largest(order), kLeastShare * largest(0));
    for (Eigen::Index p = 0; p < track.phase.cols(); ++p) {
        const double hertz = orders.hertz[p];
        const double phase = track.amplitude(order, p) >= least ? kDegrees * track.phase(order, p) : NAN;
        if (!series.y.empty() && std::abs(phase - series.y.back()) > 180) {
            series.x.push_back(0.5 * (hertz + series.x.back()));
            series.y.push_back(NAN);
        }
        series.x.push_back(hertz);
        series.y.push_back(phase);
    }
    return series;
}

std::vector<Plot> plotOrders(const Simulated& run, const AxisPlace& place, const std::string& name) {
    Recording recording = run.drive;
    const std::size_t first = recording.channels.size();
    std::vector<int> colors;
    forEachCurve(run, [&](const char* series, const Eigen::MatrixXd& rows, int color) {
        const Eigen::VectorXd q = rows.row(place.row()).transpose();
        recording.channels.push_back({series, "m", {q.begin(), q.end()}, 0});
        colors.push_back(color);
    });
    const OrderTracking orders = trackOrders(recording, run.swept);
    std::vector<Plot> amplitudes, phases;
    for (int order = 0; order < tracked_orders; ++order) {
        const std::string title = "order " + std::to_string(order + 1) + " at " + name;
        Plot amplitude{"Amplitude of " + title, "swept frequency [Hz]", "amplitude [mm]", {}, false, true};
        Plot phase{"Phase of " + title, "swept frequency [Hz]", "phase [deg]", {}, false};
        for (std::size_t i = 0; i < colors.size(); ++i) {
            const OrderTrack& track = orders.tracks[first + i];
            const Eigen::RowVectorXd values = 1e3 * track.amplitude.row(order);
            amplitude.series.push_back({track.channel, orders.hertz, {values.begin(), values.end()}, false, colors[i]});
            phase.series.push_back(makePhase(track.channel, orders, track, order, colors[i]));
        }
        amplitudes.push_back(std::move(amplitude));
        phases.push_back(std::move(phase));
    }
    amplitudes.insert(amplitudes.end(), phases.begin(), phases.end());
    return amplitudes;
}

AxisPlace findLargestMotion(const Eigen::MatrixXd& measured) {
    Eigen::Index row = 0;
    measured.cwiseAbs().rowwise().maxCoeff().maxCoeff(&row);
    return {static_cast<std::size_t>(row / 3), static_cast<std::size_t>(row % 3)};
}

}  // namespace

void addSimulatedRuns(HtmlReport& page, const std::vector<JudgedRun>& runs, const MountModel& before,
                      const MountModel& after, double noise_floor, const std::optional<AxisPlace>& named) {
    std::vector<Simulated> simulated;
    double squares = 0, count = 0;
    for (const JudgedRun& run : runs) {
        simulated.push_back(simulate(run, before, after));
        squares += simulated.back().measured.squaredNorm();
        count += static_cast<double>(simulated.back().measured.size());
    }
    const double noise = noise_floor * std::sqrt(squares / count);
    for (const Simulated& run : simulated) {
        const AxisPlace place = named ? *named : findLargestMotion(run.measured);
        const std::string name = place.name(after);
        page.addHeading("Free simulation of " + run.file);
        if (run.before.size() == 0) page.addText("The simulation with the model as given grew beyond all bounds.");
        if (run.after.size() == 0) page.addText("The simulation with the extended model grew beyond all bounds.");
        page.addPlot(plotError(run, noise));
        page.addPlot(plotEnvelope(run, place, name));
        if (!run.swept.is_sine) continue;
        page.addText("Orders of the motion at " + name + ", phases against the drive:");
        page.addPlots(plotOrders(run, place, name));
    }
}

namespace {

constexpr int kSegment = 512;         // of the spectra, samples
constexpr double kShownLag = 0.2;     // s, of the autocorrelation …
constexpr double kShownOverlaps = 4;  // … and at least
constexpr Eigen::Index kFewest = 64;  // outputs, for spectra and autocorrelation

struct WrenchPart {
    const char *name, *unit, *density_unit;
    int first;  // row
};
constexpr WrenchPart kParts[] = {{"force", "N", "N/√Hz", 0}, {"moment", "N m", "N m/√Hz", 3}};

std::vector<double> listTimes(const RunRemainder& run) {
    std::vector<double> times(run.unexplained.cols());
    for (std::size_t n = 0; n < times.size(); ++n) times[n] = run.start + static_cast<double>(n) * run.interval;
    return times;
}

Plot plotTime(const RunRemainder& run, const WrenchPart& part) {
    Plot plot{std::string("Unexplained ") + part.name, "time [s]", std::string(part.name) + " [" + part.unit + "]", {}};
    const std::vector<double> times = listTimes(run);
    for (int axis = 0; axis < 3; ++axis) {
        const Eigen::VectorXd row = run.unexplained.row(part.first + axis).transpose();
        plot.series.push_back({std::string(1, "xyz"[axis]), times, {row.begin(), row.end()}});
    }
    return plot;
}

/// Of the vector's length: the root of the axes' summed densities.
Series makeSpectrum(const std::string& name, const Eigen::Matrix<double, 6, Eigen::Dynamic>& wrench,
                    const RunRemainder& run, int first, int color) {
    Series series{name, {}, {}, false, color};
    Eigen::VectorXd sum;
    for (int axis = 0; axis < 3; ++axis) {
        const Spectrum spectrum = calcSpectrum(wrench.row(first + axis).transpose(), run.interval, kSegment);
        if (sum.size() == 0) {
            sum = spectrum.density;
            series.x.assign(spectrum.frequency.begin(), spectrum.frequency.end());
        } else {
            sum += spectrum.density;
        }
    }
    const Eigen::VectorXd root = sum.cwiseSqrt();
    series.y.assign(root.begin(), root.end());
    return series;
}

Plot plotSpectrum(const RunRemainder& run, const WrenchPart& part) {
    Plot plot{std::string("Spectrum of the ") + part.name,
              "frequency [Hz]",
              std::string("density [") + part.density_unit + "]",
              {},
              false,
              true};
    plot.series.push_back(makeSpectrum("demanded", run.demanded, run, part.first, kMeasuredColor));
    plot.series.push_back(makeSpectrum("unexplained", run.unexplained, run, part.first, kAfterColor));
    return plot;
}

Plot plotAutocorrelation(const RunRemainder& run) {
    const Eigen::Index count = run.unexplained.cols();
    const auto overlap = static_cast<Eigen::Index>(std::ceil(run.overlap / run.interval));
    const double shown = std::max(kShownLag, kShownOverlaps * run.overlap) / run.interval;
    const auto lags = static_cast<int>(std::min(static_cast<Eigen::Index>(shown), count / 4));
    Plot plot{"Autocorrelation of what is left", "lag [ms]", "correlation [-]", {}};
    std::vector<double> at(static_cast<std::size_t>(lags) + 1);
    for (std::size_t k = 0; k < at.size(); ++k) at[k] = 1e3 * static_cast<double>(k) * run.interval;
    double limit = 0;
    for (const WrenchPart& part : kParts)
        for (int axis = 0; axis < 3; ++axis) {
            const Eigen::VectorXd r = calcAutocorrelation(run.unexplained.row(part.first + axis).transpose(), lags);
            limit = std::max(limit, calcAutocorrelationLimit(r.head(std::min<Eigen::Index>(overlap, r.size())), count));
            plot.series.push_back({std::string(part.name) + " " + "xyz" [axis], at, { r.begin(), r.end() }});
        }
    for (const double sign : {1.0, -1.0}) {
        std::vector<double> x, y;
        for (const double lag : at) {
            if (lag < 1e3 * run.overlap) continue;
            x.push_back(lag);
            y.push_back(sign * limit);
        }
        plot.series.push_back(
            {sign > 0 ? "95 % of noise, above" : "95 % of noise, below", x, y, false, kMeasuredColor});
    }
    return plot;
}

}  // namespace

void addRemainder(HtmlReport& page, const RunRemainder& run, const std::string& name) {
    page.addHeading("What the equations leave: " + name);
    page.addText(
        "The wrench about the mobile frame's origin that the motion demands of the mount and the fitted laws do not "
        "give, averaged with the test function of the equations. A complete model leaves noise: no trend in time, "
        "nothing that rises where the mount is driven, and beyond " +
        formatNumber(1e3 * run.overlap, 3) +
        " ms, where averages have no samples in common, an autocorrelation within the lines; but the noise of "
        "displacements that were fused with accelerations is itself correlated over some tens of milliseconds.");
    for (const WrenchPart& part : kParts) page.addPlot(plotTime(run, part));
    if (run.unexplained.cols() < kFewest) return;
    page.addPlots({plotSpectrum(run, kParts[0]), plotSpectrum(run, kParts[1]), plotAutocorrelation(run)});
}

}  // namespace wems::identify::commands
