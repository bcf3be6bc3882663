#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "identify/problem/smoothing_kernel.hpp"
#include "models/common/units.hpp"

using namespace wems;
using namespace wems::identify;

// A sine that the kernel passes: its smoothed derivatives are those of the smoothed sine. A transition that ends near
// the Nyquist frequency is the hardest, since sampling folds what the kernel holds beyond it.
TEST_CASE("Smoothed derivatives are derivatives of the smoothed signal", "[smoothing kernel]") {
    constexpr double interval = 1e-3;
    constexpr int samples = 4000, edge = 200;
    const Eigen::VectorXd time = Eigen::VectorXd::LinSpaced(samples, 0, (samples - 1) * interval);
    for (const double pass : {60.0, 220.0, 275.0}) {
        const SmoothingKernel kernel(interval, pass, 1.727 * pass);
        for (const double frequency : {5.0, 20.0, 50.0, 100.0, 200.0, 247.0}) {
            if (frequency > 0.9 * pass) continue;
            CAPTURE(pass, frequency);
            const double w = kTwoPi * frequency;
            const Eigen::RowVectorXd sine = (w * time.array()).sin(), cosine = (w * time.array()).cos();
            const auto inside = [](const Eigen::MatrixXd& row) { return row.middleCols(edge, samples - 2 * edge); };
            const Eigen::MatrixXd smooth = inside(kernel.apply(sine, 0, 1));
            CHECK((smooth - inside(sine)).cwiseAbs().maxCoeff() < 2e-4);
            const Eigen::MatrixXd first = inside(kernel.apply(cosine, 1, 1)), second = inside(kernel.apply(sine, 2, 1));
            CHECK((first + w * smooth).cwiseAbs().maxCoeff() < 1e-5 * w);
            CHECK((second + w * w * smooth).cwiseAbs().maxCoeff() < 1e-5 * w * w);
        }
    }
}
