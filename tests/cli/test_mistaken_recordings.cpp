// Recordings of a known device with one mistake of the laboratory in them: what the commands say, what they write.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "models/parameter_access.hpp"
#include "models/recording/recording_writer.hpp"
#include "run_program.hpp"
#include "tests/fit/synthetic_run.hpp"
#include "tests/sanitized.hpp"
#include "tests/seed.hpp"

using Catch::Contains;
using wems::test::runProgram;

namespace wems {
namespace {

constexpr double g = 9.80665;  // m/s²

const std::vector<std::string> inputs{"model.toml", "run.csv", "smallsat_bracket.csv"};

/// 3.3 s from 5 to 50 Hz in an oblique direction, below the clearances.
const test::SweepSettings settings = [] {
    test::SweepSettings sweep;
    sweep.force = {60, 40, 200};
    sweep.octaves_per_minute = 60;
    sweep.sample_rate = 1000;
    sweep.steps_per_sample = 8;
    return sweep;
}();

const test::SyntheticRun& sweepOf(const MountModel& model) {
    static const test::SyntheticRun run = test::simulateSweep(model, settings);
    return run;
}

struct Laboratory {
    Laboratory() {
        CAPTURE(seed);
        std::filesystem::copy_file(WEMS_SOURCE_DIR "/models/shipped/smallsat_bracket.csv",
                                   folder.path() + "/smallsat_bracket.csv");
        writeMountModel(truth, folder.path() + "/model.toml");
        recording = test::record(sweepOf(truth), {1e-6, 0.01}, seed);
    }

    test::ProgramResult run(std::vector<std::string> arguments) const {
        writeRecording(recording, folder.path() + "/run.csv");
        arguments.insert(arguments.begin() + 1, "run.csv");
        return runProgram(IDENTIFY_PROGRAM, arguments, folder.path());
    }
    /// Columns whose name contains `text` times `factor`.
    void scale(const std::string& text, double factor) {
        int scaled = 0;
        for (Channel& channel : recording.channels) {
            if (channel.name.find(text) == std::string::npos) continue;
            ++scaled;
            for (double& value : channel.values) value *= factor;
        }
        REQUIRE(scaled > 0);
    }
    /// One moment beyond the sum of the others, as springs that turn with the body and are not in the model make it.
    void recordStrangeInertia() {
        MountModel strange = truth;
        strange.body.inertia(0, 0) = 1.2 * (strange.body.inertia(1, 1) + strange.body.inertia(2, 2));
        recording = test::record(test::simulateSweep(strange, settings), {1e-6, 0.01}, seed);
    }
    /// 0.8 s: what the diagnosis of nonsense costs grows with the samples.
    void recordBriefly() {
        test::SweepSettings brief = settings;
        brief.octaves_per_minute = 240;
        recording = test::record(test::simulateSweep(truth, brief), {1e-6, 0.01}, seed);
    }
    void reverseValues() {
        for (Channel& channel : recording.channels) std::reverse(channel.values.begin(), channel.values.end());
    }
    void exchangeRows(std::size_t a, std::size_t b) {
        std::swap(recording.time[a], recording.time[b]);
        for (Channel& channel : recording.channels) std::swap(channel.values[a], channel.values[b]);
    }
    /// Every command that reads a recording of a device refuses it with one line and leaves nothing.
    void checkRefused(const std::string& said) const {
        const std::vector<std::string> outputs{"--json", "out.json", "--report", "out.html"};
        for (const char* command : {"inspect", "rigidity", "fit", "diagnose"}) {
            std::vector<std::string> arguments{command, "--model", "model.toml"};
            arguments.insert(arguments.end(), outputs.begin(), outputs.end());
            const auto shown = run(arguments);
            CAPTURE(command, shown.output, shown.errors);
            CHECK(shown.exit_status == 2);
            CHECK(std::count(shown.errors.begin(), shown.errors.end(), '\n') == 1);
            CHECK_THAT(shown.errors, Contains(said));
            CHECK(folder.list() == inputs);
        }
    }

