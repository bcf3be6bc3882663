#include "identify/spectra/run_spectra.hpp"

#include <cmath>

#include "identify/motion/swept_frequency.hpp"
#include "identify/motion/uniform_sampling.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {
namespace {

constexpr int kAverages = 20;      // segments
constexpr int kSweepAverages = 8;  // of a sine, which needs fewer: what it drives stands far above the noise

Eigen::Map<const Eigen::VectorXd> valuesOf(const Channel& channel) {
    return {channel.values.data(), static_cast<Eigen::Index>(channel.values.size())};
}

double calcVariance(const Channel& channel) {
    const auto values = valuesOf(channel);
    return (values.array() - values.mean()).square().mean();
}

/// The strongest channel of the load, then of the base, then of the fixed part's accelerations.
const Channel* findDrivingChannel(const Recording& recording, const std::string& wanted) {
    if (!wanted.empty()) {
        const Channel* channel = recording.find(wanted);
        if (channel == nullptr)
            throw InputError({recording.file, 0, "--reference"}, "there is no channel `" + wanted + "`",
                             "a channel of the recording, such as load.fz or base.az");
        return channel;
    }
    for (const Part part : {Part::load, Part::base, Part::fixed}) {
        const Channel* strongest = nullptr;
        double largest = 0;
        for (const Channel& channel : recording.channels) {
            const auto name = parseChannelName(channel.name);
            if (!name || name->part != part) continue;
            if (part == Part::fixed && name->derivative != Derivative::acceleration) continue;
            if (const double variance = calcVariance(channel); variance > largest) {
                largest = variance;
                strongest = &channel;
            }
        }
        if (strongest != nullptr) return strongest;
    }
    return nullptr;
}

Eigen::Index findIndex(const Recording& recording, const std::string& name) {
    for (std::size_t c = 0; c < recording.channels.size(); ++c)
        if (recording.channels[c].name == name) return static_cast<Eigen::Index>(c);
    return -1;
}

ChannelTransfer makeTransfer(const Recording& recording, const CrossSpectra& spectra, Eigen::Index output,
                             const RunSpectra& run) {
    ChannelTransfer transfer;
    const Channel& in = recording.channels[spectra.reference];
    const Channel& out = recording.channels[output];
    transfer.input = in.name;
    transfer.output = out.name;
    const std::string from = siUnit(findQuantity(*parseChannelName(in.name)));
    const std::string to = siUnit(findQuantity(*parseChannelName(out.name)));
    transfer.unit = from == to ? "-" : "(" + to + ")/(" + from + ")";
    transfer.estimate = estimateTransfer(spectra, output);
    // A peak where less than half of the output follows the input, or no more than chance lets it, is none.
    constexpr double least_coherence = 0.5;
    const double threshold = std::max(least_coherence, coherenceThreshold95(spectra.degrees_of_freedom));
    for (const ResponsePeak& peak :
         findPeaks(spectra.frequency, transfer.estimate.h1.cwiseAbs(), run.lowest, run.highest))
        if (transfer.estimate.coherence[peak.bin] > threshold) transfer.peaks.push_back(peak);
    return transfer;
}

void addLevels(const Recording& recording, const SweptFrequency& swept, RunSpectra& run) {
    for (const Channel& channel : recording.channels) {
        const auto values = valuesOf(channel);
        const double mean = values.mean();
        Eigen::Index at = 0;
        ChannelLevel level;
        level.name = channel.name;
        level.quantity = findQuantity(*parseChannelName(channel.name));
        level.peak = (values.array() - mean).abs().maxCoeff(&at);
        level.rms = std::sqrt(calcVariance(channel));
        level.at = recording.time[at];
        level.at_hertz = swept.is_sine && at < swept.hertz.size() ? swept.hertz[at] : NAN;
        run.channels.push_back(level);
    }
}

/// Every mobile acceleration over that of the fixed end of the same connection, or of the base, along the same axis.
void addTransmissibilities(const Recording& recording, const Eigen::MatrixXd& signals, const WelchSettings& welch,
                           RunSpectra& run) {
    for (std::size_t c = 0; c < recording.channels.size(); ++c) {
        auto name = *parseChannelName(recording.channels[c].name);
        if (name.part != Part::mobile || name.derivative != Derivative::acceleration) continue;
        name.part = Part::fixed;
        Eigen::Index input = findIndex(recording, formatChannelName(name));
        if (input < 0) {
            name.part = Part::base;
            name.connection.clear();
            input = findIndex(recording, formatChannelName(name));
        }
        // Where the input hardly moves along that axis, the quotient is one of rounding.
        constexpr double nothing = 1e-9;
        if (input < 0 || !(run.channels[input].rms > nothing) || !(run.channels[c].rms > 0)) continue;
        Eigen::MatrixXd pair(signals.rows(), 2);
        pair << signals.col(input), signals.col(c);
        CrossSpectra spectra = estimateSpectra(pair, 0, recording.sampleInterval(), welch);
        Recording both;
        both.channels = {recording.channels[input], recording.channels[c]};
        run.transmissibilities.push_back(makeTransfer(both, spectra, 1, run));
    }
}

void addShocks(const Recording& recording, const SpectraSettings& settings, RunSpectra& run) {
    constexpr double lowest_periods = 2;  // of the record that the lowest frequency sees
    constexpr double samples_per_period = 10;
    const double interval = recording.sampleInterval();
    const double length = recording.time.back() - recording.time.front();
    const double from = std::fmax(1.0, lowest_periods / length);
    for (const Channel& channel : recording.channels) {
        if (findQuantity(*parseChannelName(channel.name)) != Quantity::acceleration) continue;
        if (!(calcVariance(channel) > 0)) continue;
        run.shocks.push_back(calcShockResponse(
            valuesOf(channel), interval, makeOctaves(from, 1 / (samples_per_period * interval), 12), settings.quality));
        run.shock_channels.push_back(channel.name);
    }
}

}  // namespace

