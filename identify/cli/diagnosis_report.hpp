/// @file
/// The page that `identify diagnose --report` writes.
#pragma once

#include <string>

#include "identify/diagnose/diagnosis.hpp"
#include "models/report/motion_scene.hpp"

namespace wems::identify::cli {

/// Verdict, errors, the runs in motion, causes with their ties, every round with its candidates and why one was taken
/// or none, the places where the residual can sit, and its spectrum before and after.
/// @throws InputError if the file cannot be written
void writeDiagnosisReport(const Diagnosis& diagnosis, const std::string& title, const MotionScene& motion,
                          const std::string& file);

}  // namespace wems::identify::cli
