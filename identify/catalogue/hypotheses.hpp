/// @file
/// The catalogue of causes: for a model, its sensors and its runs every hypothesis that a diagnosis weighs.
///
/// A cause may sit at one place, or at all axial, all lateral or all places by one factor. Each cause has the same
/// prior odds, shared by its places: that one of `places` is at fault is as likely for a cause with many places as for
/// one with few.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/catalogue/axis_reach.hpp"
#include "identify/problem/linearised_run.hpp"
#include "identify/solve/evidence.hpp"

namespace wems::identify::updating {

struct Catalogue {
    ColumnSet columns;  ///< the table's rows, and what the hypotheses need beside them
    std::vector<Hypothesis> hypotheses;
    /// The hypothesis of a mode that the model lacks, −1 if there is none, and its probe: a model's last mode without a
    /// shape stands for it.
    int missing_mode = -1;
    std::size_t missing_mode_probe = 0;
};

/// @param swept Hz, lowest and highest swept frequency if the load is a sweep; zeros if not
Catalogue makeCatalogue(const UnknownTable& table, const SensorLayout& layout, const MountModel& model,
                        const TestScales& scales, const AxisReach& reach, const ExcitedBand& swept);

/// The run that would tell two causes apart.
std::string findSeparatingRun(const std::string& named, const std::string& rival);

}  // namespace wems::identify::updating