    std::uint64_t seed = test::drawSeed();
    test::TemporaryDirectory folder;
    MountModel truth = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    Recording recording;
};

std::size_t countOf(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

}  // namespace

TEST_CASE("Rows from the last to the first, or shuffled, are refused by the row where time goes back") {
    Laboratory laboratory;
    SECTION("backward") {
        laboratory.reverseValues();
        std::reverse(laboratory.recording.time.begin(), laboratory.recording.time.end());
        laboratory.checkRefused("run.csv:3: time: time goes back, here and in later rows");
    }
    SECTION("shuffled from the row of sample 1000 on") {
        std::mt19937_64 random(laboratory.seed);
        for (std::size_t k = laboratory.recording.sampleCount() - 1; k > 1000; --k)
            laboratory.exchangeRows(k, 1000 + random() % (k - 999));
        const auto& time = laboratory.recording.time;
        const auto back = std::adjacent_find(time.begin(), time.end(), [](double a, double b) { return b <= a; });
        laboratory.checkRefused("run.csv:" + std::to_string(back - time.begin() + 3) + ": time: time goes back");
    }
    SECTION("two neighbours exchanged: dropped, by its row") {
        laboratory.exchangeRows(1000, 1001);
        for (const char* command : {"inspect", "fit"}) {
            const auto shown = laboratory.run({command, "--model", "model.toml"});
            CAPTURE(command, shown.output, shown.errors);
            CHECK(shown.exit_status == 0);
            CHECK_THAT(shown.output, Contains("time goes back, row dropped: row 1003"));
        }
    }
}

TEST_CASE("A recording that runs backwards under rising stamps is said to feed the mount; what fit writes is read") {
    Laboratory laboratory;
    laboratory.reverseValues();
    const auto shown = laboratory.run({"fit", "--model", "model.toml", "-o", "fitted.toml", "--json", "fit.json"});
    CAPTURE(shown.output, shown.errors);
    REQUIRE(shown.exit_status == 0);
    CHECK(countOf(shown.output, "the mount feeds the motion with energy") == 1);
    CHECK_THAT(shown.output, Contains("does the time run backwards, or has a channel the wrong sign?"));

    std::ifstream stream(laboratory.folder.path() + "/fit.json");
    const auto fit = nlohmann::json::parse(stream);
    const MountModel fitted = readMountModel(laboratory.folder.path() + "/fitted.toml");
    int limited = 0;
    for (const auto& parameter : fit.at("parameters")) {
        const auto name = parameter.at("name").get<std::string>();
        const double value = parameter.at("value");
        CAPTURE(name, value);
        if (name.find(".damping") == std::string::npos) continue;
        const auto said = countOf(shown.output, "note: " + name + " is identified as -");
        CHECK(said == (value < 0 ? 1 : 0));
        CHECK(getParameter(fitted, name) == Approx(std::max(0.0, value)));
        if (value < 0) ++limited;
    }
    CHECK(limited > 0);
    const auto read = laboratory.run({"fit", "--model", "fitted.toml"});
    CAPTURE(read.errors);
    CHECK(read.exit_status == 0);
}

TEST_CASE("An inertia that no body has is limited in what fit writes, and said") {
    Laboratory laboratory;
    laboratory.recordStrangeInertia();
    const auto shown = laboratory.run({"fit", "--model", "model.toml", "--free", "body.inertia", "-o", "fitted.toml"});
    CAPTURE(shown.output, shown.errors);
    REQUIRE(shown.exit_status == 0);
    CHECK(countOf(shown.output, "note: body.inertia is identified with the principal moments") == 1);
    const Eigen::Matrix3d inertia = readMountModel(laboratory.folder.path() + "/fitted.toml").body.inertia;
    CHECK(inertia(0, 0) > 1.2 * laboratory.truth.body.inertia(0, 0));  // 0.15 would be flat, 0.12 is believed
    CHECK(inertia(0, 0) < inertia(1, 1) + inertia(2, 2));
    const auto read = laboratory.run({"inspect", "--model", "fitted.toml"});
    CAPTURE(read.errors);
    CHECK(read.exit_status == 0);
}

TEST_CASE("A diagnosis writes only what is read again, an inertia that no body has limited and said") {
    Laboratory laboratory;
    laboratory.recordStrangeInertia();
    const auto shown = laboratory.run({"diagnose", "--model", "model.toml", "-o", "extended.toml"});
    CAPTURE(shown.output, shown.errors);
    REQUIRE(shown.exit_status == 0);
    CHECK(countOf(shown.output, "note: body.inertia is identified with the principal moments") == 1);
    const Eigen::Matrix3d inertia = readMountModel(laboratory.folder.path() + "/extended.toml").body.inertia;
    CHECK(inertia(0, 0) > 1.1 * laboratory.truth.body.inertia(0, 0));
}

TEST_CASE("Accelerations in g labelled m/s^2, and the reverse, are told by side and factor") {
    Laboratory laboratory;
    struct Mistake {
        std::string channels;  // of which the columns are
        double factor;
        std::string first;      // of the channels, as the ratio names it
        std::string group;      // as the comparison with the rigid motion names it
        std::string ratio, as;  // what is said
    };
    const Mistake mistake = GENERATE(
        Mistake{"mobile.1.a", 1 / g, "mobile.1.ax", "mobile.1.ax|ay|az", "about 0.1 times", "in g, labelled m/s^2"},
        Mistake{"mobile.4.az", g, "mobile.4.az", "mobile.4.az", "about 9.8 times", "in m/s^2, labelled g"},
        Mistake{"fixed.2.a", g, "fixed.2.ax", "fixed.2.ax|ay|az", "about 9.8 times", "in m/s^2, labelled g"});
    laboratory.scale(mistake.channels, mistake.factor);
    CAPTURE(mistake.channels, mistake.factor);
    for (const char* command : {"inspect", "rigidity", "fit"}) {
        std::vector<std::string> arguments{command};
        if (arguments.front() != "inspect") arguments.insert(arguments.end(), {"--model", "model.toml"});
        const auto shown = laboratory.run(arguments);
        CAPTURE(command, shown.output, shown.errors);
        CHECK(shown.exit_status == 0);
        CHECK_THAT(shown.output, Contains("contradiction: " + mistake.first) && Contains(mistake.ratio));
        if (arguments.front() != "rigidity") continue;
        CHECK_THAT(shown.output,
                   Contains("Quality: unusable: " + mistake.group + " is") && Contains("(as " + mistake.as + ")"));
    }
}

TEST_CASE("A side with the opposite sign is answered by every command") {
    Laboratory laboratory;
    const auto answers = [&laboratory](const std::string& command) {
        const auto shown = laboratory.run({command, "--model", "model.toml", "--json", "-"});
        CAPTURE(command, shown.errors);
        CHECK(shown.exit_status == 0);
        CHECK(nlohmann::json::accept(shown.output));
    };
    SECTION("quick ones") {
        laboratory.scale(GENERATE("mobile.", "fixed.", "mobile.1."), -1);
        for (const char* command : {"inspect", "rigidity", "fit"}) answers(command);
    }
    // A diagnosis of nonsense tries whatever there is, for a minute or more with sanitizers.
    if (test::kSanitized) return;
    SECTION("diagnose") {
        laboratory.recordBriefly();
        laboratory.scale("mobile.", -1);
        answers("diagnose");
    }
}

TEST_CASE("All accelerations of a side in g are told from its displacements") {
    Laboratory laboratory;
    const std::string part = GENERATE("mobile", "fixed");
    for (Channel& channel : laboratory.recording.channels)
        if (channel.name.rfind(part, 0) == 0 && channel.name[channel.name.size() - 2] == 'a')
            for (double& value : channel.values) value /= g;
    CAPTURE(part);
    {
        const auto shown = laboratory.run({"inspect", "--model", "model.toml"});
        CAPTURE(shown.output);
        CHECK_THAT(shown.output, Contains("Quality: unusable: " + part +
                                          ".*.ax|ay|az is 0.102 times what the others "
                                          "say (as in g, labelled m/s^2)"));
    }
    const auto shown = laboratory.run({"fit", "--model", "model.toml"});
    CAPTURE(shown.output);
    CHECK_THAT(shown.output, Contains("contradiction: " + part + ".1.a") && Contains("about 0.1 times") &&
                                 Contains("accelerations in g labelled m/s^2"));
}

}  // namespace wems
