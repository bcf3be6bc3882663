// simulate --modes, --frf, --psd as a user calls them.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "models/common/units.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/plugin/simulate_command.hpp"

using namespace wems::test;

namespace {

/// A body of 2 kg on one connection at its centre of gravity, the same along each axis, hanging in gravity.
void writeOscillator(const TemporaryDirectory& folder, double damping) {
    std::ofstream file(folder.path() + "/oscillator.toml");
    file << "gravity = [0.0, 0.0, -9.81]\n[body]\nmass = 2.0\ninertia = [0.1, 0.1, 0.1]\n[[connection]]\nname = \"1\"\n"
            "position = [0.0, 0.0, 0.0]\n";
    for (const char axis : {'x', 'y', 'z'})
        file << "[connection." << axis << "]\nstiffness = 2.0e4\ndamping = " << damping
             << "\nstops = [{side = \"-\", clearance = 5e-3, stiffness = 1e5}]\n";
}

void writeFile(const TemporaryDirectory& folder, const std::string& name, const std::string& text) {
    std::ofstream(folder.path() + "/" + name) << text;
}

}  // namespace

TEST_CASE("modes: the contract's keys, sag and clearance left by hand") {
    const TemporaryDirectory folder;
    writeOscillator(folder, 20);
    const Json result = runJson(folder, {"oscillator.toml", "--modes", "--report", "modes.html"});
    const Json& modes = result.at("modes");
    REQUIRE(modes.size() == 6);
    const double omega = std::sqrt(2e4 / 2), zeta = 20 / (2 * std::sqrt(2e4 * 2));
    CHECK(modes[5].at("frequency").get<double>() == Approx(omega / wems::kTwoPi).epsilon(1e-9));
    CHECK(modes[5].at("damping_ratio").get<double>() == Approx(zeta).epsilon(1e-9));
    CHECK(modes[0].at("frequency") == 0);  // nothing holds the rotations
    double mass = 0;
    for (const Json& mode : modes) mass += mode.at("effective_mass").at("y").get<double>();
    CHECK(mass == Approx(2).epsilon(1e-9));
    const double sag = 2 * 9.81 / 2e4;
    const Json& rest = result.at("static");
    CHECK(rest.at("displacement").at("z").get<double>() == Approx(-sag).epsilon(1e-9));
    CHECK(rest.at("connections")[0].at("force").at("z").get<double>() == Approx(-2 * 9.81).epsilon(1e-9));
    for (const Json& stop : rest.at("stops"))
        CHECK(stop.at("left").get<double>() == Approx(stop.at("name") == "1.z.-" ? 5e-3 - sag : 5e-3).epsilon(1e-9));
    CHECK(folder.list() == std::vector<std::string>{"modes.html", "oscillator.toml"});
}

TEST_CASE("transfer functions and random response: curves as JSON and CSV") {
    const TemporaryDirectory folder;
    writeOscillator(folder, 20);
    writeFile(folder, "psd.csv", "frequency [Hz],psd [g^2/Hz]\n5,0.001\n100,0.001\n");
    const Json frf = runJson(folder, {"oscillator.toml", "--frf", "5:50", "--base-acceleration", "z", "-o", "frf.csv"});
    const Json& transfer = frf.at("transfer");
    REQUIRE(transfer.at("outputs").size() == 12);
    const Json& q = transfer.at("outputs")[2];
    CHECK(q.at("name") == "relative.1.z");
    CHECK(transfer.at("frequency").front() == 5.0);
    CHECK(transfer.at("frequency").back() == 50.0);
    const double w = wems::kTwoPi * 5;
    const std::complex<double> H = -2.0 / std::complex<double>(2e4 - 2 * w * w, 20 * w);
    CHECK(q.at("real")[0].get<double>() == Approx(H.real()).epsilon(1e-8));
    CHECK(q.at("imaginary")[0].get<double>() == Approx(H.imag()).epsilon(1e-8));
    std::ifstream csv(folder.path() + "/frf.csv");
    std::string line;
    std::size_t rows = 0;
    while (std::getline(csv, line)) {
        if (line.rfind("frequency", 0) == 0) CHECK(line.find("relative.1.z.real [(m)/(m/s^2)]") != std::string::npos);
        rows += line.find('#') != 0;
    }
    CHECK(rows == transfer.at("frequency").size() + 1);

    const Json random = runJson(folder, {"oscillator.toml", "--modes", "--psd", "psd.csv", "--base-acceleration", "z"});
    // White noise: mean square of the displacement S/(8 ζ ω³), nearly all of it within 5 to 100 Hz.
    const double omega = std::sqrt(1e4), zeta = 0.05, S = 0.001 * std::pow(9.80665, 2);
    CHECK(random.at("random").at("outputs")[2].at("rms").get<double>() ==
          Approx(std::sqrt(S / (8 * zeta * std::pow(omega, 3)))).epsilon(0.02));
    // An RMS on the command line scales the spectrum.
    const Json scaled =
        runJson(folder, {"oscillator.toml", "--modes", "--psd", "psd.csv", "--base-acceleration", "z=0.5g"});
    CHECK(scaled.at("random").at("outputs")[11].at("rms").get<double>() == Approx(0.5 * 9.80665).epsilon(1e-8));
}

