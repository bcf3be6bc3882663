/// @file
/// A hidden case as text: the models as TOML and the truth as JSON.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/hidden/random_case.hpp"

namespace wems::hidden {

/// Of the device that is handed out; the bracket's modes are in `bracket_file` beside it.
std::string formatModel(const HiddenCase& hidden, const MountModel& model, const Tolerances& tolerances,
                        const std::string& bracket_file);

/// Errors of a free simulation that is driven by what was recorded.
struct GroupErrors {
    double identification = 0, validation = 0;
};
struct ModelErrors {
    GroupErrors truth;     ///< the true model, where no sensor has a hidden fault
    GroupErrors without;   ///< the exact device without its effects, likewise
    GroupErrors believed;  ///< the believed model on what is handed out
};

/// Causes, places, true values of all parameters, set-up, runs and sensors, in the time of the device that is handed
/// out. The index of the case and the command's options are left to the caller.
nlohmann::json formatTruth(const HiddenCase& hidden, const ModelErrors& errors);

}  // namespace wems::hidden
