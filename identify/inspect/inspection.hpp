/// @file
/// What is in a recording, what is suspicious about it, and what can be identified from it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "identify/inspect/channel_statistics.hpp"
#include "identify/inspect/order_tracking.hpp"
#include "identify/inspect/quality.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// Notes on the blocks of a long recording.

/// Keeps one of the notes that differ in their numbers only.
class BlockNotes {
public:
    void add(const std::string& note);
    /// In the order in which they came, with the number of others like each.
    std::vector<std::string> list() const;

private:
    struct Note {
        std::string text;
        long blocks = 0;
    };
    std::map<std::string, std::size_t> index_;
    std::vector<Note> notes_;
};

// What can be identified from a recording.

/// Whether the relative displacements of the rigid motions pass each stop's clearance, connection by connection, axis
/// by axis; empty if the motions cannot be recovered.
std::vector<bool> findReachedStops(const Recording& recording, const MountModel& model);

/// One sentence for each thing that can or cannot be told; the drive, the motion of each part (with a model: which of
/// the six motions its channels leave open), component tests, stops that are reached.
/// @param recording its channels' names count
/// @param model may be null
/// @param reached findReachedStops(); not looked at without a model
std::vector<std::string> describeAbilities(const Recording& recording, const MountModel* model,
                                           const std::vector<bool>& reached);

struct Inspection {
    std::size_t samples = 0;
    std::size_t blocks = 1;
    double rate = 0;       ///< Hz, mean
    double duration = 0;   ///< s
    SweptFrequency swept;  ///< of several blocks the band alone: `hertz` is empty
    std::vector<ChannelStatistics> channels;
    OrderTracking orders;
    std::vector<Finding> findings;       ///< of reading and of the signals, in order of time
    std::vector<std::string> abilities;  ///< one sentence each
    std::vector<std::string> notes;
    QualityVerdict quality;  ///< of several blocks by their findings alone
};

/// @param model may be null; with it, exchanged and missing connections and channels that are not rigid are findings
/// too
Inspection inspect(const Recording& recording, const MountModel* model);

/// The same of a recording that comes in blocks which overlap by a sample (RecordingStream), in memory that does not
/// depend on their number.
///
/// Levels and spectra are those of the whole recording. Findings are made in each block and put together by kind and
/// channel, with the number of blocks; offset, drift and hum, which have to be there most of the time, count if they
/// are in most blocks. The drive is a sine, or several at once, if it is that in most blocks.
class Inspector {
public:
    /// @param model may be null; must outlive the object
    explicit Inspector(const MountModel* model) : model_(model) {}

    /// @throws InputError as makeUniform()
    void add(const Recording& block);
    /// @throws InputError if there was no block
    Inspection finish();

private:
    struct Found {
        Finding first;
        std::size_t blocks = 0;
    };

    void addDrive(const SweptFrequency& swept);
    void addWithModel(const Recording& block, std::vector<Finding>& findings);
    void addFindings(const std::vector<Finding>& findings);
    std::vector<Finding> listFindings() const;

    const MountModel* model_;
    Recording names_;  // of the first block, without values
    double first_time_ = 0, last_time_ = 0;
    std::size_t samples_ = 0, blocks_ = 0, sine_blocks_ = 0, tone_blocks_ = 0;
    std::vector<ChannelLevels> levels_;
    SweptFrequency swept_;
    OrderTracking orders_;  // of the first block
    OrderEnvelope envelope_;
    std::vector<Found> found_;
    std::vector<bool> reached_;
    BlockNotes notes_;
};

/// Only the findings that need no model: what inspect() looks for in time stamps and signals.
std::vector<Finding> findDefects(const Recording& recording, const SweptFrequency& swept);

}  // namespace wems::identify
