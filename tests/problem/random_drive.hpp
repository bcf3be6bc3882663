/// @file
/// A device that is driven at random, whose believed model is the truth.
#pragma once

#include <string>

#include "tests/hidden/random_case.hpp"

namespace wems::identify::updating {

/// In unit time, without errors of sensors.
/// @param set_up `bracket`, `base`, `axis`
inline hidden::HiddenCase drawRandomDrive(const std::string& set_up, hidden::Sensors sensors, hidden::Random& random) {
    hidden::CaseOptions options;
    options.kind = "none";
    options.sensors = sensors;
    options.set_up_kind = set_up;
    options.excitation = hidden::Excitation::random;
    options.time_scale = 1;
    return hidden::drawCase(options, random);
}

}  // namespace wems::identify::updating
