#include "plugin/simulate_options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <sstream>
#include <vector>

#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "plugin/excitation_kinds.hpp"

namespace wems::plugin {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
    std::vector<std::string> parts;
    std::stringstream stream(text);
    for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
    if (text.empty() || text.back() == separator) parts.emplace_back();
    return parts;
}

double parseNumber(const std::string& text, const std::string& option, const std::string& accepted) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !std::isfinite(value))
        throw InputError({"", 0, option}, "`" + text + "` is not a number", accepted);
    return value;
}

/// `key=value,key=value`; every key must be one of `keys`.
std::map<std::string, double> parseAssignments(const std::string& text, const std::string& option,
                                               const std::vector<std::string>& keys, const std::string& accepted) {
    std::map<std::string, double> values;
    for (const std::string& part : split(text, ',')) {
        const auto equals = part.find('=');
        const std::string key = part.substr(0, equals);
        if (equals == std::string::npos || std::find(keys.begin(), keys.end(), key) == keys.end())
            throw InputError({"", 0, option}, "`" + part + "` is not understood", accepted);
        if (!values.emplace(key, parseNumber(part.substr(equals + 1), option, accepted)).second)
            throw InputError({"", 0, option}, "`" + key + "` is given twice", accepted);
    }
    return values;
}

/// `--force` or `--base-acceleration`.
Eigen::Vector3d takeLevel(const std::string& text, const std::string& option, Quantity quantity,
                          SimulateOptions& options) {
    if (text.empty()) return Eigen::Vector3d::Zero();
    if (!options.response.empty()) {
        options.levels = parseLevels(text, option, quantity);
        return options.levels.front().value;
    }
    const Level level = parseLevel(text, option, quantity);
    options.level_is_bare = options.level_is_bare || level.bare;
    options.level_has_unit = options.level_has_unit || level.with_unit;
    return level.value;
}

SensorNoise parseNoise(const std::string& text) {
    const std::string accepted = "RMS values such as displacement=1e-6,acceleration=0.01; also velocity, load, base";
    SensorNoise noise;
    const std::map<std::string, double*> targets{{"displacement", &noise.displacement},
                                                 {"velocity", &noise.velocity},
                                                 {"acceleration", &noise.acceleration},
                                                 {"load", &noise.load},
                                                 {"base", &noise.base}};
    std::vector<std::string> keys;
    for (const auto& [key, target] : targets) keys.push_back(key);
    for (const auto& [key, value] : parseAssignments(text, "--noise", keys, accepted)) {
        if (value < 0) throw InputError({"", 0, "--noise"}, "`" + key + "` is negative", accepted);
        *targets.at(key) = value;
    }
    return noise;
}

ChannelSelection parseChannels(const std::string& text) {
    ChannelSelection selection{false, false, false};
    for (const std::string& part : split(text, ',')) {
        if (part == "displacement") {
            selection.displacement = true;
        } else if (part == "velocity") {
            selection.velocity = true;
        } else if (part == "acceleration") {
            selection.acceleration = true;
        } else {
            throw InputError({"", 0, "--channels"}, "`" + part + "` is not a quantity",
                             "displacement, velocity, acceleration, separated by commas");
        }
    }
    return selection;
}

/// `--sweep f0:f1, --dwell …, --from-csv FILE`, or the options alone.
std::string listExcitations(bool with_form) {
    std::string list;
    for (const ExcitationKind& kind : excitationKinds())
        list += kind.option + (with_form ? std::string(" ") + kind.form : std::string()) + ", ";
    return list + (with_form ? "--from-csv FILE" : "--from-csv");
}

