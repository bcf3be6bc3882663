/// @file
/// An inspection for readers: on the terminal, and as a page with pictures.
#pragma once

#include <memory>
#include <string>

#include "identify/inspect/inspection.hpp"
#include "models/atomic_file.hpp"
#include "models/terminal.hpp"

namespace wems {
class HtmlReport;
}

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
