// Reading and writing recordings, MB/s. scripts/bench_csv.py compares with pandas and NumPy on the same files: it names
// a file of its own through the environment variable WEMS_BENCH_CSV.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "models/recording/csv_reader.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"

namespace {

/// A file of `columns` columns of numbers of about eight characters, `channels` of which have a channel's name.
class SampleFile {
public:
    SampleFile(int columns, int channels, int rows) {
        path_ =
            (std::filesystem::temp_directory_path() / ("wems_bench_" + std::to_string(::getpid()) + ".csv")).string();
        std::ofstream stream(path_, std::ios::binary);
        std::string text = "time [s]";
        for (int j = 1; j < columns; ++j) {
            const bool channel = j % (columns / channels) == 0;
            text += (channel ? ",mobile." : ",other.") + std::to_string(j) + ".x [mm]";
        }
        std::mt19937 random(1);
        std::normal_distribution<> value(0, 0.5);
        for (int i = 0; i < rows; ++i) {
            char number[32];
            std::snprintf(number, sizeof number, "\n%.6f", i * 0.0005);
            text += number;
            for (int j = 1; j < columns; ++j) {
                std::snprintf(number, sizeof number, ",%.5f", value(random));
                text += number;
            }
            if (text.size() > 1000000) {
                stream << text;
                text.clear();
            }
        }
        stream << text << "\n";
    }
    ~SampleFile() { std::remove(path_.c_str()); }
    SampleFile(const SampleFile&) = delete;
    SampleFile& operator=(const SampleFile&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

void readRepeatedly(benchmark::State& state, const std::string& path) {
    while (state.KeepRunning()) benchmark::DoNotOptimize(wems::readRecording(path));
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(path));
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * size);
}

void benchReadAll(benchmark::State& state) {
    const SampleFile file(static_cast<int>(state.range(0)), static_cast<int>(state.range(0)),
                          1500000 / static_cast<int>(state.range(0)));
    readRepeatedly(state, file.path());
}

void benchReadSixOfThousand(benchmark::State& state) {
    const SampleFile file(1000, 6, 3000);
    readRepeatedly(state, file.path());
}

void benchReadGiven(benchmark::State& state) {
    const char* path = std::getenv("WEMS_BENCH_CSV");
    if (path == nullptr) {
        state.SkipWithError("WEMS_BENCH_CSV is not set");
        return;
    }
    readRepeatedly(state, path);
}

void benchWrite(benchmark::State& state) {
    const SampleFile file(28, 28, 50000);
    const auto recording = wems::readRecording(file.path());
    const std::string target = file.path() + ".out";
    while (state.KeepRunning()) wems::writeCsv(recording, target);
    const auto size = static_cast<std::int64_t>(std::filesystem::file_size(target));
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * size);
    std::remove(target.c_str());
}

BENCHMARK(benchReadAll)->Arg(28)->Arg(50)->Unit(benchmark::kMillisecond);
BENCHMARK(benchReadSixOfThousand)->Unit(benchmark::kMillisecond);
BENCHMARK(benchReadGiven)->Unit(benchmark::kMillisecond);
BENCHMARK(benchWrite)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
