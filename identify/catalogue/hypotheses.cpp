#include "identify/catalogue/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "identify/catalogue/hypothesis_list.hpp"
#include "models/common/format_number.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify::updating {
namespace {

// The load's gain over the swept band: straight between points a sixth of an octave apart, of any level, and from one
// point to the next by a fifth, as a random walk: a load that drops out around a frequency is as wide as half an
// octave.
constexpr int kPointsPerOctave = 6;
constexpr int kMostPoints = 60;     // ten octaves; a wider band has them farther apart, since each is a column
constexpr double kGainReach = 0.5;  // of the commanded load
constexpr double kGainStep = 0.2;   // of the commanded load

class CatalogueMaker {
public:
    CatalogueMaker(const UnknownTable& table, const SensorLayout& layout, const MountModel& model)
        : list_(table, model), layout_(layout), model_(model) {}

    Catalogue make(const TestScales& scales, const AxisReach& reach, const ExcitedBand& swept) {
        addConnectionHypotheses(list_, scales, reach);
        addBody();
        addBracket(swept);
        addSensors();
        aimLoadHats();
        shareOdds();
        return std::move(list_.catalogue());
    }

private:
    int row(const std::string& name) const { return list_.row(name); }

    void addBody() {
        list_.addSingle("mass", "body", row("body.mass"));
        addTriple("cog_offset", "body.center_of_gravity.");
        addTriple("gyroscopic", "body.spin.");
        std::vector<PlacedRow> moments;
        std::vector<int> moment_rows;
        for (const char* name : kInertiaNames) {
            const int index = row(std::string("body.inertia.") + name);
            if (index < 0) continue;
            list_.addSingle("inertia", "body", index);
            if (name[1] != name[2]) continue;
            moments.emplace_back("body", index);
            moment_rows.push_back(index);
        }
        list_.addCommon("inertia", moments);
        if (moments.size() > 1) list_.addEach("inertia", {"body"}, moment_rows);
    }

    /// A vector of the body: all its components, and each by itself; results list all.
    void addTriple(const std::string& cause, const std::string& prefix) {
        std::vector<int> rows;
        for (const char* axis : kAxes)
            if (const int index = row(prefix + axis); index >= 0) rows.push_back(index);
        if (rows.empty()) return;
        list_.addEach(cause, {"body"}, rows);
        for (const int index : rows) list_.addSingle(cause, "body", index).reported = rows;
    }

    void addBracket(const ExcitedBand& swept) {
        for (std::size_t j = 0; j < model_.bracket.size(); ++j) {
            const std::string name = std::to_string(j + 1);
            const int frequency = row(name + ".frequency"), ratio = row(name + ".damping_ratio");
            if (model_.bracket[j].translation.isZero(0.0) && model_.bracket[j].rotation.isZero(0.0)) {
                addMissingMode(frequency);
                continue;
            }
            for (const std::vector<int>& rows :
                 {std::vector<int>{frequency}, std::vector<int>{ratio}, std::vector<int>{frequency, ratio}}) {
                list_.addEach("bracket_mode", {"bracket"}, rows);
                list_.catalogue().hypotheses.back().reported = {frequency, ratio};
            }
        }
        const int gain = row("load.gain");
        if (gain < 0) return;
        list_.addSingle("load", "load", gain);
        if (swept.lowest > 0) addLoadHats(gain, swept);
    }

    void addMissingMode(int frequency) {
        Catalogue& catalogue = list_.catalogue();
        catalogue.missing_mode_probe = catalogue.columns.probes.size();
        catalogue.missing_mode = static_cast<int>(catalogue.hypotheses.size());
        const int probe = list_.addProbe({frequency, 1.0, {}});
        list_.add("bracket_mode", {"bracket"}).directions = {{{probe, 1.0}}};
    }

    void addLoadHats(int gain, const ExcitedBand& swept) {
        const double octaves = std::log2(swept.highest / swept.lowest);
        const int intervals = std::clamp(static_cast<int>(std::ceil(octaves * kPointsPerOctave)), 1, kMostPoints - 1);
        const double ratio = std::log(swept.highest / swept.lowest) / intervals;
        for (int k = 0; k <= intervals; ++k) {
            const double at_hat = swept.lowest * std::exp(ratio * k);
            list_.catalogue().columns.hats.push_back({at_hat * std::exp(-ratio), at_hat, at_hat * std::exp(ratio)});
        }
        hat_hypothesis_ = list_.catalogue().hypotheses.size();
        list_.add("load", {"load"}).reported = {gain};
    }