constexpr const char* footer =
    "and but for --from-csv and --motion one of --force, --base-acceleration. The recording starts from the static\n"
    "equilibrium under the model's gravity; displacements count from there. Exit status: 0 done, 2 bad input or "
    "usage.\n\n"
    "Levels take units, z=1.5g or z=5mm. Example, a sweep at 200 N along z, four octaves per minute, with a micrometre "
    "of sensor noise:\n"
    "  simulate smallsat.toml --sweep 5:50 --rate 4 --force z=200 --noise displacement=1e-6 -o run.csv\n"
    "The same load once more on another model, for comparison:\n"
    "  simulate other.toml --from-csv run.csv -o other.csv\n"
    "What the linear model says without a run: modes, transfer functions, response to a random test:\n"
    "  simulate smallsat.toml --modes --report modes.html\n"
    "  simulate smallsat.toml --frf 5:100 --base-acceleration z -o transfer.csv\n"
    "  simulate smallsat.toml --modes --psd test.csv --base-acceleration z\n"
    "What the laws make of the motion of a component test, to compare with the force measured there:\n"
    "  simulate element.toml --motion machine.csv -o law.csv\n"
    "Both branches of the nonlinear response at four levels:\n"
    "  simulate smallsat.toml --response 5:50 --force z=100,200,300,400 --report response.html";

/// Finds the one excitation among the values that were given to the options of excitationKinds().
void chooseExcitation(const std::vector<std::string>& values, SimulateOptions& options) {
    int given = options.replay_file.empty() ? 0 : 1;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i].empty()) continue;
        ++given;
        options.kind = &excitationKinds()[i];
        options.signal = values[i];
    }
    if (options.isLinear()) return;
    if (!options.response.empty() && given == 0) return;
    if (!options.motion_file.empty() && given == 0) return;
    if (!options.motion_file.empty())
        throw InputError({"", 0, "--motion"}, "says itself how the connections move", "no other excitation");
    if (!options.response.empty())
        throw InputError({"", 0, "--response"}, "is a run of its own", "no other excitation");
    if (given != 1)
        throw InputError({"", 0, "excitation"}, given == 0 ? "none is given" : "more than one is given",
                         "one of " + listExcitations(true));
}

/// Modes and transfer functions: no run, so that only a spectrum may stand beside them.
void checkLinearOptions(const SimulateOptions& options, int levels) {
    const bool spectrum = options.kind != nullptr;
    if (!options.replay_file.empty() || (spectrum && !options.kind->is_spectrum))
        throw InputError({"", 0, options.modes ? "--modes" : "--frf"}, "is no run and takes no such excitation",
                         "--psd");
    const bool driven = spectrum || !options.band.empty();
    if (driven && levels != 1)
        throw InputError({"", 0, "level"}, "the direction of the input is needed",
                         "one of --force z and --base-acceleration z");
    if (!driven && levels != 0)
        throw InputError({"", 0, "level"}, "natural modes have no input", "--frf f0:f1 or --psd FILE beside it");
    if (!driven && !options.output_file.empty())
        throw InputError({"", 0, "--output"}, "there is no curve to write",
                         "--frf f0:f1 or --psd FILE, or --json FILE");
}

void checkResponseOptions(const SimulateOptions& options, int levels) {
    if (options.isLinear() || options.kind != nullptr || !options.replay_file.empty())
        throw InputError({"", 0, "--response"}, "goes with no other question", "--response alone");
    if (levels != 1)
        throw InputError({"", 0, "level"}, levels == 0 ? "none is given" : "both force and base acceleration are given",
                         "one of --force z=100,200,300 and --base-acceleration z=0.5g,1g");
    for (const Level& level : options.levels)
        if (level.bare) throw InputError({"", 0, "level"}, "an axis has no value", "amplitudes such as z=100,200,300");
}

