// Reading speed of the formats other than CSV, MB/s of file. Binary files are written here or, for MATLAB, given
// through the environment variables WEMS_BENCH_MAT5, WEMS_BENCH_MAT7 and WEMS_BENCH_MAT73 (scripts/bench_formats.py
// makes them).
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_writer.hpp"

namespace {

/// Nine displacement channels of smooth random numbers.
wems::Recording makeRun(int rows) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    wems::Recording run;
    for (int i = 0; i < rows; ++i) run.time.push_back(i / 2000.0);
    for (const char* name : {"mobile.1.x", "mobile.1.y", "mobile.1.z", "mobile.2.x", "mobile.2.y", "mobile.2.z",
                             "mobile.3.x", "mobile.3.y", "mobile.3.z"}) {
        wems::Channel channel{name, "", {}, 0};
        for (int i = 0; i < rows; ++i) channel.values.push_back(i == 0 ? 0 : 1e-3 * normal(random));
        run.channels.push_back(std::move(channel));
    }
    return run;
}

class TemporaryRun {
public:
    explicit TemporaryRun(const std::string& extension)
        : path_((std::filesystem::temp_directory_path() / ("wems_bench_" + std::to_string(::getpid()) + extension))
                    .string()) {}
    ~TemporaryRun() { std::remove(path_.c_str()); }
    TemporaryRun(const TemporaryRun&) = delete;
    TemporaryRun& operator=(const TemporaryRun&) = delete;
    const std::string& path() const { return path_; }

private:
    std::string path_;
};

/// Dataset 58, double precision, even spacing; directions x y z of the nodes.
void writeUff(const wems::Recording& run, const std::string& path, bool binary) {
    std::ofstream file(path, std::ios::binary);
    int index = 0;
    for (const auto& channel : run.channels) {
        char line[128];
        const auto bytes = static_cast<int>(8 * channel.values.size());
        std::snprintf(line, sizeof line, "%6d\n%6d", -1, 58);
        file << line;
        std::snprintf(line, sizeof line, "b%6d%6d%12d%12d%6d%6d%12d%12d", 1, 2, 11, bytes, 0, 0, 0, 0);
        file << (binary ? line : "") << "\n" << channel.name << "\nNONE\nNONE\nNONE\nNONE\n";
        std::snprintf(line, sizeof line, "%5d%10d%5d%10d %-10s%10d%4d %-10s%10d%4d\n", 1, 0, 0, 0, "NONE",
                      1 + index / 3, 1 + index % 3, "NONE", 0, 0);
        ++index;
        file << line;
        std::snprintf(line, sizeof line, "%10d%10d%10d%13.5e%13.5e%13.5e\n", 4, static_cast<int>(run.time.size()), 1,
                      0.0, 1 / 2000.0, 0.0);
        file << line;
        for (const char* unit : {"s", "m", "NONE", "NONE"}) {
            std::snprintf(line, sizeof line, "%10d%5d%5d%5d %-20s %-20s\n", *unit == 's' ? 17 : 8, 0, 0, 0, "NONE",
                          unit);
            file << line;
        }
        if (binary) {
            file.write(reinterpret_cast<const char*>(channel.values.data()), bytes);
        } else {
            for (std::size_t i = 0; i < channel.values.size(); ++i) {
                std::snprintf(line, sizeof line, "%20.11e", channel.values[i]);
                file << line << (i % 4 == 3 || i + 1 == channel.values.size() ? "\n" : "");
            }
        }
        std::snprintf(line, sizeof line, "%6d\n", -1);
        file << line;
    }
}

const wems::ColumnMap& uffMap() {
    static const wems::ColumnMap map = wems::parseColumnMap(
        "[columns]\n\"1:+X\" = \"mobile.1.x\"\n\"1:+Y\" = \"mobile.1.y\"\n\"1:+Z\" = \"mobile.1.z\"\n\"2:+X\" = "
        "\"mobile.2.x\"\n\"2:+Y\" = \"mobile.2.y\"\n\"2:+Z\" = \"mobile.2.z\"\n\"3:+X\" = \"mobile.3.x\"\n\"3:+Y\" = "
        "\"mobile.3.y\"\n\"3:+Z\" = \"mobile.3.z\"\n",
        "map.toml");
    return map;
}

/// LabVIEW's text file; the time in the first column, or one before each channel.
void writeLvm(const wems::Recording& run, const std::string& path, bool each) {
    std::ofstream file(path, std::ios::binary);
    file << "LabVIEW Measurement\nSeparator\tTab\nX_Columns\t" << (each ? "Multi" : "One")
         << "\n***End_of_Header***\n\nChannels\t" << run.channels.size() << "\nY_Unit_Label";
    const char* gap = each ? "\t" : "";
    for (std::size_t c = 0; c < run.channels.size(); ++c) file << (c > 0 ? gap : "") << "\tm";
    file << "\n***End_of_Header***\nX_Value";
    for (std::size_t c = 0; c < run.channels.size(); ++c)
        file << (c > 0 && each ? "\tX_Value" : "") << "\t" << run.channels[c].name;
    file << "\tComment\n";
    char number[32];
    for (std::size_t k = 0; k < run.time.size(); ++k) {
        for (std::size_t c = 0; c < run.channels.size(); ++c) {
            std::snprintf(number, sizeof number, "%s%.6f", c > 0 ? "\t" : "", run.time[k]);
            file << (c == 0 || each ? number : "");
            std::snprintf(number, sizeof number, "\t%.9f", run.channels[c].values[k]);
            file << number;
        }
        file << "\n";
    }
}

void readFile(benchmark::State& state, const std::string& path, const wems::ColumnMap* map) {
    while (state.KeepRunning()) benchmark::DoNotOptimize(wems::readRecording(path, map));
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(std::filesystem::file_size(path)));
}

void benchOwnWriter(benchmark::State& state, const char* extension) {
    const TemporaryRun file(extension);
    wems::writeRecording(makeRun(100000), file.path());
    readFile(state, file.path(), nullptr);
}

void benchUff(benchmark::State& state, bool binary) {
    const TemporaryRun file(".uff");
    writeUff(makeRun(100000), file.path(), binary);
    readFile(state, file.path(), &uffMap());
}

void benchLvm(benchmark::State& state, bool each) {
    const TemporaryRun file(".lvm");
    writeLvm(makeRun(100000), file.path(), each);
    readFile(state, file.path(), nullptr);
}

void benchGiven(benchmark::State& state, const char* variable) {
    const char* path = std::getenv(variable);
    if (path == nullptr) {
        state.SkipWithError("the environment variable is not set");
        return;
    }
    readFile(state, path, nullptr);
}

BENCHMARK_CAPTURE(benchOwnWriter, csv, ".csv")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchOwnWriter, trc, ".trc")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchOwnWriter, sto, ".sto")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchUff, ascii, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchUff, binary, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchLvm, one_time, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchLvm, each_time, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchGiven, matlab5, "WEMS_BENCH_MAT5")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchGiven, matlab7_compressed, "WEMS_BENCH_MAT7")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(benchGiven, matlab73, "WEMS_BENCH_MAT73")->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
