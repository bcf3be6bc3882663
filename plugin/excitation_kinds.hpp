/// @file
/// The excitations that `simulate` makes by itself, each told once: its option, help, rules and errors follow from this
/// table.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "models/common/units.hpp"
#include "models/excitation.hpp"

namespace wems::plugin {

// Levels on the command line: `z=200`, `x=100N,y=0.1kN`, `z=1.5g`, `z`.

struct Level {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();  ///< SI; an axis without a value is 1
    bool bare = false;                                ///< some axis without a value
    bool with_unit = false;                           ///< some value with a unit
};

/// A number with or without a unit, in SI: `20mm`, `1.5g`, `200`. Without a unit it is SI.
/// @param with_unit set if there is a unit; may be null
/// @throws InputError naming `option`, the text and what is accepted
double parseQuantity(const std::string& text, Quantity quantity, const std::string& option, bool* with_unit = nullptr);

/// @throws InputError if an axis is unknown or given twice, a value is none, or nothing is left
Level parseLevel(const std::string& text, const std::string& option, Quantity quantity);

/// Several levels of one axis: `z=100,200,300`, each as parseLevel would give it alone. One level of several axes,
/// `x=100,y=100`, is one.
std::vector<Level> parseLevels(const std::string& text, const std::string& option, Quantity quantity);

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
