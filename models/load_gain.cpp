#include "models/load_gain.hpp"

#include <algorithm>

namespace wems {

double calcLoadGain(const LoadCorrection& correction, double frequency) {
    const auto& table = correction.gain_over_frequency;
    if (table.empty()) return 1;
    if (table.size() == 1 || frequency <= table.front().first) return table.front().second;
    const auto above =
        std::find_if(table.begin(), table.end(), [&](const auto& row) { return row.first >= frequency; });
    if (above == table.end()) return table.back().second;
    const auto below = std::prev(above);
    const double fraction = (frequency - below->first) / (above->first - below->first);
    return below->second + fraction * (above->second - below->second);
}

Eigen::Vector3d calcLoadGains(const LoadCorrection& correction, double frequency) {
    return calcLoadGain(correction, frequency) * correction.axis_gain;
}

bool dependsOnFrequency(const LoadCorrection& correction) {
    return correction.gain_over_frequency.size() > 1;
}

}  // namespace wems
