/// @file
/// The excitations that `simulate` makes by itself, each told once: its option, help, rules and errors follow from this
/// table.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/excitation.hpp"

namespace wems::plugin {

struct SimulateOptions;

/// A signal of unit amplitude and what the recording calls it.
struct NamedSignal {
    std::shared_ptr<const Signal> signal;
    bool swept;               ///< one frequency at a time, so that summaries may speak of the swept frequency
    std::string description;  ///< `dwell at 29 Hz, 10 s`
};

struct ExcitationKind {
    const char* option;  ///< `--dwell`
    const char* form;    ///< of its value: `f:duration`
    const char* help;
    bool takes_rate;        ///< goes with --rate and --linear-rate
    bool takes_bare_level;  ///< has a level of its own, so that `--base-acceleration z` needs no value
    bool is_spectrum;       ///< of a random test: goes with --modes, and its RMS may be given as a level with a unit
    /// @param value what the user gave to the option
    /// @throws InputError if the value is not of that form or out of range
    NamedSignal (*make)(const std::string& value, const SimulateOptions& options);
};

/// The spectrum that `--psd` names, its RMS made 1 where the level has a unit and so gives the RMS.
/// @throws InputError if it cannot be read, or is of a force where the base is driven or the other way round
PowerSpectrum readLevelledSpectrum(const SimulateOptions& options);

/// In the order of the help.
const std::vector<ExcitationKind>& excitationKinds();

}  // namespace wems::plugin
