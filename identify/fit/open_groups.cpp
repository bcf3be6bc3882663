#include "identify/fit/open_groups.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "models/parameter_access.hpp"

namespace wems::identify {

namespace {

/// Moves the open parameters of `model`, each in proportion to its base value, until the known combinations hold.
void shareCombinations(const SolvedParameters& solved, const OpenGroup& group, MountModel& model) {
    const Eigen::Index size = group.members.size();
    Eigen::VectorXd base(size), fitted(size);
    std::vector<std::string> names;
    for (Eigen::Index j = 0; j < size; ++j) {
        names.push_back(solved.parameters[group.members[j]].name);
        base(j) = getParameter(solved.believed, names.back());
        fitted(j) = getParameter(solved.fitted, names.back());
    }
    Eigen::VectorXd shared = base;
    if (!group.known.empty()) {
        Eigen::MatrixXd factors(group.known.size(), size);
        for (std::size_t c = 0; c < group.known.size(); ++c) factors.row(c) = group.known[c].factors.transpose();
        Eigen::VectorXd weight = base.cwiseAbs();
        if (!(weight.minCoeff() > 0)) weight = solved.scale(group.members);
        const Eigen::MatrixXd weighted = weight.asDiagonal() * factors.transpose();
        shared += weighted * (factors * weighted).ldlt().solve(factors * (fitted - base));
    }
    for (Eigen::Index j = 0; j < size; ++j) setParameter(model, names[j], shared(j));
}

}  // namespace

std::array<double, 2> makeInterval(double value, double half_width) {
    return {value - half_width, value + half_width};
}

void addOpenGroups(const SolvedParameters& solved, const Identifiability& identifiability, FitResult& result) {
    const auto nameOf = [&](int member) -> const Parameter& { return solved.parameters[member]; };
    bool shared = false;
    for (const OpenGroup& group : identifiability.groups) {
        shareCombinations(solved, group, result.model);
        for (const KnownCombination& known : group.known) {
            UnidentifiedGroup entry;
            double magnitude = 0;
            Eigen::VectorXd combination = Eigen::VectorXd::Zero(solved.scale.size());
            for (std::size_t j = 0; j < known.members.size(); ++j) {
                const double factor = known.factors(j);
                if (factor == 0) continue;
                entry.names.push_back(nameOf(known.members[j]).name);
                const double term = factor * getParameter(solved.fitted, entry.names.back());
                entry.value += term;
                magnitude += std::abs(term);
                combination(known.members[j]) = factor * solved.scale(known.members[j]);
            }
            entry.combination = known.text;
            entry.interval95 =
                makeInterval(entry.value, std::max(solved.calcHalfWidth(combination), solved.least_error * magnitude));
            entry.unit = nameOf(known.members.front()).unit;
            entry.separate_by = group.separate_by;
            result.not_identifiable.push_back(std::move(entry));
            shared = true;
        }
        UnidentifiedGroup rest;  // members that no known combination holds
        for (const int member : group.members) {
            const bool combined =
                std::any_of(group.known.begin(), group.known.end(), [&](const KnownCombination& known) {
                    for (std::size_t j = 0; j < known.members.size(); ++j)
                        if (known.members[j] == member && known.factors(j) != 0) return true;
                    return false;
                });
            if (!combined) rest.names.push_back(nameOf(member).name);
        }
        if (rest.names.empty()) continue;
        rest.unit = nameOf(group.members.front()).unit;
        rest.separate_by = group.separate_by;
        result.not_identifiable.push_back(std::move(rest));
    }
    const std::string note =
        "the fitted model shares each known combination among its members in proportion to the values of the model";
    if (shared && std::find(result.notes.begin(), result.notes.end(), note) == result.notes.end())
        result.notes.push_back(note);
}

}  // namespace wems::identify
