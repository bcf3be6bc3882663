#include "identify/updating/linked_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wems::identify::updating {

double calcCommonFactor(const UnknownTable& table, const Direction& direction, const Eigen::VectorXd& estimate) {
    if (direction.size() < 2) return 1;
    std::vector<double> factors;
    for (const auto& [column, weight] : direction) {
        const auto row = static_cast<std::size_t>(column);
        if (row >= table.size() || table[row].believed == 0) return 1;
        factors.push_back(std::abs(1 + estimate[column] / table[row].believed));
    }
    const auto middle = factors.begin() + static_cast<long>(factors.size() / 2);
    std::nth_element(factors.begin(), middle, factors.end());
    return *middle;
}

void addShares(const Hypothesis& hypothesis, const Eigen::VectorXd& estimate, Eigen::VectorXd& deviation) {
    for (const auto& [column, part] : hypothesis.shares) deviation[column] = part * std::abs(estimate[column]);
}

void keepShares(const Hypothesis& hypothesis, const Eigen::VectorXd& before, Eigen::VectorXd& estimate) {
    for (const auto& [column, part] : hypothesis.shares) {
        const double common = estimate[column], tolerance = 2 * part * std::abs(common);
        estimate[column] = std::clamp(before[column], common - tolerance, common + tolerance);
    }
}

CarriedRows findCarried(const UnknownTable& table, const SensorLayout& layout) {
    std::vector<int> connection_of(layout.stations.size(), -1);
    for (const SensorChannel& channel : layout.channels) connection_of[channel.station] = channel.connection;
    CarriedRows carried;
    for (std::size_t i = 0; i < table.size(); ++i)
        for (std::size_t k = 0; k < table.size(); ++k)
            if (table[i].kind == UnknownKind::position && table[k].kind == UnknownKind::station_place &&
                table[i].first == connection_of[table[k].first] && table[i].second == table[k].second)
                carried.emplace_back(static_cast<int>(i), static_cast<int>(k));
    return carried;
}

std::vector<Direction> linkTolerances(const Eigen::VectorXd& deviation, const CarriedRows& carried) {
    std::vector<Direction> tolerances = makeTolerances(deviation);
    for (Direction& direction : tolerances) {
        const auto [row, own] = direction.front();
        for (const auto& [position, place] : carried)
            if (position == row) direction.emplace_back(place, own);
    }
    return tolerances;
}

}  // namespace wems::identify::updating
