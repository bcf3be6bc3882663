/// @file
/// The causes that a diagnosis considers, each at every place where it may act in a given model.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "identify/diagnose/knob.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// One cause at one place (or at several together).
struct Candidate {
    std::string cause;               ///< `cog_offset`, …
    std::vector<std::string> where;  ///< `body`, `4.z`, `4.z.+`, `bracket`, `load`
    std::vector<Knob> knobs;         ///< what is fitted
    /// Set before fitting, such as a clearance to infinity for a stop too many.
    std::vector<std::pair<std::string, double>> fixed;
    /// Trial values of the knobs, one row for each start. The screening tells how far along the way from the present
    /// value to the trial value the data want to go, for all knobs up to `linear`; the others keep the trial value.
    std::vector<std::vector<double>> starts;
    std::size_t linear = 1;  ///< 0: the trial values are taken as they are
    /// A row that the modes file lacks: where the model has fewer rows, apply() appends it (with rows that nothing
    /// drives before it, should any be missing there), before the knobs are set.
    struct NewMode {
        int row;  ///< from 1
        BracketMode mode;
    };
    std::optional<NewMode> new_mode = std::nullopt;

    /// Names of all parameters in the result.
    std::vector<std::string> parameterNames() const;
    /// `friction 1.x` for messages.
    std::string describe() const;
    void apply(MountModel& model, const std::vector<double>& values) const;
};

/// Everything in the catalogue that the model as it is now may lack. Bracket modes and load are left out unless the
/// recordings show them (`with_bracket`).
std::vector<Candidate> makeCatalogue(const MountModel& model, bool with_bracket);

}  // namespace wems::identify
