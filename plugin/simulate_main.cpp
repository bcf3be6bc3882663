// The executable `simulate`: a mount model under a load or base motion, recorded as CSV or for OpenSim.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "models/command_line/standard_streams.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/progress.hpp"
#include "models/common/text_table.hpp"
#include "models/recording/recording_writer.hpp"
#include "plugin/base_motion.hpp"
#include "plugin/linear_analysis.hpp"
#include "plugin/prescribed_motion.hpp"
#include "plugin/response_command.hpp"
#include "plugin/run_estimate.hpp"
#include "plugin/run_overview.hpp"
#include "plugin/run_settings.hpp"
#include "plugin/simulate_options.hpp"
#include "plugin/simulation.hpp"
#include "plugin/summary.hpp"

namespace {

using namespace wems;
using namespace wems::plugin;

bool participatesInBaseMotion(const MountModel& model) {
    for (const BracketMode& mode : model.bracket)
        if (!mode.base_participation.isZero()) return true;
    return model.bracket.empty();
}

/// What is to be said of the sampling rate; empty if it shows the excitation and is the usual one. A replay has the
/// samples that it has.
std::string noteSampleRate(const SimulateOptions& options, const Excitation& excitation) {
    if (!options.replay_file.empty() || excitation.times.size() < 2) return {};
    const double rate = 1 / (excitation.times[1] - excitation.times[0]);
    const double highest = excitation.drive->highestFrequency();
    if (!options.sample_rate) {
        constexpr double usual = 1000;
        if (rate <= 1.0001 * usual) return {};
        return "recorded at " + formatNumber(rate, 6) + " Hz, since the excitation reaches " +
               formatNumber(highest, 4) + " Hz; --sample-rate takes another";
    }
    if (rate >= 2 * highest) return {};
    return formatNumber(rate, 6) + " Hz are less than two samples in a period of the excitation, which reaches " +
           formatNumber(highest, 4) + " Hz: the recording shows other frequencies; --sample-rate " +
           formatNumber(5 * highest, 4) + " would show it";
}

/// Empty unless a stop is touched for so few samples that the recording does not show how.
std::string noteContacts(const MountModel& model, const std::vector<StopContact>& contacts, const SampleTimes& times) {
    constexpr double fewest = 4;  // samples of a touch: two in between, which show its peak
    double least = fewest;
    const StopContact* shortest = nullptr;
    for (const StopContact& contact : contacts)
        for (const StopContact::Interval& interval : contact.intervals)
            if (const double samples = static_cast<double>(interval.samples) / static_cast<double>(interval.visits);
                samples < least) {
                least = samples;
                shortest = &contact;
            }
    if (shortest == nullptr || times.size() < 2) return {};
    const double rate = static_cast<double>(times.size() - 1) / times.back();
    const Connection& connection = model.connections[shortest->connection];
    return "stop " + connection.name + "." + "xyz"[shortest->axis] + " is touched for " + formatNumber(least, 2) +
           " samples at a time on average, too few to show its force; --sample-rate " +
           formatNumber(std::ceil(2 * fewest / least) * rate, 3) + " would show it";
}

/// Where a run stands against the clock, and what keeps it from being faster.
class RunClock {
public:
    RunClock(const MountModel& model, double duration, std::optional<double> limit)
        : law_(findFastestLaw(model)), duration_(duration), limit_(limit) {}

    /// Why the run must end at the time `t` that it has reached, s; empty if it may go on. Says once that it is long.
    std::string check(double t, bool quiet) {
        const double spent = std::chrono::duration<double>(Clock::now() - start_).count();
        reached_ = std::max(reached_, t);
        const double whole = reached_ > 0 ? spent * duration_ / reached_ : INFINITY;
        const bool stiff = whole > slow * duration_;
        if (spent > settled && whole > limit_.value_or(stiff ? minute : hour))
            return describe(spent, whole) + " (accepted: a shorter run, a slower law, or --time-limit)";
        if (spent > settled && whole > minute && !said_ && !quiet) {
            said_ = true;
            std::cerr << "simulate: note: " << describe(spent, whole) << "\n";
        }
        return {};
    }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr double settled = 5, minute = 60, hour = 3600;  // s
    static constexpr double slow = 10;  // s for a second of motion; ordinary devices take less than 0.1

    std::string describe(double spent, double whole) const {
        std::string text = "t = " + formatNumber(reached_, 3) + " s of " + formatNumber(duration_, 6) + " s after " +
                           formatNumber(spent, 2) + " s, so that the whole run would take ";
        text += std::isfinite(whole) ? "about " + formatNumber(whole, 3) + " s" : "forever";
        constexpr double fast = 1e4;  // 1/s; slower ones do not limit steps of a millisecond
        if (law_.rate > fast)
            text += "; the fastest law is " + law_.name + " = " + formatNumber(law_.value, 4) + ", with a rate of " +
                    formatNumber(law_.rate, 3) + " 1/s, which allows steps of " + formatNumber(3 / law_.rate, 2) + " s";
        return text;
    }

