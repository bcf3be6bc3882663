/// @file
/// A fit as data, as tables, as a model that every command reads, and as a page with pictures: values, what is not
/// known, curves on the data, what the equations leave, the motion.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/motion/motion.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/text_table.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::commands {

using Timing = std::vector<std::pair<std::string, double>>;  ///< step, s

nlohmann::json makeFitJson(const FitResult& fit, const std::vector<std::string>& notes, const Timing& timing);
Table makeParameterTable(const FitResult& fit);
/// What is not known one by one.
Table makeOpenTable(const FitResult& fit);
std::string describeResidual(const FitResult& fit);

/// Adds a fitted model to the outputs.
/// @param fitted within what a model may hold (makeAdmissible)
/// @throws InputError if a fitted value still keeps it from being a model
void addFittedModel(const MountModel& fitted, const std::string& file, OutputFiles& outputs);

struct ReportedFit {
    const FitResult& fit;
    const MountModel& start;  ///< what the fit started from
    const std::vector<RunMotion>& runs;
    const std::vector<Recording>& recordings;  ///< of the runs; none where the runs are blocks of long recordings
    const std::vector<std::string>& notes;
};

/// @throws InputError if the file cannot be written
void writeFitReport(const ReportedFit& reported, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::commands