/// Everything that CLI11 cannot check by itself.
void checkOptions(const SimulateOptions& options) {
    const int levels =
        !options.force.isZero() + !options.base_acceleration.isZero() + !options.base_displacement.isZero();
    if (!options.base_displacement.isZero() && options.fade > 0)
        throw InputError({"", 0, "--fade"}, "does not go with --base-displacement", "--base-acceleration");
    if (!options.response.empty()) return checkResponseOptions(options, levels);
    if (options.isLinear()) return checkLinearOptions(options, levels);
    if (!options.motion_file.empty()) {
        if (levels != 0)
            throw InputError({"", 0, "--motion"}, "says itself how the connections move",
                             "no --force, no --base-acceleration, no --base-displacement");
        return;
    }
    if (options.level_is_bare && !(options.kind != nullptr && options.kind->takes_bare_level))
        throw InputError({"", 0, "level"}, "an axis has no value", "values such as z=200, with or without a unit");
    if (options.replay_file.empty() && levels != 1)
        throw InputError({"", 0, "level"}, levels == 0 ? "none is given" : "more than one is given",
                         "one of --force z=200, --base-acceleration z=1.0 and --base-displacement z=1mm");
    if (!options.replay_file.empty() && levels != 0)
        throw InputError({"", 0, "--from-csv"}, "the recording says load and base motion itself",
                         "no --force and no --base-acceleration beside it");
    const bool whole = options.kind != nullptr && options.kind->takes_bare_level;
    if (whole && !options.base_displacement.isZero())
        throw InputError({"", 0, "--base-displacement"}, std::string("does not go with ") + options.kind->option,
                         "--base-acceleration");
    if (options.quality && (options.kind == nullptr || std::string(options.kind->option) != "--srs"))
        throw InputError({"", 0, "--q"}, "is of a shock response spectrum", "--srs FILE");
    if (options.downwards && (options.kind == nullptr || std::string(options.kind->option) != "--profile"))
        throw InputError({"", 0, "--downwards"}, "is of a profile", "--profile FILE");
    const bool takes_rate = options.kind != nullptr && options.kind->takes_rate;
    if (!takes_rate && (options.octaves_per_minute || options.hertz_per_second))
        throw InputError({"", 0, "--rate"}, "is the rate of a sweep, and there is none",
                         "--sweep f0:f1, --profile FILE");
    if (options.octaves_per_minute && options.hertz_per_second)
        throw InputError({"", 0, "--rate"}, "and --linear-rate are both given", "one of them");
    if (!options.replay_file.empty() && options.fade > 0)
        throw InputError({"", 0, "--fade"}, "does not go with --from-csv",
                         "a sweep or another excitation that is no recording");
    const auto requirePositive = [](const std::optional<double>& value, const char* name) {
        if (value && !(*value > 0 && std::isfinite(*value)))
            throw InputError({"", 0, name}, "is not above zero", "a number above 0");
    };
    requirePositive(options.duration, "--duration");
    requirePositive(options.sample_rate, "--sample-rate");
    requirePositive(options.octaves_per_minute, "--rate");
    requirePositive(options.hertz_per_second, "--linear-rate");
    if (!(options.fade >= 0)) throw InputError({"", 0, "--fade"}, "is negative", "seconds, from 0 on");
    if (!(options.accuracy > 0 && options.accuracy < 1))
        throw InputError({"", 0, "--accuracy"}, "is out of range", "a number between 0 and 1, such as 1e-6");
}

}  // namespace

