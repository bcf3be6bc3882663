#include "identify/plan/gain.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/parameter_access.hpp"

namespace wems::identify {
namespace {

constexpr double kMargin = 1.5;           // of an interval's width, see calcGain()
constexpr std::size_t kWidest = 10;       // intervals that a further run is judged by
constexpr double kWorthwhileRatio = 0.9;  // of widths: less than a tenth narrower is no reason for a test

const FittedParameter* findFitted(const FitResult& fit, const std::string& name) {
    const auto found = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                    [&](const FittedParameter& parameter) { return parameter.name == name; });
    return found == fit.parameters.end() ? nullptr : &*found;
}

double halfWidthOf(const FittedParameter& parameter) {
    return 0.5 * (parameter.interval95[1] - parameter.interval95[0]);
}

/// Half width of the interval at which a fit stops calling a value known: two standard errors of 10 %, of dashpots 20 %
/// (calcTolerance()). A dashpot next to nothing is measured against what it was believed to be.
bool isWellKnown(const FittedParameter& parameter) {
    const std::string ending = ".damping";
    const bool dashpot = parameter.name.size() > ending.size() &&
                         parameter.name.compare(parameter.name.size() - ending.size(), ending.size(), ending) == 0;
    const double size = std::max(std::abs(parameter.value), dashpot ? std::abs(parameter.model_value) : 0.0);
    return kMargin * halfWidthOf(parameter) < 2 * (dashpot ? 0.2 : 0.1) * size;
}

double calcWidthRatio(const FitResult& now, const FitResult& then) {
    std::vector<std::pair<double, double>> widths;  // relative width now, logarithm of the ratio
    for (const FittedParameter& parameter : now.parameters) {
        const FittedParameter* after = findFitted(then, parameter.name);
        const double before = halfWidthOf(parameter), size = std::abs(parameter.value);
        if (!(before > 0) || !(size > 0)) continue;
        // What falls out of the list by chance has not become worse.
        const double narrowed = after == nullptr ? 1 : std::min(1.0, halfWidthOf(*after) / before);
        widths.emplace_back(before / size, std::log(std::max(narrowed, 1e-6)));
    }
    std::sort(widths.rbegin(), widths.rend());
    widths.resize(std::min(widths.size(), kWidest));
    double sum = 0;
    for (const auto& width : widths) sum += width.second;
    return widths.empty() ? 1 : std::exp(sum / static_cast<double>(widths.size()));
}

int countKnownDirections(const FitResult& fit) {
    return static_cast<int>(std::count_if(fit.directions.begin(), fit.directions.end(),
                                          [](const ParameterDirection& direction) { return direction.known; }));
}

/// Those of `then` that `now` does not have; none where no further direction is known, since then they are the same
/// directions in other words.
std::vector<UnidentifiedGroup> listNewCombinations(const FitResult& now, const FitResult& then) {
    std::vector<UnidentifiedGroup> combinations;
    for (const UnidentifiedGroup& group : then.not_identifiable) {
        const bool old =
            std::any_of(now.not_identifiable.begin(), now.not_identifiable.end(),
                        [&](const UnidentifiedGroup& other) { return other.combination == group.combination; });
        if (!group.combination.empty() && !old) combinations.push_back(group);
    }
    return combinations;
}

std::array<double, 2> intervalAround(double value, double half_width) {
    return {value - half_width, value + half_width};
}

}  // namespace

bool Gain::isBetterThan(const Gain& other) const {
    if (separates.size() != other.separates.size()) return separates.size() > other.separates.size();
    if (directions != other.directions) return directions > other.directions;
    return width_ratio < other.width_ratio;
}

bool Gain::tellsAsMuchAs(const Gain& other) const {
    return separates.size() == other.separates.size() && directions == other.directions;
}

bool Gain::isWorthwhile() const {
    return !separates.empty() || directions > 0 || width_ratio < kWorthwhileRatio;
}

std::vector<std::vector<std::string>> listTies(const FitResult& fit) {
    std::vector<std::vector<std::string>> ties;
    for (const UnidentifiedGroup& group : fit.not_identifiable)
        if (std::find(ties.begin(), ties.end(), group.names) == ties.end()) ties.push_back(group.names);
    return ties;
}

