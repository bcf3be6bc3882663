/// @file
/// What a further run adds to a fit: the fit of the runs that there are beside that of these runs and the further one.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "identify/fit/fit.hpp"

namespace wems::identify {

/// 95 % interval of one parameter, before and after a further run; absent where it is not known by itself. Both are
/// around the value that is known now; what is not known now is around the value that the further run was simulated
/// with (`assumed`), so that its width alone says something.
struct PlannedInterval {
    std::string name, unit;
    double value = 0;
    bool assumed = false;
    std::optional<std::array<double, 2>> now95, then95;
    double spread = 1;  ///< factor that the width then may be wider or narrower by, whichever possible device it is
};

struct Gain {
    /// Groups of FitResult::not_identifiable all of whose members become known.
    std::vector<std::vector<std::string>> separates;
    std::vector<std::string> becomes_known;  ///< all parameters that do, of whichever group
    /// Combinations of parameters that stay unknown one by one, known then and not now.
    std::vector<UnidentifiedGroup> combinations;
    /// How many more independent directions of the parameters are known (FitResult::directions).
    int directions = 0;
    /// Geometric mean of the widths then over now, of the widest relative intervals that are known now; 1 without.
    double width_ratio = 1;
    std::vector<PlannedInterval> intervals;

    /// Before `other` in a list, best first: more groups separated, then more directions known, then narrower.
    bool isBetterThan(const Gain& other) const;
    /// As many groups and directions; the intervals may differ.
    bool tellsAsMuchAs(const Gain& other) const;
    bool isWorthwhile() const;
};

/// Names that FitResult::not_identifiable couples, each set once.
std::vector<std::vector<std::string>> listTies(const FitResult& fit);

/// A parameter counts as known only if its interval keeps a margin of 1.5 to what a fit calls known: the noise of the
/// real run is another one, and its motion that of the real device.
Gain calcGain(const FitResult& now, const FitResult& then);

/// What a run adds whichever of some devices it is made with: what becomes known with all of them, the fewest
/// directions, the geometric mean of the widths. @param gains at least one, of one run
Gain findCommonGain(const std::vector<Gain>& gains);

}  // namespace wems::identify
