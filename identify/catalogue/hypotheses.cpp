#include "identify/catalogue/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/parameter_access.hpp"

namespace wems::identify::updating {
namespace {

// Clearances from here to there of the believed one, from where a gradient might not lead to the truth.
constexpr double kFarClearances[] = {0.55, 0.75, 1.3};
// A stop that the model lacks is sought at these parts of the largest displacement.
constexpr double kMissingStops[] = {0.35, 0.55, 0.75, 0.9};
// Sliding of a hysteresis is sought at these parts of the largest displacement.
constexpr double kYields[] = {0.1, 0.4};
constexpr double kStillAxis =
    0.05;  // of the largest displacement of any axis: one that moves less shows no stop or loop
constexpr double kCommonReach = 0.5;  // of the number, of a factor that many share
// The load's gain over the swept band: straight between points a sixth of an octave apart, of any level, and from one
// point to the next by a fifth, as a random walk: a load that drops out around a frequency is as wide as half an
// octave.
constexpr int kPointsPerOctave = 6;
constexpr int kMostPoints = 60;     // ten octaves; a wider band has them farther apart, since each is a column
constexpr double kGainReach = 0.5;  // of the commanded load
constexpr double kGainStep = 0.2;   // of the commanded load

using AxisFilter = std::function<bool(int axis)>;

class CatalogueMaker {
public:
    CatalogueMaker(const UnknownTable& table, const SensorLayout& layout, const MountModel& model,
                   const TestScales& scales, const AxisReach& reach)
        : table_(table), layout_(layout), model_(model), scales_(scales), reach_(reach) {
        result_.columns.table = &table;
    }

    Catalogue make(const ExcitedBand& swept) {
        addLaws();
        addStops();
        addBody();
        addBracket(swept);
        addSensors();
        shareOdds();
        return std::move(result_);
    }

private:
    int row(const std::string& name) const { return findUnknown(table_, name); }
    const Unknown& at(int index) const { return table_[index]; }
    std::string placeOf(int connection, int axis) const {
        return model_.connections[connection].name + "." + kAxes[axis];
    }

    Hypothesis& add(const std::string& cause, std::vector<std::string> where) {
        Hypothesis hypothesis;
        hypothesis.cause = cause;
        hypothesis.where = std::move(where);
        result_.hypotheses.push_back(std::move(hypothesis));
        return result_.hypotheses.back();
    }

    void addSingle(const std::string& cause, const std::string& where, int index) {
        Hypothesis& hypothesis = add(cause, {where});
        hypothesis.directions = {{{index, at(index).reach}}};
        hypothesis.reported = {index};
    }

    /// One factor for all rows of a list; nothing for fewer than two.
    void addCommon(const std::string& cause, const std::vector<std::pair<std::string, int>>& members) {
        if (members.size() < 2) return;
        Direction direction;
        std::vector<std::string> where;
        std::vector<int> rows;
        for (const auto& [place, index] : members) {
            const Unknown& number = at(index);
            direction.emplace_back(index,
                                   number.believed != 0 ? kCommonReach * std::abs(number.believed) : number.reach);
            if (std::find(where.begin(), where.end(), place) == where.end()) where.push_back(place);
            rows.push_back(index);
        }
        Hypothesis& hypothesis = add(cause, where);
        hypothesis.directions = {direction};
        hypothesis.reported = rows;
    }

    /// The axial, each lateral, both lateral and all axes together, as far as these differ.
    template <typename Collect>
    void forGroups(const Collect& collect) {
        const std::vector<AxisFilter> filters{[](int a) { return a == 2; }, [](int a) { return a == 0; },
                                              [](int a) { return a == 1; }, [](int a) { return a != 2; },
                                              [](int) { return true; }};
        std::vector<std::vector<std::pair<int, int>>> known;
        for (const auto& filter : filters) {
            std::vector<std::pair<int, int>> axes;
            for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i)
                for (int a = 0; a < 3; ++a)
                    if (filter(a)) axes.emplace_back(i, a);
            if (std::find(known.begin(), known.end(), axes) != known.end()) continue;
            known.push_back(axes);
            collect(axes);
        }
    }

