// Draws a hidden case and writes what a diagnosis may see (base.toml, run1.csv, run2.csv, validate.csv) and the truth
// (truth.toml, truth.json, plan.json).
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "models/bracket_modes.hpp"
#include "models/recording/csv_writer.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/hidden/truth_simulator.hpp"

namespace {

using namespace wems;
using namespace wems::hidden;

nlohmann::json formatTruth(const HiddenCase& hidden) {
    auto causes = nlohmann::json::array();
    for (const auto& effect : hidden.effects) {
        nlohmann::json parameters = nlohmann::json::object();
        for (const auto& [name, value] : effect.parameters)
            parameters[name] = std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
        causes.push_back({{"cause", effect.cause}, {"where", effect.where}, {"parameters", parameters}});
    }
    nlohmann::json truth{{"class", hidden.kind},
                         {"causes", causes},
                         {"change", hidden.change},
                         {"amplification", hidden.amplification},
                         {"noise",
                          {{"displacement", hidden.displacement_noise},
                           {"acceleration", hidden.acceleration_noise},
                           {"gain_scatter", hidden.gain_scatter}}}};
    if (hidden.outside.kind != OutsideEffect::Kind::none)
        truth["outside"] = {{"kind", formatKind(hidden.outside.kind)},
                            {"where", std::to_string(hidden.outside.connection + 1) + "." + "xyz"[hidden.outside.axis]},
                            {"size", hidden.outside.size}};
    return truth;
}

/// Scales an outside effect until it changes the motion as wanted.
void scaleOutside(HiddenCase& hidden, Random& random) {
    const double wanted = drawLog(random, 0.05, 0.35);
    for (int i = 0; i < 4; ++i) {
        double difference = 0, signal = 0;
        for (std::size_t r = 1; r < 3; ++r) {
            const auto markers = simulateTruth(hidden, r);
            const Eigen::MatrixXd truth = markers.mobile - markers.fixed;
            const Eigen::MatrixXd base = simulateRelative(hidden, hidden.base, r);
            difference += (base - truth).squaredNorm();
            signal += truth.squaredNorm();
        }
        hidden.change[0] = hidden.change[1] = std::sqrt(difference / signal);
        if (std::abs(std::log(hidden.change[0] / wanted)) < 0.3) return;
        hidden.outside.size *= std::clamp(wanted / hidden.change[0], 0.3, 3.0);
    }
}

struct RecordedCase {
    HiddenCase hidden;
    std::array<Recording, 3> runs;
};

/// One whose truth can be simulated, the first of those drawn one after the other.
RecordedCase drawRecorded(const std::string& kind, std::uint64_t noise_seed, Random& random, Sensors sensors) {
    constexpr int kDraws = 20;
    for (int draw = 0; draw < kDraws; ++draw) {
        RecordedCase drawn{drawCase(kind, random, sensors), {}};
        if (kind != "none" && kind != "two" && kind != "outside") drawn.hidden.kind = "single";
        try {
            if (kind == "outside") scaleOutside(drawn.hidden, random);
            for (std::size_t r = 0; r < drawn.runs.size(); ++r)
                drawn.runs.at(r) = recordForward(drawn.hidden, r, noise_seed);
            return drawn;
        } catch (const TruthDiverged&) {
            continue;
        }
    }
    throw TruthDiverged();
}

void run(std::uint64_t seed, std::uint64_t index, const std::string& folder, std::string kind, Sensors sensors) {
    std::seed_seq sequence{seed, index};
    Random random(sequence);
    if (kind == "any") {
        const double u = drawUniform(random, 0, 1);
        kind = u < 0.15 ? "none" : u < 0.3 ? "two" : u < 0.45 ? "outside" : listCauses()[index % listCauses().size()];
    }
    const auto [hidden, runs] = drawRecorded(kind, seed * 1000003 + index * 17, random, sensors);
    std::filesystem::create_directories(folder);
    MountModel base = hidden.base, truth = hidden.truth;
    base.bracket_path = folder + "/bracket.csv";
    truth.bracket_path = folder + "/truth_bracket.csv";
    truth.replaced_modes.clear();  // its own modes file has them
    std::ofstream(base.bracket_path) << formatBracketModes(base.bracket);
    std::ofstream(truth.bracket_path) << formatBracketModes(truth.bracket);
    writeMountModel(base, folder + "/base.toml");
    writeMountModel(truth, folder + "/truth.toml");
    std::ofstream(folder + "/truth.json") << formatTruth(hidden).dump(1) << "\n";
    const char* names[] = {"run1", "run2", "validate"};
    auto plan = nlohmann::json::array();
    for (std::size_t r = 0; r < 3; ++r) {
        const Eigen::Vector3d f = hidden.runs[r].direction * hidden.runs[r].level;
        plan.push_back({{"force", {f.x(), f.y(), f.z()}},
                        {"upward", hidden.runs[r].upward},
                        {"octaves_per_minute", hidden.octaves_per_minute},
                        {"sample_rate", hidden.rate}});
        writeCsv(runs.at(r), folder + "/" + names[r] + ".csv", 7);
    }
    std::ofstream(folder + "/plan.json") << plan.dump(1) << "\n";
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc < 4) throw std::invalid_argument("usage: hidden_case SEED INDEX FOLDER [KIND|any [accelerations]]");
        const std::string kind = argc > 4 ? argv[4] : "any", sensors = argc > 5 ? argv[5] : "any";
        if (sensors != "any" && sensors != "accelerations") throw std::invalid_argument("unknown sensors: " + sensors);
        run(std::stoull(argv[1]), std::stoull(argv[2]), argv[3], kind,
            sensors == "any" ? Sensors::any : Sensors::accelerations);
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "hidden_case: " << error.what() << "\n";
    }
    return 2;
}
