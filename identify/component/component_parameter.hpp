/// @file
/// A named estimate with its interval, as tables and result files print it.
#pragma once

#include <string>

namespace wems::identify {

/// SI units. `lower` and `upper` bound the 95 % interval; infinite where the data say nothing.
struct ComponentParameter {
    std::string name;  ///< `1.z.stiffness`
    double value = 0;
    std::string unit;
    double lower = 0, upper = 0;
};

}  // namespace wems::identify