    /// Gains and delays of a channel; of a triax and of a side of one kind (`mobile.1`, `mobile.1.a`; `mobile`,
    /// `mobile.a`), and of both kinds (`mobile.1.all`, `mobile.all`): one amplifier, one clock. Triaxes of one kind, or
    /// both of a place, that are turned.
    void addSensors() {
        const auto placeOf = [](const std::string& triax) {
            return triax.substr(0, triax.find('.', triax.find('.') + 1));
        };
        for (const char* key : {"gain", "delay"}) {
            const std::string cause = std::string("sensor_") + key;
            for (const auto& channel : layout_.channels)
                list_.addSingle(cause, channel.name, row(channel.name + "." + key));
            std::map<std::string, std::vector<int>> triaxes, places, sides, parts;
            for (const SensorChannel& channel : layout_.channels) {
                const std::string& triax = layout_.triaxes[channel.triax].name;
                const SensorGroup& group = layout_.groups[channel.group];
                const std::string side = group.part == Part::mobile ? "mobile" : "fixed";
                const int index = row(channel.name + "." + key);
                triaxes[triax].push_back(index);
                places[placeOf(triax) + ".all"].push_back(index);
                sides[side + (group.derivative == Derivative::displacement ? "" : ".a")].push_back(index);
                parts[side + ".all"].push_back(index);
            }
            std::set<std::vector<int>> known;  // the smaller place says it already
            for (const auto* groups : {&triaxes, &places, &sides, &parts})
                for (const auto& [name, rows] : *groups)
                    if (rows.size() > 1 && known.insert(rows).second) addCommonFault(cause, name, rows);
        }
        std::map<std::string, std::vector<std::string>> places;
        for (const auto& triax : layout_.triaxes) {
            std::vector<int> rows;
            for (const char* axis : kAxes) rows.push_back(row(triax.name + ".r" + axis));
            list_.addEach("sensor_misalignment", {triax.name}, rows);
            places[placeOf(triax.name)].push_back(triax.name);
        }
        for (const auto& [place, triaxes] : places)
            if (triaxes.size() > 1) addTurnedPlace(place, triaxes);
    }

    /// All that was measured at a place turned alike: a bracket or a block that carries marker and accelerometer.
    void addTurnedPlace(const std::string& place, const std::vector<std::string>& triaxes) {
        Hypothesis& hypothesis = list_.add("sensor_misalignment", {place + ".all"});
        for (const char* axis : kAxes) {
            Direction direction;
            for (const std::string& triax : triaxes) {
                const int index = row(triax + ".r" + axis);
                direction.emplace_back(index, list_.at(index).reach);
                hypothesis.reported.push_back(index);
            }
            hypothesis.directions.push_back(direction);
        }
    }

    void addCommonFault(const std::string& cause, const std::string& name, const std::vector<int>& rows) {
        Direction direction;
        for (const int index : rows) direction.emplace_back(index, list_.at(index).reach);
        Hypothesis& hypothesis = list_.add(cause, {name});
        hypothesis.directions = {direction};
        hypothesis.reported = rows;
    }

    /// Hats come after all probes, whose number is known only at the end.
    void aimLoadHats() {
        if (!hat_hypothesis_) return;
        Catalogue& catalogue = list_.catalogue();
        const int first = static_cast<int>(list_.table().size() + catalogue.columns.probes.size());
        const int count = static_cast<int>(catalogue.columns.hats.size());
        for (int k = 0; k < count; ++k) {
            Direction onwards;
            for (int i = k; i < count; ++i) onwards.emplace_back(first + i, k == 0 ? kGainReach : kGainStep);
            catalogue.hypotheses[*hat_hypothesis_].directions.push_back(onwards);
        }
    }

    void shareOdds() {
        std::map<std::string, int> places;
        for (const auto& hypothesis : list_.catalogue().hypotheses) ++places[hypothesis.cause];
        for (auto& hypothesis : list_.catalogue().hypotheses)
            hypothesis.log_prior = -std::log(static_cast<double>(places.size()) * places[hypothesis.cause]);
    }

    HypothesisList list_;
    const SensorLayout& layout_;
    const MountModel& model_;
    std::optional<std::size_t> hat_hypothesis_;
};

}  // namespace

Catalogue makeCatalogue(const UnknownTable& table, const SensorLayout& layout, const MountModel& model,
                        const TestScales& scales, const AxisReach& reach, const ExcitedBand& swept) {
    return CatalogueMaker(table, layout, model).make(scales, reach, swept);
}

std::string findSeparatingRun(const std::string& named, const std::string& rival) {
    const auto involves = [&](const char* cause) { return named == cause || rival == cause; };
    if (named == rival) return "a load off the centre, or more axes recorded: the places have to move differently";
    if (involves("preload"))
        return "a run with gravity along the axis, or turned by 180°: the offset moves with the load, a stop does not";
    if (involves("mass") || involves("load")) return "weigh the mobile part, or measure a force";
    if (involves("stiffness_drift")) return "a downward sweep of the same level";
    if (involves("relaxation") || involves("structural_damping"))
        return "a dwell at two frequencies an octave apart, same level";
    if (involves("friction") || involves("hysteresis") || involves("cubic_stiffness") ||
        involves("asymmetric_stiffness"))
        return "the same sweep at a quarter of the level";
    if (involves("clearance") || involves("stop_stiffness") || involves("stop_dissipation"))
        return "a higher level, which presses the stop further";
    return "a sweep at another level and along another axis";
}

}  // namespace wems::identify::updating