    FastestLaw law_;
    double duration_, reached_ = 0;
    std::optional<double> limit_;
    bool said_ = false;
    Clock::time_point start_ = Clock::now();
};

std::vector<std::string> listNotes(const SimulateOptions& options, const MountModel& model,
                                   const Excitation& excitation) {
    std::vector<std::string> notes;
    if (excitation.drive->hasBase() && !participatesInBaseMotion(model))
        notes.emplace_back(
            "the modes file has no base.ux, base.uy, base.uz columns: the base motion shakes "
            "the mobile part, not the bracket's own mass");
    if (std::string note = noteSampleRate(options, excitation); !note.empty()) notes.push_back(std::move(note));
    return notes;
}

std::unique_ptr<RecordingWriter> openOutput(const SimulateOptions& options, const MountModel& model,
                                            const Recording& header, const SampleTimes& times) {
    if (options.output_file.empty()) return nullptr;
    WriteOptions write;
    for (const Connection& connection : model.connections) write.rest[connection.name] = connection.position;
    const double interval = times.size() > 1 ? times.back() / static_cast<double>(times.size() - 1) : 0;
    return openRecordingWriter(header, {times.size(), interval}, options.output_file, write);
}

void run(const SimulateOptions& options) {
    if (!options.response.empty()) return runResponseCurves(options);
    if (options.isLinear()) return runLinearAnalysis(options);
    if (!options.motion_file.empty()) return runPrescribedMotion(options);
    const MountModel model = readMountModel(options.model_file);
    OutputFiles outputs;
    checkOutputs({options.output_file, options.json_file == "-" ? "" : options.json_file, options.report_file},
                 {model.bracket_path});
    const Excitation excitation = makeExcitation(options, model.sensors);
    const SampleTimes& times = excitation.times;
    if (times.empty()) throw InputError({}, "the run has no sample", "a duration above the sample interval");

    SimulationSettings settings = makeSettings(options, excitation);
    const auto channels =
        makeSensorChannels(model, options.channels, excitation.drive->hasLoad(), excitation.drive->hasBase());
    std::optional<double> base_step;
    if (excitation.drive->hasBase()) base_step = BaseMotion::findLongestStep(*excitation.drive);
    const RunEstimate estimate = estimateRun(static_cast<double>(times.size()), static_cast<double>(channels.size()),
                                             model.connections.size(), times.back(), settings.longest_step, base_step);
    checkMemory(estimate);
    checkDisk(estimate, options.output_file);
    if (!options.quiet && isLong(estimate)) std::cerr << "simulate: note: " << describe(estimate) << "\n";
    std::vector<std::string> notes = listNotes(options, model, excitation);

    std::optional<Progress> progress(std::in_place, !options.quiet);
    settings.progress = [&](double t) {
        if (!progress->due()) return;
        char what[80];
        std::snprintf(what, sizeof what, "t = %.1f s of %.1f s, %.1f Hz", t, times.back(),
                      excitation.drive->calcFrequency(t));
        progress->show(t / times.back(), what);
    };
    RunClock clock(model, times.back(), options.time_limit);
    settings.watch = [&](double t) { return clock.check(t, options.quiet); };

    const Recording header = makeHeader(options, model, excitation, channels);
    const auto writer = openOutput(options, model, header, times);
    RunOverview overview(header, times.size());
    settings.sink = [&](const Recording& rows) {
        Recording shifted = rows;
        for (double& t : shifted.time) t += excitation.time_offset;
        if (writer) writer->append(shifted);
        if (!options.report_file.empty()) overview.add(shifted);
    };
    ConnectionOverview connections(model, times.size());
    std::optional<SceneRecorder> scene;
    if (!options.report_file.empty()) {
        scene.emplace(model, *excitation.drive, times, readDrawing(options.model_file));
        settings.observer = [&](double t, const DeviceMotion& motion) {
            connections.add(t, motion);
            scene->add(motion);
        };
    }
    const SimulationResult result = simulate(model, excitation.drive, settings);
    progress.reset();

    if (writer) {
        outputs.add(writer->finish());
        notes.insert(notes.end(), writer->notes().begin(), writer->notes().end());
    }
    if (std::string note = noteContacts(model, result.contacts, times); !note.empty()) notes.push_back(std::move(note));
    const RunDescription description{model, *excitation.drive, result, excitation.time_offset};
    if (!options.report_file.empty())
        writeHtmlSummary(description, header, overview, connections, *scene, options.report_file, outputs);
    nlohmann::json summary;
    if (!options.json_file.empty()) {
        summary = makeSummaryJson(description);
        summary["notes"] = notes;
        addRecord(summary, makeRecord(options, "simulate", model));
    }
    finishOutputs(options, summary, formatSummary(description, styleOf(STDOUT_FILENO)), outputs);
    for (const std::string& note : notes) std::cerr << "simulate: note: " << note << "\n";
}

int work(int argc, char** argv) {
    int exit_status = 0;
    const auto options = parseCommandLine(argc, argv, exit_status);
    if (options) run(*options);
    return exit_status;
}

}  // namespace

int main(int argc, char** argv) {
    return runProgram("simulate", work, argc, argv);
}
