/// @file
/// Which channels share a picture, and in what unit they are shown.
#pragma once

#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "identify/inspect/inspection.hpp"
#include "identify/inspect/quality.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

/// In what a channel is shown: displacements of mounts are read in millimetres.
struct ShownUnit {
    std::string name;
    double factor;
};
ShownUnit showUnit(const std::string& unit);

/// Channels of one part and one unit.
struct ChannelGroup {
    std::string title;  ///< `mobile, displacement`
    ShownUnit unit;
    std::vector<std::size_t> members;
};

/// @param channels name and SI unit of each
std::vector<ChannelGroup> groupChannels(const std::vector<std::pair<std::string, std::string>>& channels);

// The verdict on a recording as data.

/// `{"verdict", "reasons", "faults": [{"kind", "channel", …}], "checked", "contradiction"}`
nlohmann::json makeQualityJson(const QualityVerdict& verdict);

}  // namespace wems::identify::commands

namespace wems {

// An inspection for readers: on the terminal, and as a page with pictures.

class HtmlReport;

}  // namespace wems

namespace wems::identify::commands {

/// Tables and sentences for the terminal.
std::string formatInspection(const Inspection& inspection, const Recording& recording, TextStyle style);

/// One page for all recordings: tables, levels against frequency, phase along the sweep.
class InspectReport {
public:
    InspectReport();
    ~InspectReport();
    InspectReport(const InspectReport&) = delete;
    InspectReport& operator=(const InspectReport&) = delete;

    void add(const Inspection& inspection, const Recording& recording);
    void write(const std::string& file, OutputFiles& outputs) const;

private:
    std::unique_ptr<HtmlReport> page_;
};

}  // namespace wems::identify::commands
