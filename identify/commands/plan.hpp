/// @file
/// The next test, which run would tell what the recordings leave open.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "identify/commands/format.hpp"
#include "identify/commands/long_recordings.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/plan/plan.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"

namespace wems::identify::commands {

struct PlanRequest {
    RunSelection runs;
    PlanOptions plan;
    MemoryOption memory;
    std::string use = "all";  ///< channels of both parts: `all`, `displacements`, `accelerations`
    std::string model_file;   ///< that the proposed commands name; empty: that of the model
};

struct PlanAnswer {
    Plan plan;
    MountModel start, fitted;  ///< before, and after within what a model may hold
    std::string model_file;    ///< that the proposed commands name
    ResultRecord record;
};

/// @throws InputError
PlanAnswer runPlan(PlanRequest request, Watcher& watcher);

nlohmann::json toJson(const PlanAnswer& answer);
std::string formatText(const PlanAnswer& answer, TextStyle style);
void writeReport(const PlanAnswer& answer, const std::string& file, OutputFiles& outputs);

// A plan as table, data and page.

/// @param model_file that the command lines of the proposals name
std::string formatPlan(const Plan& plan, const std::string& model_file, TextStyle style);
nlohmann::json makePlanJson(const Plan& plan, const std::string& model_file);
/// @throws InputError if the file cannot be written
void writePlanReport(const Plan& plan, const std::string& model_file, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
