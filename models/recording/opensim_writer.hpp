/// @file
/// Recordings to OpenSim's text formats.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "models/recording/recording_writer.hpp"

namespace wems {

/// Displacements as positions of markers `mobile.<connection>`, `fixed.<connection>`, mm. Everything else is left out,
/// which the notes say.
class TrcWriter : public RecordingWriter {
public:
    /// Exceptions as openRecordingWriter().
    TrcWriter(const Recording& header, const RowPlan& plan, const std::string& file, const WriteOptions& options);

    void append(const Recording& rows) override;
    std::unique_ptr<AtomicFile> finish() override;

private:
    struct Marker {
        std::string name;
        std::array<int, 3> channels{-1, -1, -1};  ///< index of each axis in the recording; -1 where there is none
        std::array<double, 3> rest{};             ///< m
    };
    void listMarkers(const Recording& header, const WriteOptions& options);
    std::string makeHeader(const RowPlan& plan, const std::string& file) const;

    std::size_t channel_count_;
    int digits_;
    std::vector<Marker> markers_;
    std::size_t frames_ = 0;
    std::unique_ptr<AtomicFile> file_;
};

/// Every channel in SI, labelled by its name (.sto, .mot).
class StorageWriter : public RecordingWriter {
public:
    /// Exceptions as openRecordingWriter().
    StorageWriter(const Recording& header, const RowPlan& plan, const std::string& file, int digits);

    void append(const Recording& rows) override;
    std::unique_ptr<AtomicFile> finish() override;

private:
    std::size_t channel_count_;
    int digits_;
    std::unique_ptr<AtomicFile> file_;
};

}  // namespace wems
