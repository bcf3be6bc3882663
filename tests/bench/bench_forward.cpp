// Whole sweep of the shipped small-satellite mount: 49.8 s, 5 to 50 Hz, load in z, sampled at 1 kHz. The counter
// `real_time_factor` is simulated over computing time on one core. 200 N: no stop is reached; 300 N: one; 500 N:
// several.
#include <benchmark/benchmark.h>

#include "identify/forward/forward_model.hpp"
#include "identify/forward/step_size.hpp"
#include "models/excitation.hpp"

using namespace wems;
using namespace wems::identify;

namespace {

constexpr double sample_interval = 1e-3;

void simulateSweep(benchmark::State& state) {
    const MountModel model = readMountModel(WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml");
    const auto sweep = makeLogarithmicSweep(5, 50, 4);
    TimeGrid grid;
    grid.interval = sample_interval;
    grid.samples = static_cast<int>(sweep->duration() / sample_interval) + 1;
    grid.steps_per_sample = chooseStepsPerSample(model, sample_interval);
    std::vector<double> time;
    Eigen::Matrix3Xd load = Eigen::Matrix3Xd::Zero(3, grid.samples);
    for (int k = 0; k < grid.samples; ++k) {
        time.push_back(grid.sampleTime(k));
        load(2, k) = static_cast<double>(state.range(0)) * sweep->value(time.back());
    }
    const Drive drive = Drive::makeLoad(time, load, {}, grid);
    for ([[maybe_unused]] auto _ : state) {
        // The parameters change from run to run: the model is built anew.
        benchmark::DoNotOptimize(ForwardModel(model).simulate(drive).q.data());
    }
    state.counters["real_time_factor"] =
        benchmark::Counter(sweep->duration() * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

}  // namespace

BENCHMARK(simulateSweep)
    ->Arg(200)
    ->Arg(300)
    ->Arg(500)
    ->Unit(benchmark::kMillisecond)
    ->Repetitions(5)
    ->ReportAggregatesOnly();

BENCHMARK_MAIN();
