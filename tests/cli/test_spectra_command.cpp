// identify spectra as a user calls it.
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "run_program.hpp"

using Catch::Contains;
using wems::test::runProgram;
using wems::test::TemporaryDirectory;

namespace {

/// A base that trembles and a mobile part that follows it twice as strongly.
std::string makeRun(double level) {
    std::string text = "time [s],base.az [g],fixed.1.az [g],mobile.1.az [g]\n";
    unsigned state = 7;
    for (int k = 0; k < 4000; ++k) {
        state = 1664525U * state + 1013904223U;
        const double x = level * (state / 4294967296.0 - 0.5);
        const std::string base = std::to_string(x);
        text += std::to_string(k / 1000.0) + "," + base + "," + base + "," + std::to_string(2 * x) + "\n";
    }
    return text;
}

}  // namespace

TEST_CASE("spectra: table, JSON, page of two runs") {
    const TemporaryDirectory folder;
    folder.write("low.csv", makeRun(1));
    folder.write("high.csv", makeRun(3));
    const auto shown = runProgram(
        IDENTIFY_PROGRAM, {"spectra", "low.csv", "high.csv", "--json", "s.json", "--report", "s.html"}, folder.path());
    CAPTURE(shown.output, shown.errors);
    REQUIRE(shown.exit_status == 0);
    CHECK_THAT(shown.output, Contains("low.csv: ") && Contains("high.csv: ") && Contains("degrees of freedom") &&
                                 Contains("driven by base.az") && Contains("mobile.1.az"));
    CHECK(folder.list() == std::vector<std::string>{"high.csv", "low.csv", "s.html", "s.json"});
    const auto data =
        runProgram(IDENTIFY_PROGRAM, {"spectra", "high.csv", "--resolution", "7.8125", "--json", "-"}, folder.path());
    REQUIRE(data.exit_status == 0);
    const auto run = nlohmann::json::parse(data.output).at("runs")[0];
    CHECK(run.at("frequency").size() == 65);
    CHECK(run.at("channels")[2].at("g_rms").get<double>() == Approx(2 * 3 / std::sqrt(12.0)).epsilon(0.05));
    const auto& transfer = run.at("transmissibility")[0];
    CHECK(transfer.at("input") == "fixed.1.az");
    for (std::size_t k = 1; k < 64; ++k) {
        CHECK(transfer.at("h1").at("real")[k].get<double>() == Approx(2).epsilon(1e-4));
        CHECK(transfer.at("coherence")[k].get<double>() > 0.9999);
    }
}

TEST_CASE("wrong uses of spectra: one line, exit status 2, no file") {
    const TemporaryDirectory folder;
    folder.write("run.csv", makeRun(1));
    const auto arguments = GENERATE(values<std::vector<std::string>>({
        {"spectra"},
        {"spectra", "none.csv"},
        {"spectra", "run.csv", "--band", "50:5"},
        {"spectra", "run.csv", "--band", "5"},
        {"spectra", "run.csv", "--resolution", "0"},
        {"spectra", "run.csv", "--resolution", "0.01"},
        {"spectra", "run.csv", "--resolution", "900"},
        {"spectra", "run.csv", "--reference", "load.fz"},
        {"spectra", "run.csv", "--q", "0.3"},
        {"spectra", "run.csv", "--model", "none.toml"},
    }));
    CAPTURE(arguments);
    auto all = arguments;
    all.insert(all.end(), {"--json", "result.json"});
    const auto result = runProgram(IDENTIFY_PROGRAM, all, folder.path());
    CHECK(result.exit_status == 2);
    CHECK(result.output.empty());
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
    CHECK(folder.list() == std::vector<std::string>{"run.csv"});
}
