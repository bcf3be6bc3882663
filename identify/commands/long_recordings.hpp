/// @file
/// Recordings that are too long for the memory that a command may use.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "identify/commands/format.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/fit/block_choice.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::commands {

constexpr std::size_t block_rows = 32768;

/// --memory MB
struct MemoryOption {
    double megabytes = 2000;
};

/// Samples and channels of recordings, from their headers and first rows; nothing unless all of them are files that can
/// be read in blocks (isStreamable).
struct RecordingSize {
    double samples = 0;  ///< of all together
    double channels = 0;
    bool component = false;  ///< of a single element on a test machine
};
std::optional<RecordingSize> estimateSize(const std::vector<RecordingSource>& sources, const ColumnMap* map);

/// What was taken of long recordings, and by which rule.
struct BlockUse {
    std::size_t used = 0, offered = 0;
    double megabytes = 0;
    BlockChoice::Cost cost;

    std::string describe() const;
    nlohmann::json makeJson() const;
};

struct DeviceRuns {
    std::vector<RunMotion> runs;
    std::vector<std::string> notes;
    std::optional<BlockUse> blocks;  ///< of runs that are blocks of recordings
};

/// True if a fit of these recordings as a whole would need more memory than given.
bool exceedsMemory(const RecordingSize& size, const MountModel& model, const FitOptions& options,
                   const MemoryOption& memory);

/// Reads the recordings block by block and keeps as many blocks as the memory allows (BlockChoice).
/// @param use channels of both parts, as keepOnly()
/// @throws InputError as RecordingStream; not enough memory for one block
DeviceRuns chooseBlocks(const std::vector<RecordingSource>& sources, const ColumnMap* map, const MountModel& model,
                        const FitOptions& options, const std::string& use, const RecordingSize& size,
                        const MemoryOption& memory, Watcher& watcher);

}  // namespace wems::identify::commands