std::optional<SimulateOptions> readOptions(int argc, const char* const* argv) {
    SimulateOptions options;
    std::string force, base, travel, noise, channels;
    CLI::App app{"Simulate equipment on elastomer mounts with stops (Simbody) and record it."};
    app.name(programName(argv[0]));
    app.footer("Exactly one of " + listExcitations(false) + ",\n" + footer);
    addInputFile(app, "MODEL", options.model_file, "mount model, TOML")->required();
    addOutputFile(app, "-o,--output", options.output_file, "recording to write: .csv, or .trc, .sto, .mot for OpenSim");
    std::vector<std::string> signals(excitationKinds().size());
    for (std::size_t i = 0; i < signals.size(); ++i)
        app.add_option(excitationKinds()[i].option, signals[i], excitationKinds()[i].help);
    app.add_flag("--modes", options.modes,
                 "no run: modes with damping and effective masses, rest position, clearances left there");
    app.add_option("--frf", options.band, "no run: transfer functions of the linear model over f0:f1 in Hz");
    app.add_option("--response", options.response,
                   "no run: periodic responses over f0:f1 in Hz, every branch, stable or not, at levels such as "
                   "--force z=100,200,300");
    app.add_option("--harmonics", options.harmonics, "of --response (default 15)");
    app.add_option("--rate", options.octaves_per_minute, "logarithmic sweep rate, octaves per minute (default 4)");
    app.add_option("--linear-rate", options.hertz_per_second, "linear sweep rate, Hz per second");
    addInputFile(app, "--from-csv", options.replay_file,
                 std::string("replay the load or base motion of this recording (") + kReadableFormats + ")");
    addInputFile(app, "--motion", options.motion_file,
                 "no run: the force of each law along the relative motion of this recording, as on a test machine");
    addInputFile(app, "--columns", options.column_map, "TOML that maps that recording's column names to channel names");
    app.add_option("--force", force, "force at the bracket's load point, N, such as z=200 or x=0.1kN,y=100N");
    app.add_option("--base-acceleration", base, "acceleration of the base, m/s^2, such as z=1.0 or z=1.5g");
    app.add_option("--base-displacement", travel,
                   "displacement of the base in a sweep or dwell, m, such as z=5mm, in place of its acceleration");
    app.add_flag("--downwards", options.downwards, "sweep a --profile from its highest frequency to its lowest");
    app.add_option("--q", options.quality, "quality factor of the oscillators of --srs (default 10)")
        ->check(isPositive());
    app.add_option("--fade", options.fade, "fade in and out over so many seconds");
    app.add_option("--duration", options.duration, "end the run after so many seconds");
    app.add_option(
        "--sample-rate", options.sample_rate,
        "Hz (default 1000, more where the excitation is faster; with --from-csv the recording's time stamps)");
    app.add_option("--channels", channels, "quantities to record (default displacement,acceleration; also velocity)");
    app.add_option("--noise", noise, "sensor noise, RMS in SI units, such as displacement=1e-6,acceleration=0.01");
    app.add_option("--seed", options.seed, "seed of sensor noise and random excitation (default 1)");
    app.add_option("--accuracy", options.accuracy, "integrator accuracy, m and m/s for each step (default 1e-6)");
    addOutputFile(app, "--json", options.json_file, "write the summary as JSON to FILE (- for standard output)", true);
    addOutputFile(app, "--report", options.report_file, "write a self-contained HTML page with pictures to FILE");
    app.add_option("--time-limit", options.time_limit,
                   "s; a run that would take longer ends with the reason (default 3600, of a stiff model 60)")
        ->check(isPositive());
    app.add_flag("-q,--quiet", options.quiet, "no progress, no summary");
    addCompletionOption(app);
    app.set_version_flag("--version", "wems simulate " WEMS_VERSION);
    options.accuracy = 1e-6;
    try {
        app.parse(argc, argv);
        options.force = takeLevel(force, "--force", Quantity::force, options);
        options.base_acceleration = takeLevel(base, "--base-acceleration", Quantity::acceleration, options);
        if (!travel.empty()) {
            if (!options.response.empty() || options.isLinear())
                throw InputError({"", 0, "--base-displacement"}, "is of a run", "--base-acceleration");
            options.base_displacement = takeLevel(travel, "--base-displacement", Quantity::length, options);
        }
        if (!noise.empty()) options.noise = parseNoise(noise);
        if (!channels.empty()) options.channels = parseChannels(channels);
        chooseExcitation(signals, options);
        checkOptions(options);
        return options;
    } catch (const CLI::CallForHelp&) {
        std::cout << app.help();
        return std::nullopt;
    } catch (const CLI::CallForVersion& version) {
        std::cout << version.what() << "\n";
        return std::nullopt;
    } catch (const CLI::ParseError& error) {
        throw InputError({}, describeUsageError(app, error));
    }
}

std::optional<SimulateOptions> parseCommandLine(int argc, const char* const* argv, int& exit_status) {
    try {
        exit_status = 0;
        return readOptions(argc, argv);
    } catch (const InputError& error) {
        std::cerr << "simulate: " << error.what() << "\n";
        exit_status = 2;
        return std::nullopt;
    }
}

}  // namespace wems::plugin