Gain calcGain(const FitResult& now, const FitResult& then) {
    Gain gain;
    const auto becomesKnown = [&](const std::string& name) {
        const FittedParameter* after = findFitted(then, name);
        return after != nullptr && isWellKnown(*after);
    };
    for (const auto& tie : listTies(now)) {
        if (std::all_of(tie.begin(), tie.end(), becomesKnown)) gain.separates.push_back(tie);
        for (const std::string& name : tie)
            if (becomesKnown(name) &&
                std::find(gain.becomes_known.begin(), gain.becomes_known.end(), name) == gain.becomes_known.end())
                gain.becomes_known.push_back(name);
    }
    gain.directions = std::max(0, countKnownDirections(then) - countKnownDirections(now));
    if (gain.directions > 0) gain.combinations = listNewCombinations(now, then);
    gain.width_ratio = calcWidthRatio(now, then);
    for (const FittedParameter& parameter : now.parameters) {
        const FittedParameter* after = findFitted(then, parameter.name);
        PlannedInterval interval{parameter.name, parameter.unit, parameter.value, false, parameter.interval95, {}};
        if (after != nullptr) interval.then95 = intervalAround(parameter.value, halfWidthOf(*after));
        gain.intervals.push_back(std::move(interval));
    }
    std::vector<std::string> open;
    for (const UnidentifiedGroup& group : now.not_identifiable)
        for (const std::string& name : group.names)
            if (std::find(open.begin(), open.end(), name) == open.end()) open.push_back(name);
    for (const std::string& name : open) {
        PlannedInterval interval{name, parameterUnit(name), getParameter(now.model, name), true, {}, {}};
        const FittedParameter* after = findFitted(then, name);
        if (after != nullptr) interval.then95 = intervalAround(interval.value, halfWidthOf(*after));
        gain.intervals.push_back(std::move(interval));
    }
    return gain;
}

namespace {

/// Those elements of the first list that all others have, too.
template <typename Element, typename ListOf, typename Same>
std::vector<Element> findCommon(const std::vector<Gain>& gains, const ListOf& listOf, const Same& same) {
    std::vector<Element> common;
    for (const Element& element : listOf(gains.front())) {
        const bool everywhere = std::all_of(gains.begin(), gains.end(), [&](const Gain& gain) {
            const auto& list = listOf(gain);
            return std::any_of(list.begin(), list.end(), [&](const Element& other) { return same(element, other); });
        });
        if (everywhere) common.push_back(element);
    }
    return common;
}

double halfWidthOf(const std::array<double, 2>& interval) {
    return 0.5 * (interval[1] - interval[0]);
}

/// Of one interval with all devices; nothing is foretold where it is not known with one of them.
void combineWidths(const std::vector<Gain>& gains, std::size_t index, PlannedInterval& interval) {
    std::vector<double> logarithms;
    for (const Gain& gain : gains) {
        const bool known = index < gain.intervals.size() && gain.intervals[index].then95;
        if (!known || !(halfWidthOf(*gain.intervals[index].then95) > 0)) {
            interval.then95.reset();
            return;
        }
        logarithms.push_back(std::log(halfWidthOf(*gain.intervals[index].then95)));
    }
    double mean = 0, farthest = 0;
    for (const double logarithm : logarithms) mean += logarithm / static_cast<double>(logarithms.size());
    for (const double logarithm : logarithms) farthest = std::max(farthest, std::abs(logarithm - mean));
    interval.then95 = intervalAround(interval.value, std::exp(mean));
    interval.spread = std::exp(farthest);
}

}  // namespace

Gain findCommonGain(const std::vector<Gain>& gains) {
    Gain common = gains.front();
    const auto equal = [](const auto& a, const auto& b) { return a == b; };
    common.separates = findCommon<std::vector<std::string>>(
        gains, [](const Gain& gain) -> const auto& { return gain.separates; }, equal);
    common.becomes_known = findCommon<std::string>(
        gains, [](const Gain& gain) -> const auto& { return gain.becomes_known; }, equal);
    common.combinations = findCommon<UnidentifiedGroup>(
        gains, [](const Gain& gain) -> const auto& { return gain.combinations; },
        [](const UnidentifiedGroup& a, const UnidentifiedGroup& b) { return a.combination == b.combination; });
    double logarithm = 0;
    for (const Gain& gain : gains) {
        common.directions = std::min(common.directions, gain.directions);
        logarithm += std::log(gain.width_ratio) / static_cast<double>(gains.size());
    }
    common.width_ratio = std::exp(logarithm);
    for (std::size_t i = 0; i < common.intervals.size(); ++i) combineWidths(gains, i, common.intervals[i]);
    return common;
}

}  // namespace wems::identify