RunSpectra calcRunSpectra(const Recording& recorded, const MountModel* model, const SpectraSettings& settings) {
    RunSpectra run;
    run.file = recorded.file;
    const Recording recording = makeUniform(recorded, run.notes);
    if (recording.channels.empty()) throw InputError({recorded.file, 0, {}}, "has no channel", "named channels");
    const SweptFrequency swept = findSweptFrequency(recording);
    const double interval = recording.sampleInterval();
    run.lowest = settings.band ? settings.band->first : swept.lowest;
    run.highest = settings.band ? settings.band->second : swept.highest > 0 ? swept.highest : 0.5 / interval;
    addLevels(recording, swept, run);

    const Eigen::Index samples = recording.sampleCount();
    Eigen::MatrixXd signals(samples, recording.channels.size());
    for (std::size_t c = 0; c < recording.channels.size(); ++c) signals.col(c) = valuesOf(recording.channels[c]);
    WelchSettings welch;
    welch.segment = settings.resolution ? std::lround(1 / (*settings.resolution * interval))
                                        : chooseSegment(samples, swept.is_sine ? kSweepAverages : kAverages);
    if (welch.segment > samples || welch.segment < 8)
        throw InputError(
            {recorded.file, 0, "--resolution"},
            "takes segments of " + std::to_string(welch.segment) + " samples of " + std::to_string(samples),
            formatNumber(1 / (static_cast<double>(samples) * interval), 3) + " Hz to " +
                formatNumber(1 / (8 * interval), 3) + " Hz");
    const Channel* driving = findDrivingChannel(recording, settings.reference);
    const Eigen::Index reference = driving != nullptr ? findIndex(recording, driving->name) : 0;
    run.spectra = estimateSpectra(signals, reference, interval, welch);
    if (driving != nullptr) {
        run.reference = driving->name;
        for (Eigen::Index c = 0; c < signals.cols(); ++c)
            if (c != reference && run.channels[c].rms > 0)
                run.transfers.push_back(makeTransfer(recording, run.spectra, c, run));
    } else {
        run.notes.emplace_back("no load, base or fixed part was recorded: no transfer functions");
    }
    addTransmissibilities(recording, signals, welch, run);
    run.orders = trackOrders(recording, swept);
    addShocks(recording, settings, run);
    run.margins = findMargins(recording, model);
    return run;
}

}  // namespace wems::identify
