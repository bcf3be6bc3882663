#include "identify/commands/long_recordings.hpp"

#include <algorithm>
#include <cmath>

#include "identify/commands/recordings.hpp"
#include "identify/component/component_data.hpp"
#include "identify/inspect/connection_checks.hpp"
#include "identify/inspect/inspection.hpp"
#include "models/common/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_stream.hpp"

namespace wems::identify::commands {
namespace {

constexpr double megabyte = 1e6;
constexpr double passing = 1.5;      // of block_rows, the longest block that passes by
constexpr double fixed_memory = 60;  // MB, of the program and of reading

double calcBlockMemory(const RecordingSize& size, const MountModel& model, const FitOptions& options) {
    return static_cast<double>(block_rows) * (sizeof(double) * size.channels + calcFitMemory(model, options)) /
           megabyte;
}

}  // namespace

std::optional<RecordingSize> estimateSize(const std::vector<RecordingSource>& sources, const ColumnMap* map) {
    RecordingSize size;
    for (const RecordingSource& source : sources) {
        if (source.loaded || !isStreamable(source.file)) return std::nullopt;
        const RecordingStream stream(source.file, map, block_rows);
        const Recording& header = stream.header();
        size.samples += stream.expectedSamples();
        size.channels = std::max(size.channels, static_cast<double>(header.channels.size()));
        size.component = size.component || isComponentTest(header);
    }
    return size;
}

std::string BlockUse::describe() const {
    std::string text = "used " + std::to_string(used) + " of " + std::to_string(offered) + " blocks of " +
                       std::to_string(block_rows) + " rows (--memory " + formatNumber(megabytes) +
                       "), chosen by the information that they hold on all parameters (D-optimal)";
    if (used < offered)
        text +=
            "; standard errors are about " + formatNumber(cost.median, 2) + " times those of all blocks" +
            (cost.parameter.empty() ? "" : ", at most " + formatNumber(cost.largest, 2) + " (" + cost.parameter + ")");
    return text;
}

nlohmann::json BlockUse::makeJson() const {
    return {{"used", used},
            {"of", offered},
            {"rows", block_rows},
            {"memory_MB", megabytes},
            {"chosen_by", "largest determinant of the information on all parameters"},
            {"standard_errors_over_all", {{"median", cost.median}, {"largest", cost.largest}}}};
}

bool exceedsMemory(const RecordingSize& size, const MountModel& model, const FitOptions& options,
                   const MemoryOption& memory) {
    const double bytes = size.samples * (sizeof(double) * size.channels + calcFitMemory(model, options));
    return bytes / megabyte + fixed_memory > memory.megabytes;
}

DeviceRuns chooseBlocks(const std::vector<RecordingSource>& sources, const ColumnMap* map, const MountModel& model,
                        const FitOptions& options, const std::string& use, const RecordingSize& size,
                        const MemoryOption& memory, Watcher& watcher) {
    const double each = calcBlockMemory(size, model, options);
    const double room = memory.megabytes - fixed_memory - passing * each;
    if (room < each)
        throw InputError(
            {"", 0, "--memory"}, "is too small for a block of " + std::to_string(block_rows) + " rows",
            "at least " + formatNumber(std::ceil(fixed_memory + (1 + passing) * each)) + " for this model");
    BlockChoice choice(model, options, static_cast<std::size_t>(room / each));
    BlockNotes notes;
    for (const RecordingSource& source : sources) {
        const std::string& file = source.file;
        RecordingStream stream(file, map, block_rows);
        Recording block;
        while (stream.next(block)) {
            checkConnections(block, model);
            checkRigidBound(block, model);
            keepOnly(use, block);
            RunMotion motion = estimateMotion(block, model);
            for (const auto& warning : block.warnings) notes.add(file + ": " + warning);
            for (const auto& note : motion.notes) notes.add(file + ": " + note);
            choice.offer(std::move(motion));
            watcher.onProgress(stream.fractionRead(), "blocks of " + file);
        }
    }
    DeviceRuns result;
    result.blocks = BlockUse{choice.keptCount(), choice.offeredCount(), memory.megabytes, choice.calcCost()};
    result.runs = choice.takeBlocks();
    result.notes = notes.list();
    result.notes.push_back(result.blocks->describe());
    return result;
}

}  // namespace wems::identify::commands
