/// @file
/// What the gains of a component test's two channels leave of its parameters. An interval of the fit knows the scatter
/// alone; a load cell that reads 1 % high makes every stiffness 1 % high, and no sample tells.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "models/mount_model.hpp"

namespace wems::identify {

struct ComponentParameter;
enum class ForceSource;

/// Relative, ± two standard deviations, as a model's tolerances.
struct GainTolerances {
    double force = 0, displacement = 0;
};

/// Those of the model's sensors; of mass times acceleration with the mass. Without a model the standard ones.
GainTolerances gainTolerancesOf(ForceSource source, const MountModel& model = {});

/// Relative standard deviation that they leave of a parameter, by the powers of force and length in its unit: `N/m` has
/// one of force and minus one of length.
double calcGainDeviation(const std::string& unit, const GainTolerances& gains);

/// The 95 % interval of a parameter with it.
std::array<double, 2> calcIntervalWithGains(const ComponentParameter& parameter, const GainTolerances& gains);

/// Two measurements of one force, the second as a gain and a delay make it from the first and with an offset of its
/// own.
struct ForceComparison {
    double gain = 1, gain_half_width = 0;    ///< second over first, 95 %
    double delay = 0, delay_half_width = 0;  ///< s, of the second
};

/// @param time s, ascending @param first, second N, at these times; first the one that scatters less
ForceComparison compareForces(const Eigen::VectorXd& time, const Eigen::VectorXd& first, const Eigen::VectorXd& second);

/// One sentence for a reader: whether mass times acceleration agrees with the recorded force within what gains and mass
/// allow, and if not that a scale is off.
std::string describe(const ForceComparison& comparison, const GainTolerances& gains);

}  // namespace wems::identify
