#include "identify/updating/common_factor.hpp"

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

}  // namespace wems::identify::updating
