/// @file
/// All spectra of one run: densities of its channels, transfer functions from what drives it, transmissibilities,
/// orders along a sweep, shock response, margins.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/inspect/order_tracking.hpp"
#include "identify/spectra/margins.hpp"
#include "identify/spectra/welch.hpp"
#include "models/shock.hpp"

namespace wems::identify {

struct SpectraSettings {
    std::optional<double>
        resolution;         ///< Hz, from one bin to the next; absent: at least 20 segments, 8 of a sine sweep
    std::string reference;  ///< channel that drives; empty: the strongest of the load, the base, the fixed part
    std::optional<std::pair<double, double>> band;  ///< Hz, where peaks are looked for; absent: the excited band
    double quality = 10;                            ///< Q of the shock response
};

struct ChannelLevel {
    std::string name;
    Quantity quantity = Quantity::acceleration;
    double rms = 0;       ///< SI, about the mean
    double peak = 0;      ///< SI, largest deviation from the mean
    double at = 0;        ///< s, of the peak
    double at_hertz = 0;  ///< swept frequency there, Hz; NaN where nothing sweeps
};

/// From one channel to another.
struct ChannelTransfer {
    std::string input, output, unit;
    TransferEstimate estimate;
    std::vector<ResponsePeak> peaks;  ///< of |H1|
};

struct RunSpectra {
    std::string file;
    std::string reference;           ///< empty: nothing drives
    double lowest = 0, highest = 0;  ///< Hz, band in which peaks are looked for
    CrossSpectra spectra;            ///< signals as `channels`
    std::vector<ChannelLevel> channels;
    std::vector<ChannelTransfer> transfers;  ///< from the reference to every other channel that is not zero
    std::vector<ChannelTransfer>
        transmissibilities;             ///< mobile over fixed (or base) acceleration, same connection and axis
    OrderTracking orders;               ///< empty unless the drive is a sine
    std::vector<ShockResponse> shocks;  ///< of each acceleration
    std::vector<std::string> shock_channels;
    Margins margins;
    std::vector<std::string> notes;
};

/// @param model may be null; with it forces and clearances left
/// @throws InputError if the recording is too short or the reference is not there
RunSpectra calcRunSpectra(const Recording& recording, const MountModel* model, const SpectraSettings& settings);

}  // namespace wems::identify
