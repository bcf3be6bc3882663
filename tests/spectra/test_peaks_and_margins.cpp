// Resonances of an oscillator in closed form; strokes and clearances of a motion that is known.
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/spectra/margins.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;

TEST_CASE("peaks: frequency, height and damping of two oscillators, largest first") {
    const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(4001, 0, 100);
    const auto amplitude = [&](double f0, double zeta, double gain) {
        Eigen::VectorXd h(f.size());
        for (Eigen::Index k = 0; k < f.size(); ++k) {
            const double r = f[k] / f0;
            h[k] = gain / std::hypot(1 - r * r, 2 * zeta * r);
        }
        return h;
    };
    const Eigen::VectorXd sum =
        (amplitude(20, 0.02, 1).array().square() + amplitude(60, 0.03, 0.5).array().square()).sqrt();
    const auto peaks = findPeaks(f, sum, 5, 95);
    REQUIRE(peaks.size() == 2);
    CHECK(peaks[0].frequency == Approx(20 * std::sqrt(1 - 2 * 0.02 * 0.02)).margin(0.02));
    CHECK(peaks[0].amplitude == Approx(1 / (2 * 0.02)).epsilon(0.01));
    CHECK(peaks[0].damping_ratio == Approx(0.02).epsilon(0.05));
    CHECK(peaks[1].frequency == Approx(60).margin(0.1));
    CHECK(peaks[1].amplitude == Approx(0.5 / (2 * 0.03)).epsilon(0.02));
    CHECK(peaks[1].damping_ratio == Approx(0.03).epsilon(0.1));
    CHECK(findPeaks(f, sum, 30, 50).empty());
    CHECK(findPeaks(f, Eigen::VectorXd::Ones(f.size()).eval(), 5, 95).empty());
}

TEST_CASE("margins: stroke, root mean square, force and what is left of the clearances") {
    MountModel model;
    model.body.mass = 1;
    model.body.free = {false, false, true, false, false, false};
    model.connections.resize(1);
    model.connections[0].name = "a";
    AxisLaw& law = model.connections[0].axis[2];
    law.stiffness = 1e4;
    law.stops = {{Side::positive, 3e-3, 1e6, 0}, {Side::negative, 1e-3, 1e6, 0}};
    Recording recording;
    for (const char* part : {"mobile", "fixed"})
        for (const char* axis : {"x", "y", "z"})
            recording.channels.push_back({std::string(part) + ".a." + axis, "m", {}, 0});
    for (int k = 0; k < 1000; ++k) {
        recording.time.push_back(1e-3 * k);
        for (Channel& channel : recording.channels) channel.values.push_back(0);
        recording.channels[2].values.back() = 2e-3 * std::sin(kTwoPi * 10 * recording.time.back());
        recording.channels[5].values.back() = 0.5e-3 * std::sin(kTwoPi * 10 * recording.time.back());
    }
    for (const MountModel* known : {static_cast<const MountModel*>(nullptr), static_cast<const MountModel*>(&model)}) {
        const Margins margins = findMargins(recording, known);
        const ConnectionMargin* z = nullptr;
        for (const auto& margin : margins.connections)
            if (margin.name == "a.z") z = &margin;
        REQUIRE(z != nullptr);
        CHECK(z->highest == Approx(1.5e-3).epsilon(1e-3));
        CHECK(z->lowest == Approx(-1.5e-3).epsilon(1e-3));
        CHECK(z->rms == Approx(1.5e-3 / std::sqrt(2.0)).epsilon(1e-3));
        CHECK(z->left_positive.has_value() == (known != nullptr));
        if (known == nullptr) continue;
        CHECK(*z->left_positive == Approx(1.5e-3).epsilon(2e-3));
        CHECK(*z->left_negative == Approx(-0.5e-3).epsilon(2e-3));
        CHECK(*z->largest_force == Approx(1e4 * 1.5e-3 + 1e6 * 0.5e-3).epsilon(3e-3));
    }
}