TEST_CASE("a simulated random test has the RMS that the linear model's spectrum gives") {
    const TemporaryDirectory folder;
    writeOscillator(folder, 100);  // ζ = 0.25
    writeFile(folder, "psd.csv", "5,0.002\n100,0.002\n");
    const Json random = runJson(folder, {"oscillator.toml", "--modes", "--psd", "psd.csv", "--base-acceleration", "x"});
    runSimulate(folder, {"oscillator.toml", "--psd", "psd.csv", "--base-acceleration", "x", "--duration", "20",
                         "--seed", "5", "--quiet", "-o", "run.csv"});
    const wems::Recording recording = wems::readRecording(folder.path() + "/run.csv");
    const auto& mobile = recording.find("mobile.1.x")->values;
    const auto& fixed = recording.find("fixed.1.x")->values;
    const auto& base = recording.find("base.ax")->values;
    double square = 0, base_square = 0;
    const std::size_t from = 1000;  // after the start from rest has died away
    for (std::size_t k = from; k < mobile.size(); ++k) square += std::pow(mobile[k] - fixed[k], 2);
    for (std::size_t k = 1; k < base.size(); ++k) base_square += base[k] * base[k];
    const double rms = std::sqrt(square / double(mobile.size() - from));
    // Exactly the spectrum's over the whole run.
    CHECK(std::sqrt(base_square / double(base.size() - 1)) == Approx(9.80665 * std::sqrt(0.002 * 95)).epsilon(1e-4));
    // Bandwidth π ζ f = 12.5 Hz over 19 s: standard deviation 1/(2 √(B T)) = 3.2 %; four of them, once in 16 000 seeds.
    // A spectrum taken as two-sided is 41 % off, nine standard deviations beyond the limit.
    CHECK(rms == Approx(random.at("random").at("outputs")[0].at("rms").get<double>()).epsilon(0.13));
}

TEST_CASE("wrong uses of --modes, --frf and --psd: one line, exit status 2, no file") {
    const TemporaryDirectory folder;
    writeFile(folder, "psd.csv", "5,0.001\n100,0.001\n");
    writeFile(folder, "force.csv", "f [Hz],S [N^2/Hz]\n5,1\n100,1\n");
    writeFile(folder, "bad.csv", "5,0.001\n4,0.001\n");
    const auto arguments = GENERATE(values<std::vector<std::string>>({
        {single_axis, "--modes", "--sweep", "5:50"},
        {single_axis, "--modes", "--force", "z"},
        {single_axis, "--modes", "-o", "modes.csv"},
        {single_axis, "--frf", "5:50"},
        {single_axis, "--frf", "50:5", "--base-acceleration", "z"},
        {single_axis, "--frf", "5", "--base-acceleration", "z"},
        {single_axis, "--frf", "5:50", "--force", "z"},  // no bracket
        {single_axis, "--frf", "5:50", "--base-acceleration", "z=1mm"},
        {single_axis, "--modes", "--psd", "psd.csv"},
        {single_axis, "--modes", "--psd", "none.csv", "--base-acceleration", "z"},
        {single_axis, "--psd", "force.csv", "--base-acceleration", "z"},
        {single_axis, "--psd", "bad.csv", "--base-acceleration", "z"},
        {single_axis, "--psd", "psd.csv", "--base-acceleration", "x,y=1g"},
        {single_axis, "--psd", "psd.csv", "--base-acceleration", "z", "--duration", "0.01"},
        {smallsat, "--psd", "psd.csv", "--force", "z"},
        {smallsat, "--dwell", "20:1", "--force", "z"},
        {smallsat, "--dwell", "20:1", "--force", "z=200g"},
        {single_axis, "--random", "5:50:1", "--base-displacement", "z=1mm"},
        {single_axis, "--dwell", "20:1", "--base-displacement", "z=1g"},
        {single_axis, "--dwell", "20:1", "--fade", "0.1", "--base-displacement", "z=1mm"},
        {single_axis, "--dwell", "20:1", "--base-acceleration", "z=1", "--base-displacement", "z=1mm"},
        {single_axis, "--modes", "--base-displacement", "z=1mm"},
    }));
    checkRefused(folder, arguments);
}

TEST_CASE("units on the command line") {
    const TemporaryDirectory folder;
    const auto run = [&](const std::string& level, const std::string& file) {
        runSimulate(folder, {single_axis, "--dwell", "12:0.1", "--base-acceleration", level, "--quiet", "-o", file});
        return wems::readRecording(folder.path() + "/" + file).find("base.az")->values;
    };
    const auto in_g = run("z=0.1g", "g.csv"), in_si = run("z=0.980665", "si.csv");
    for (std::size_t k = 0; k < in_g.size(); ++k) CHECK(in_g[k] == Approx(in_si[k]).margin(1e-12));
}

TEST_CASE("a base driven by displacement moves as commanded") {
    const TemporaryDirectory folder;
    runSimulate(folder, {single_axis, "--sweep", "5:40", "--rate", "60", "--base-displacement", "z=0.1mm", "--quiet",
                         "-o", "run.csv"});
    const wems::Recording run = wems::readRecording(folder.path() + "/run.csv");
    const auto& x = run.find("fixed.mount.z")->values;
    for (std::size_t k = 0; k < x.size(); k += 37) {
        const double t = run.time[k], phase = wems::kTwoPi * 5 * (std::exp2(t) - 1) / std::log(2.0);
        CHECK(x[k] == Approx(1e-4 * std::sin(phase)).margin(2e-10));
    }
}