    void addNumber(const std::string& cause, const std::string& key, bool needs_value) {
        const auto indexOf = [&](int i, int a) {
            const int index = row(placeOf(i, a) + "." + key);
            const auto& law = model_.connections[i].axis[a];
            return index >= 0 && needs_value && law.stiffness == 0 ? -1 : index;
        };
        for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i)
            for (int a = 0; a < 3; ++a)
                if (const int index = indexOf(i, a); index >= 0) addSingle(cause, placeOf(i, a), index);
        forGroups([&](const auto& axes) {
            std::vector<std::pair<std::string, int>> members;
            for (const auto& [i, a] : axes)
                if (const int index = indexOf(i, a); index >= 0) members.emplace_back(placeOf(i, a), index);
            addCommon(cause, members);
        });
    }

    void addLaws() {
        addNumber("elastomer_stiffness", "stiffness", true);
        addNumber("viscous_damping", "damping", false);
        addNumber("structural_damping", "loss_factor", true);
        addShaped("friction", "friction_force", "transition_velocity",
                  [&](int i, int a) { return at(row(placeOf(i, a) + ".transition_velocity")).believed; });
        addNumber("cubic_stiffness", "cubic", false);
        addNumber("stiffness_drift", "drift", true);
        for (const double corner : {0.5 * scales_.lowest, std::sqrt(scales_.lowest * scales_.highest), scales_.highest})
            addRelaxation(1 / (kTwoPi * corner));
        for (const double part : kYields) addHysteresis(part);
    }

    int addProbe(const Probe& probe) {
        result_.columns.probes.push_back(probe);
        return static_cast<int>(table_.size() + result_.columns.probes.size()) - 1;
    }

