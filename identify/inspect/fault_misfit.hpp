/// @file
/// How well the channels of a part agree on one rigid motion once a set of faults is taken off.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/inspect/channel_cells.hpp"

namespace wems::identify {

// What small errors of sensors leave, relative to a signal. A gain off by 0.01, a direction by 0.01 rad and a place by
// 1 mm of 0.1 m, the default tolerances of a model, leave one per cent each: of a channel's own signal gain and place,
// of its neighbours' direction and place, 1.4 % together. Recordings of 100 random devices (gains within 0.5 %,
// directions 0.5 degrees, places 0.5 mm) have misfits of 0.58 (median of 180 parts), 0.90 (nine of ten) and 1.09 (98 of
// 100) of the floors.

/// Of a channel's own signal; rounded up to two per cent. Without it 0.87 and 1.34 of the floors.
constexpr double kOwnFloor = 0.02;
/// Of a typical channel of its kind. Without it 0.85 and 1.36 of the floors.
constexpr double kOthersFloor = 0.015;

/// What is wrong with each channel of a part.
struct ChannelState {
    double factor = 1;    ///< recorded over true
    double delay = 0;     ///< s
    double drift = 0;     ///< s/s
    std::size_t row = 0;  ///< index of the channel that it is in truth
};
using PartState = std::vector<ChannelState>;

PartState makeFaultless(std::size_t channels);

/// Against what all other channels say of it, in one cell.
struct Forecast {
    double omega = 0, time = 0;
    std::complex<double> ratio;  ///< ⟨T T̂*⟩ / ⟨T̂ T̂*⟩ of the corrected channel T and its forecast T̂
};

struct ChannelOutlook {
    double misfit_without = 0;  ///< misfit of all others if it is left out
    std::vector<Forecast> forecasts;
};

/// Root mean square over degrees of freedom, mean over cells, in units of the floor: about 1 without faults.
double calcMisfit(const PartCells& part, const PartState& state);

/// Of each channel; forecasts are of those cells alone in which the others say something about it.
std::vector<ChannelOutlook> lookAhead(const PartCells& part, const PartState& state);

/// Of some channels together, forecast by all others.
std::vector<Forecast> forecastGroup(const PartCells& part, const PartState& state,
                                    const std::vector<std::size_t>& members);

}  // namespace wems::identify
