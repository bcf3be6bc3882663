/// @file
/// A fit as a page with pictures: values, what is not known, curves on the data, what the equations leave, the motion.
#pragma once

#include <string>
#include <vector>

#include "identify/fit/fit.hpp"
#include "identify/motion/motion.hpp"
#include "models/atomic_file.hpp"
#include "models/device_drawing.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::cli {

struct ReportedFit {
    const FitResult& fit;
    const MountModel& start;  ///< what the fit started from
    const std::vector<RunMotion>& runs;
    const std::vector<Recording>& recordings;  ///< of the runs; none where the runs are blocks of long recordings
    const std::vector<std::string>& notes;
    std::vector<DrawnShape> drawing;  ///< of the device
};

/// @throws InputError if the file cannot be written
void writeFitReport(const ReportedFit& reported, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::cli
