// Draws a hidden case: FOLDER/seen has what a diagnosis may see (believed.toml, bracket.csv, run1.csv, run2.csv,
// validate.csv), FOLDER/truth.json, truth.toml and truth_bracket.csv the truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>
#include <stdexcept>

#include "models/bracket.hpp"
#include "models/recording/recording_writer.hpp"
#include "tests/hidden/case_text.hpp"
#include "tests/hidden/hidden_recording.hpp"
#include "tests/hidden/time_scale.hpp"

namespace {

using namespace wems;
using namespace wems::hidden;

constexpr const char* kUsage =
    "usage: hidden_case SEED INDEX FOLDER [--kind any|single|two|none|outside|CAUSE] [--level 0|1|2]\n"
    "  [--set-up any|bracket|base|axis] [--sensors any|accelerations|displacements|both]\n"
    "  [--excitation any|logarithmic|linear|random] [--time-scale any|FACTOR] [--tolerance yes|no]";

struct Choice {
    CaseOptions options;
    bool tolerance = true;
};

/// Index of a word in a list, absent for `any`.
std::optional<int> choose(const std::string& word, const std::vector<std::string>& accepted) {
    for (std::size_t i = 0; i < accepted.size(); ++i)
        if (word == accepted[i]) return static_cast<int>(i);
    if (word == "any") return std::nullopt;
    throw std::invalid_argument("unknown choice: " + word + "\n" + kUsage);
}

Choice readChoice(int argc, char** argv, std::uint64_t index, Random& random) {
    std::map<std::string, std::string> given;
    for (int i = 4; i + 1 < argc; i += 2) given[argv[i]] = argv[i + 1];
    const auto value = [&](const std::string& name, const std::string& absent) {
        const auto found = given.find(name);
        const std::string text = found == given.end() ? absent : found->second;
        given.erase(name);
        return text;
    };
    Choice choice;
    CaseOptions& options = choice.options;
    options.kind = value("--kind", "any");
    if (options.kind == "any") {
        const double u = drawUniform(random, 0, 1);
        options.kind = u < 0.15   ? "none"
                       : u < 0.27 ? "two"
                       : u < 0.39 ? "outside"
                                  : listCauses()[index % listCauses().size()];
    }
    options.level = choose(value("--level", "0"), {"0", "1", "2"}).value_or(0);
    const auto sensors = choose(value("--sensors", "any"), {"accelerations", "displacements", "both"});
    if (sensors) options.sensors = static_cast<Sensors>(1 + *sensors);
    options.set_up_kind = value("--set-up", "any");
    if (const auto drawn = choose(value("--excitation", "any"), {"logarithmic", "linear", "random"}))
        options.excitation = static_cast<Excitation>(*drawn);
    const std::string scale = value("--time-scale", "any");
    if (scale != "any") options.time_scale = std::stod(scale);
    choice.tolerance = choose(value("--tolerance", "yes"), {"no", "yes"}).value_or(1) == 1;
    if (!given.empty() || (argc - 4) % 2 != 0) throw std::invalid_argument(kUsage);
    return choice;
}

/// Where the true model itself leaves more, the recordings tell too little.
constexpr double kLargestError = 0.15;
/// What the effects have to add to the error of the free simulation.
constexpr double kLeast = 0.04;

struct RecordedCase {
    HiddenCase hidden;
    std::array<Recording, 3> runs;  // in unit time
    ModelErrors errors;
};

GroupErrors calcErrors(const HiddenCase& hidden, const MountModel& model, const OutsideEffect& outside,
                       const std::array<Recording, 3>& runs) {
    ErrorSquares groups[2];
    for (std::size_t r = 0; r < 3; ++r) {
        const auto squares = calcError(hidden, r, model, outside, runs.at(r));
        groups[r / 2].difference += squares.difference;
        groups[r / 2].reference += squares.reference;
    }
    return {groups[0].error(), groups[1].error()};
}

std::array<Recording, 3> recordRuns(const HiddenCase& hidden, std::uint64_t noise_seed, bool faults) {
    return {recordRun(hidden, 0, noise_seed, faults), recordRun(hidden, 1, noise_seed, faults),
            recordRun(hidden, 2, noise_seed, faults)};
}

/// What the effects add to the error, beside faults of sensors, must show in what is recorded, too: accelerations alone
/// hardly see a slow force.
bool isWorthAsking(const HiddenCase& hidden, const ModelErrors& errors) {
    if (std::max(errors.truth.identification, errors.truth.validation) > kLargestError) return false;
    const auto shows = [](double without, double with) { return !(without * without - with * with < kLeast * kLeast); };
    return (hidden.change[0] == 0 && hidden.change[1] == 0) ||
           (shows(errors.without.identification, errors.truth.identification) &&
            shows(errors.without.validation, errors.truth.validation));
}

/// One whose truth can be simulated and is followed by the true model, the first of those drawn one after the other.
RecordedCase drawRecorded(const CaseOptions& options, std::uint64_t noise_seed, Random& random) {
    constexpr int kDraws = 40;
    for (int draw = 0; draw < kDraws; ++draw) {
        RecordedCase drawn{drawCase(options, random), {}, {}};
        const HiddenCase& hidden = drawn.hidden;
        static const OutsideEffect none;
        try {
            drawn.runs = recordRuns(hidden, noise_seed, true);
            const auto faultless = hidden.truth.sensors.empty() ? drawn.runs : recordRuns(hidden, noise_seed, false);
            drawn.errors.truth = calcErrors(hidden, hidden.truth, hidden.outside, faultless);
            drawn.errors.without = calcErrors(hidden, hidden.base, none, faultless);
            if (!isWorthAsking(hidden, drawn.errors)) continue;
            drawn.errors.believed = calcErrors(hidden, hidden.believed, none, drawn.runs);
            return drawn;
        } catch (const TruthDiverged&) {
            continue;
        }
    }
    throw std::runtime_error("no such case was found in " + std::to_string(kDraws) + " draws");
}

void writeText(const std::string& file, const std::string& text) {
    std::ofstream(file) << text;
}

void writeModel(const HiddenCase& hidden, const MountModel& model, const Tolerances& tolerances,
                const std::string& folder, const std::string& name, const std::string& bracket) {
    if (!model.bracket.empty())
        writeText(folder + "/" + bracket, formatBracketModes(slowDown(model, hidden.time_scale).bracket));
    writeText(folder + "/" + name, formatModel(hidden, model, tolerances, bracket));
}

void run(int argc, char** argv) {
    if (argc < 4) throw std::invalid_argument(kUsage);
    const std::uint64_t seed = std::stoull(argv[1]), index = std::stoull(argv[2]);
    const std::string folder = argv[3], seen = folder + "/seen";
    std::seed_seq sequence{seed, index};
    Random random(sequence);
    const Choice choice = readChoice(argc, argv, index, random);
    const std::uint64_t noise_seed = seed * 1000003 + index * 17;
    const RecordedCase recorded = drawRecorded(choice.options, noise_seed, random);
    const HiddenCase& hidden = recorded.hidden;
    std::filesystem::create_directories(seen);
    const Tolerances stated = stateTolerances(makeSmallErrors(choice.options.level), hidden.time_scale);
    writeModel(hidden, hidden.believed, choice.tolerance ? stated : Tolerances(), seen, "believed.toml", "bracket.csv");
    writeModel(hidden, hidden.truth, {}, folder, "truth.toml", "truth_bracket.csv");
    const char* names[] = {"run1", "run2", "validate"};
    for (std::size_t r = 0; r < 3; ++r)
        writeCsv(slowDown(recorded.runs.at(r), hidden.time_scale), seen + "/" + names[r] + ".csv", 7);
    auto truth = formatTruth(hidden, recorded.errors);
    truth["seed"] = seed;
    truth["index"] = index;
    truth["level"] = choice.options.level;
    writeText(folder + "/truth.json", truth.dump(1) + "\n");
}

}  // namespace

int main(int argc, char** argv) {
    try {
        run(argc, argv);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "hidden_case: " << error.what() << "\n";
    }
    return 2;
}
