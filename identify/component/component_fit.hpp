/// @file
/// Parameters of a component test: one axis of one connection, force measured directly or mass times acceleration.
///
/// The model gives the law's shape, not its values: stiffness always, a dashpot where velocity is known, a constant
/// force (zero of the load cell, weight), and of what the law of that axis has: each stop's clearance and stiffness,
/// the cubic term, dry friction. Everything but the clearances is linear; they come from variable projection
/// (block_regression.hpp). The friction's transition velocity is the model's. What else the law has (offset, loss
/// factor, relaxation, drift, presliding, hysteresis, a stop's dissipation) is left out of the fitted model, which a
/// note says: together with the fitted values it would act twice.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identify/component/calibration.hpp"
#include "identify/component/component_data.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

// A named estimate with its interval, as tables and result files print it.

/// SI units. `lower` and `upper` bound the 95 % interval; infinite where the data say nothing.
struct ComponentParameter {
    std::string name;  ///< `1.z.stiffness`
    double value = 0;
    std::string unit;
    double lower = 0, upper = 0;
};

/// Parameters that only a combination of is known, or none.
struct UnknownParameter {
    std::string name;
    std::string separate_by;  ///< the test that would tell
};

struct ComponentFit {
    std::string connection;
    int axis = 0;
    std::vector<ComponentParameter> parameters;
    std::vector<UnknownParameter> not_identifiable;
    double residual_fraction = 0;  ///< RMS of what is left over that of the force about its mean
    double residual_rms = 0;       ///< N
    double force_offset = 0;       ///< N, constant part of the measured force that no law explains
    double effective_samples = 0;  ///< samples over the correlation length of the residual
    GainTolerances gains;          ///< which no interval of `parameters` knows
    MountModel fitted;             ///< the model with the new values in that axis
    std::vector<std::string> notes;
};

/// Where a recording has neither a force nor a mass is given, that of the model's body.
ComponentOptions completeOptions(const Recording& recording, const MountModel& model, ComponentOptions options);

/// The model's connection that a recording's name means: that of the name, or its only one. @throws InputError
std::size_t findElement(const MountModel& model, const std::string& name);

/// Fits one axis to all recordings together.
/// @param options connection and axis as in extractComponent, completed as above. The model's connection is that of the
/// recording's name, or its only one.
/// @throws InputError if the channels or the window do not allow it, or the law of that axis is empty.
ComponentFit fitComponent(const std::vector<Recording>& recordings, const MountModel& model,
                          const ComponentOptions& options);

}  // namespace wems::identify