    /// A mechanism with an amplitude, zero in the model, and a shape in which the law is not linear: sought at one
    /// value of the shape, moved from there.
    /// @param shapeOf value at a connection and axis; 0 where the mechanism is not sought
    void addShaped(const std::string& cause, const std::string& amplitude, const std::string& shape,
                   const std::function<double(int i, int a)>& shapeOf) {
        std::map<std::pair<int, int>, int> probes;
        const auto probeOf = [&](int i, int a) {
            const int size = row(placeOf(i, a) + "." + amplitude), form = row(placeOf(i, a) + "." + shape);
            const double value = shapeOf(i, a);
            if (size < 0 || !(value > 0)) return -1;
            const auto found = probes.find({i, a});
            if (found != probes.end()) return found->second;
            return probes[{i, a}] = addProbe({size, at(size).step, {{form, value}}});
        };
        const auto addSet = [&](const std::vector<std::pair<int, int>>& axes) {
            Direction direction, sizes, forms;
            Hypothesis hypothesis;
            hypothesis.cause = cause;
            for (const auto& [i, a] : axes) {
                const int probe = probeOf(i, a);
                if (probe < 0) continue;
                const int size = row(placeOf(i, a) + "." + amplitude), form = row(placeOf(i, a) + "." + shape);
                const double value = shapeOf(i, a);
                hypothesis.where.push_back(placeOf(i, a));
                direction.emplace_back(probe, at(size).reach);
                sizes.emplace_back(size, at(size).reach);
                forms.emplace_back(form, value);
                hypothesis.start.emplace_back(form, value);
                hypothesis.moves.emplace_back(probe, size);
                hypothesis.reported.push_back(size);
                hypothesis.reported.push_back(form);
            }
            if (direction.empty()) return;
            hypothesis.directions = {direction};
            hypothesis.tangent = {sizes, forms};
            result_.hypotheses.push_back(hypothesis);
        };
        for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i)
            for (int a = 0; a < 3; ++a) addSet({{i, a}});
        forGroups([&](const auto& axes) {
            if (axes.size() > 1) addSet(axes);
        });
    }

    const AxisLaw& lawOf(int i, int a) const { return model_.connections[i].axis[a]; }

    void addRelaxation(double tau) {
        addShaped("relaxation", "stiffness_ratio", "time_constant",
                  [&, tau](int i, int a) { return lawOf(i, a).stiffness == 0 || lawOf(i, a).relaxation ? 0.0 : tau; });
    }

    /// @param part of the largest displacement of the axis, where sliding begins
    void addHysteresis(double part) {
        addShaped("hysteresis", "hysteresis_force", "yield_displacement", [&, part](int i, int a) {
            const Eigen::Index at_row = 3 * i + a;
            const double reached = std::max(reach_.positive[at_row], reach_.negative[at_row]);
            return lawOf(i, a).hysteresis || reached < kStillAxis * scales_.displacement ? 0.0 : part * reached;
        });
    }

    struct StopRow {
        int connection, axis;
        std::string side;
        const Stop* stop;
        int clearance, stiffness;
        std::string place() const { return side; }
    };

    void addStops() {
        std::vector<StopRow> stops;
        for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i)
            for (int a = 0; a < 3; ++a)
                for (const Stop& stop : model_.connections[i].axis[a].stops) {
                    const std::string side = placeOf(i, a) + (stop.side == Side::positive ? ".+" : ".-");
                    stops.push_back({i, a, side, &stop, row(side + ".clearance"), row(side + ".stiffness")});
                }
        for (const StopRow& stop : stops) {
            if (stop.stop->stiffness > 0)
                addStop(stop);
            else
                addMissingStop(stop);
        }
        const auto collect = [&](int StopRow::*index, const std::vector<std::pair<int, int>>& axes) {
            std::vector<std::pair<std::string, int>> members;
            for (const StopRow& stop : stops)
                if (stop.stop->stiffness > 0 &&
                    std::find(axes.begin(), axes.end(), std::pair(stop.connection, stop.axis)) != axes.end())
                    members.emplace_back(stop.side, stop.*index);
            return members;
        };
        for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i)
            for (int a = 0; a < 3; ++a) {
                addCommon("stop_stiffness", collect(&StopRow::stiffness, {{i, a}}));
                addPair(collect(&StopRow::clearance, {{i, a}}));
                const auto& law = model_.connections[i].axis[a];
                const auto real = std::count_if(law.stops.begin(), law.stops.end(),
                                                [](const Stop& stop) { return stop.stiffness > 0; });
                if (real == 0) continue;
                if (real > 1)
                    if (const int index = row(placeOf(i, a) + ".offset"); index >= 0) addPreload(i, a, index);
                if (const int index = row(placeOf(i, a) + ".dissipation"); index >= 0)
                    addSingle("stop_dissipation", placeOf(i, a), index);
            }
        forGroups([&](const auto& axes) {
            if (axes.size() < 2) return;
            addCommon("stop_stiffness", collect(&StopRow::stiffness, axes));
            addCommon("clearance", collect(&StopRow::clearance, axes));
            std::vector<std::pair<std::string, int>> members;
            for (const auto& [i, a] : axes)
                if (!collect(&StopRow::stiffness, {{i, a}}).empty())
                    members.emplace_back(placeOf(i, a), row(placeOf(i, a) + ".dissipation"));
            addCommon("stop_dissipation", members);
        });
    }

    void addStop(const StopRow& stop) {
        addSingle("stop_stiffness", stop.side, stop.stiffness);
        addSingle("clearance", stop.side, stop.clearance);
        const double c = stop.stop->clearance;
        for (const double far : kFarClearances) {
            const Eigen::Index at_row = 3 * stop.connection + stop.axis;
            const double reached =
                stop.stop->side == Side::positive ? reach_.positive[at_row] : reach_.negative[at_row];
            if (std::min(c, far * c) > reached) continue;
            const int probe = addProbe({stop.clearance, (far - 1) * c, {}});
            Hypothesis& hypothesis = add("clearance", {stop.side});
            hypothesis.directions = {{{probe, 0.5 * c}}};
            hypothesis.moves = {{probe, stop.clearance}};
            hypothesis.tangent = {{{stop.clearance, at(stop.clearance).reach}}};
            hypothesis.reported = {stop.clearance};
        }
    }

    /// Beside that from where the offset is: so far that a stop is reached which the believed one leaves alone.
    void addPreload(int i, int a, int index) {
        addSingle("preload", placeOf(i, a), index);
        const Eigen::Index at_row = 3 * i + a;
        for (const Stop& stop : model_.connections[i].axis[a].stops) {
            if (!(stop.stiffness > 0)) continue;
            const bool positive = stop.side == Side::positive;
            const double reached = positive ? reach_.positive[at_row] : reach_.negative[at_row];
            for (const double far : kFarClearances) {
                if (far >= 1 || far * stop.clearance > reached) continue;
                const double step = (positive ? 1 : -1) * (1 - far) * stop.clearance;
                const int probe = addProbe({index, step, {}});
                Hypothesis& hypothesis = add("preload", {placeOf(i, a)});
                hypothesis.directions = {{{probe, 0.5 * stop.clearance}}};
                hypothesis.moves = {{probe, index}};
                hypothesis.tangent = {{{index, at(index).reach}}};
                hypothesis.reported = {index};
            }
        }
    }

    void addMissingStop(const StopRow& stop) {
        const Eigen::Index at_row = 3 * stop.connection + stop.axis;
        const double reached = stop.stop->side == Side::positive ? reach_.positive[at_row] : reach_.negative[at_row];
        if (!(reached > kStillAxis * scales_.displacement)) return;
        for (const double part : kMissingStops) {
            const double c = part * reached;
            const int probe = addProbe({stop.stiffness, at(stop.stiffness).step, {{stop.clearance, c}}});
            Hypothesis& hypothesis = add("clearance", {stop.side});
            hypothesis.directions = {{{probe, at(stop.stiffness).reach}}};
            hypothesis.start = {{stop.clearance, c}};
            hypothesis.moves = {{probe, stop.stiffness}};
            hypothesis.tangent = {{{stop.stiffness, at(stop.stiffness).reach}}, {{stop.clearance, kCommonReach * c}}};
            hypothesis.reported = {stop.clearance, stop.stiffness};
        }
    }

    /// Both sides of an axis, each by itself.
    void addPair(const std::vector<std::pair<std::string, int>>& members) {
        if (members.size() != 2) return;
        Hypothesis& hypothesis = add("clearance", {members[0].first, members[1].first});
        for (const auto& [place, index] : members) {
            hypothesis.directions.push_back({{index, at(index).reach}});
            hypothesis.reported.push_back(index);
        }
    }

    void addBody() {
        addSingle("mass", "body", row("body.mass"));
        const auto addTriple = [&](const char* cause, const std::string& prefix) {
            std::vector<int> rows;
            for (const char* axis : kAxes)
                if (const int index = row(prefix + axis); index >= 0) rows.push_back(index);
            if (rows.empty()) return;
            Hypothesis& all = add(cause, {"body"});
            for (const int index : rows) all.directions.push_back({{index, at(index).reach}});
            all.reported = rows;
            for (const int index : rows) {
                addSingle(cause, "body", index);
                result_.hypotheses.back().reported = rows;
            }
        };
        addTriple("cog_offset", "body.center_of_gravity.");
        addTriple("gyroscopic", "body.spin.");
        std::vector<std::pair<std::string, int>> moments;
        for (const char* name : kInertiaNames) {
            const int index = row(std::string("body.inertia.") + name);
            if (index < 0) continue;
            addSingle("inertia", "body", index);
            if (name[1] == name[2]) moments.emplace_back("body", index);
        }
        addCommon("inertia", moments);
        if (moments.size() < 2) return;
        Hypothesis& each = add("inertia", {"body"});
        for (const auto& [place, index] : moments) {
            each.directions.push_back({{index, at(index).reach}});
            each.reported.push_back(index);
        }
    }

    void addBracket(const ExcitedBand& swept) {
        for (std::size_t j = 0; j < model_.bracket.size(); ++j) {
            const std::string name = std::to_string(j + 1);
            const int frequency = row(name + ".frequency"), ratio = row(name + ".damping_ratio");
            if (model_.bracket[j].translation.isZero(0.0) && model_.bracket[j].rotation.isZero(0.0)) {
                result_.missing_mode_probe = result_.columns.probes.size();
                const int probe = addProbe({frequency, 1.0, {}});
                result_.missing_mode = static_cast<int>(result_.hypotheses.size());
                Hypothesis& hypothesis = add("bracket_mode", {"bracket"});
                hypothesis.directions = {{{probe, 1.0}}};
                continue;
            }
            for (int which = 0; which < 3; ++which) {
                Hypothesis& hypothesis = add("bracket_mode", {"bracket"});
                if (which != 1) hypothesis.directions.push_back({{frequency, at(frequency).reach}});
                if (which != 0) hypothesis.directions.push_back({{ratio, at(ratio).reach}});
                hypothesis.reported = {frequency, ratio};
            }
        }
        const int gain = row("load.gain");
        if (gain < 0) return;
        addSingle("load", "load", gain);
        if (!(swept.lowest > 0)) return;
        Hypothesis& hypothesis = add("load", {"load"});
        const double octaves = std::log2(swept.highest / swept.lowest);
        const int intervals = std::clamp(static_cast<int>(std::ceil(octaves * kPointsPerOctave)), 1, kMostPoints - 1);
        const double ratio = std::log(swept.highest / swept.lowest) / intervals;
        for (int k = 0; k <= intervals; ++k) {
            const double at_hat = swept.lowest * std::exp(ratio * k);
            result_.columns.hats.push_back({at_hat * std::exp(-ratio), at_hat, at_hat * std::exp(ratio)});
        }
        hat_hypothesis_ = static_cast<int>(result_.hypotheses.size()) - 1;
        hypothesis.reported = {gain};
    }

    /// Gains and delays of a channel; of a triax and of a side of one kind (`mobile.1`, `mobile.1.a`; `mobile`,
    /// `mobile.a`), and of both kinds (`mobile.1.all`, `mobile.all`): one amplifier, one clock.
    void addSensors() {
        const auto placeOf = [](const std::string& triax) {
            return triax.substr(0, triax.find('.', triax.find('.') + 1));
        };
        for (const char* key : {"gain", "delay"}) {
            const std::string cause = std::string("sensor_") + key;
            for (const auto& channel : layout_.channels) addSingle(cause, channel.name, row(channel.name + "." + key));
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
        for (const auto& triax : layout_.triaxes) {
            Hypothesis& hypothesis = add("sensor_misalignment", {triax.name});
            for (const char* axis : kAxes) {
                const int index = row(triax.name + ".r" + axis);
                hypothesis.directions.push_back({{index, at(index).reach}});
                hypothesis.reported.push_back(index);
            }
        }
    }

    void addCommonFault(const std::string& cause, const std::string& name, const std::vector<int>& rows) {
        Direction direction;
        for (const int index : rows) direction.emplace_back(index, at(index).reach);
        Hypothesis& hypothesis = add(cause, {name});
        hypothesis.directions = {direction};
        hypothesis.reported = rows;
    }

    void shareOdds() {
        // Hats come after all probes, whose number is known only now.
        if (hat_hypothesis_ >= 0) {
            auto& hypothesis = result_.hypotheses[hat_hypothesis_];
            const int first = static_cast<int>(table_.size() + result_.columns.probes.size());
            const int count = static_cast<int>(result_.columns.hats.size());
            for (int k = 0; k < count; ++k) {
                Direction onwards;
                for (int i = k; i < count; ++i) onwards.emplace_back(first + i, k == 0 ? kGainReach : kGainStep);
                hypothesis.directions.push_back(onwards);
            }
        }
        std::map<std::string, int> places;
        for (const auto& hypothesis : result_.hypotheses) ++places[hypothesis.cause];
        for (auto& hypothesis : result_.hypotheses)
            hypothesis.log_prior = -std::log(static_cast<double>(places.size()) * places[hypothesis.cause]);
    }

    const UnknownTable& table_;
    const SensorLayout& layout_;
    const MountModel& model_;
    const TestScales& scales_;
    const AxisReach& reach_;
    int hat_hypothesis_ = -1;
    Catalogue result_;
};

}  // namespace

Catalogue makeCatalogue(const UnknownTable& table, const SensorLayout& layout, const MountModel& model,
                        const TestScales& scales, const AxisReach& reach, const ExcitedBand& swept) {
    return CatalogueMaker(table, layout, model, scales, reach).make(swept);
}

std::string findSeparatingRun(const std::string& named, const std::string& rival) {
    const auto involves = [&](const char* cause) { return named == cause || rival == cause; };
    if (involves("preload"))
        return "a run with gravity along the axis, or turned by 180°: the offset moves with the load, a stop does not";
    if (involves("mass") || involves("load")) return "weigh the mobile part, or measure a force";
    if (involves("stiffness_drift")) return "a downward sweep of the same level";
    if (involves("relaxation") || involves("structural_damping"))
        return "a dwell at two frequencies an octave apart, same level";
    if (involves("friction") || involves("hysteresis") || involves("cubic_stiffness"))
        return "the same sweep at a quarter of the level";
    if (involves("clearance") || involves("stop_stiffness") || involves("stop_dissipation"))
        return "a higher level, which presses the stop further";
    return "a sweep at another level and along another axis";
}

}  // namespace wems::identify::updating
