#include "identify/commands/format.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace wems::identify::commands {

std::string formatNumber(double value, int digits) {
    if (!std::isfinite(value)) return "-";
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
    // 100280 rather than 1.0028e+05 beside 99690: zeros are easier to compare than powers of ten.
    constexpr double largest_written_out = 1e7;
    if (std::strchr(buffer, 'e') != nullptr && std::abs(value) >= 1 && std::abs(value) < largest_written_out)
        std::snprintf(buffer, sizeof buffer, "%.0f", std::strtod(buffer, nullptr));
    return buffer;
}

std::string formatPercent(double share) {
    return std::isfinite(share) ? formatNumber(100 * share, 3) + " %" : std::string("-");
}

nlohmann::json numberOrNull(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

}  // namespace wems::identify::commands
