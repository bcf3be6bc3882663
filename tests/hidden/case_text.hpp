/// @file
/// A hidden case as text: the models as TOML and the truth as JSON.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/hidden/random_case.hpp"

namespace wems::hidden {

/// Of the device that is handed out, with what its set-up adds; the bracket's modes are in `bracket_file` beside it.
std::string formatModel(const HiddenCase& hidden, const MountModel& model, const Tolerances& tolerances,
                        const std::string& bracket_file);

/// Errors of a free simulation: identification, validation.
struct GroupErrors {
    double identification = 0, validation = 0;
};

/// Causes, places, true values of all parameters, set-up, runs and sensors, in the time of the device that is handed
/// out. @param index of the case and the command's options are left to the caller
nlohmann::json formatTruth(const HiddenCase& hidden, const GroupErrors& of_truth, const GroupErrors& of_believed);

}  // namespace wems::hidden
