/// @file
/// The page that `identify diagnose --report` writes.
#pragma once

#include <string>
#include <vector>

#include "identify/diagnose/diagnosis.hpp"
#include "models/atomic_file.hpp"
#include "models/device_drawing.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify::cli {

struct DiagnosedRuns {
    const std::vector<Recording>& identification;
    const std::vector<Recording>& validation;  ///< may be empty
    std::vector<DrawnShape> drawing;           ///< of the device
};

/// Verdict, errors, the runs in motion, causes with their ties, restoring forces and free simulations before and after,
/// every round with its candidates and why one was taken or none, and the spectrum of the residual.
/// @param model as given
/// @throws InputError if the file cannot be written
void writeDiagnosisReport(const Diagnosis& diagnosis, const MountModel& model, const DiagnosedRuns& runs,
                          const std::string& title, const std::string& file, OutputFiles& outputs);

}  // namespace wems::identify::cli
