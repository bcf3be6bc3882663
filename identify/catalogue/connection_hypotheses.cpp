#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "identify/catalogue/hypothesis_list.hpp"
#include "models/common/units.hpp"

namespace wems::identify::updating {
namespace {

// Clearances from here to there of the believed one, from where a gradient might not lead to the truth.
constexpr double kFarClearances[] = {0.55, 0.75, 1.3};
// A stop that the model lacks is sought at these parts of the largest displacement.
constexpr double kMissingStops[] = {0.35, 0.55, 0.75, 0.9};
// Sliding of a hysteresis is sought at these parts of the largest displacement.
constexpr double kYields[] = {0.1, 0.4};
// Of the largest displacement of any axis: one that moves less shows no stop or loop.
constexpr double kStillAxis = 0.05;
constexpr double kFarReach = 0.5;  // of the clearance, of a number that is sought away from the believed one

class ConnectionHypotheses {
public:
    ConnectionHypotheses(HypothesisList& list, const TestScales& scales, const AxisReach& reach)
        : list_(list), scales_(scales), reach_(reach) {}

    void addLaws() {
        addNumber("elastomer_stiffness", "stiffness", true);
        addNumber("viscous_damping", "damping", false);
        addNumber("structural_damping", "loss_factor", true);
        addShaped("friction", "friction_force", "transition_velocity", true,
                  [&](ConnectionAxis axis) { return list_.at(rowOf(axis, "transition_velocity")).believed; });
        addNumber("asymmetric_stiffness", "quadratic", false, true);
        addNumber("cubic_stiffness", "cubic", false, true);
        addNumber("stiffness_drift", "drift", true);
        for (const double corner : {0.5 * scales_.lowest, std::sqrt(scales_.lowest * scales_.highest), scales_.highest})
            addRelaxation(1 / (kTwoPi * corner));
        for (const double part : kYields) addHysteresis(part);
    }

    void addStops() {
        std::vector<StopRow> stops;
        for (const ConnectionAxis& axis : list_.axes())
            for (const Stop& stop : lawOf(axis).stops) {
                const std::string side = list_.placeOf(axis) + (stop.side == Side::positive ? ".+" : ".-");
                stops.push_back({axis, side, &stop, list_.row(side + ".clearance"), list_.row(side + ".stiffness")});
            }
        for (const StopRow& stop : stops) {
            if (stop.stop->stiffness > 0)
                addStop(stop);
            else
                addMissingStop(stop);
        }
        const auto collect = [&](int StopRow::*index, const std::vector<ConnectionAxis>& axes) {
            std::vector<PlacedRow> members;
            for (const StopRow& stop : stops)
                if (stop.stop->stiffness > 0 && std::find(axes.begin(), axes.end(), stop.axis) != axes.end())
                    members.emplace_back(stop.side, stop.*index);
            return members;
        };
        for (const ConnectionAxis& axis : list_.axes()) {
            list_.addCommon("stop_stiffness", collect(&StopRow::stiffness, {axis}));
            const std::vector<PlacedRow> clearances = collect(&StopRow::clearance, {axis});
            if (clearances.empty()) continue;
            if (clearances.size() == 2) {
                list_.addEach("clearance", {clearances[0].first, clearances[1].first},
                              {clearances[0].second, clearances[1].second});
                if (const int index = rowOf(axis, "offset"); index >= 0) addPreload(axis, index);
            }
            if (const int index = rowOf(axis, "dissipation"); index >= 0)
                list_.addSingle("stop_dissipation", list_.placeOf(axis), index);
        }
        for (const std::vector<ConnectionAxis>& axes : list_.axisGroups()) {
            if (axes.size() < 2) continue;
            list_.addCommon("stop_stiffness", collect(&StopRow::stiffness, axes));
            list_.addCommon("clearance", collect(&StopRow::clearance, axes));
            std::vector<PlacedRow> members;
            for (const ConnectionAxis& axis : axes)
                if (!collect(&StopRow::stiffness, {axis}).empty())
                    members.emplace_back(list_.placeOf(axis), rowOf(axis, "dissipation"));
            list_.addCommon("stop_dissipation", members);
        }
    }

private:
    struct StopRow {
        ConnectionAxis axis;
        std::string side;  ///< `4.z.+`
        const Stop* stop;
        int clearance, stiffness;  ///< rows of the parameter table
    };

    int rowOf(ConnectionAxis axis, const std::string& key) const { return list_.row(list_.placeOf(axis) + "." + key); }
    const AxisLaw& lawOf(ConnectionAxis axis) const { return list_.model().connections[axis.first].axis[axis.second]; }

    /// How far an axis moved towards a side, m.
    double reachOf(ConnectionAxis axis, Side side) const {
        const Eigen::Index at_row = 3 * axis.first + axis.second;
        return side == Side::positive ? reach_.positive[at_row] : reach_.negative[at_row];
    }
    bool isStill(double reached) const { return !(reached > kStillAxis * scales_.displacement); }

    /// What parts alike have of a force goes with their stiffnesses.
    void addShare(Hypothesis& hypothesis, ConnectionAxis axis, int index) const {
        const int stiffness = rowOf(axis, "stiffness");
        if (stiffness < 0) return;
        const Unknown& number = list_.at(stiffness);
        if (number.deviation > 0 && number.believed != 0)
            hypothesis.shares.emplace_back(index, number.deviation / std::abs(number.believed));
    }

    /// @param of_size a force of a part, not a ratio of its material
    void addNumber(const std::string& cause, const std::string& key, bool needs_stiffness, bool of_size = false) {
        const auto isThere = [&](ConnectionAxis axis) {
            return rowOf(axis, key) >= 0 && !(needs_stiffness && lawOf(axis).stiffness == 0);
        };
        for (const ConnectionAxis& axis : list_.axes())
            if (isThere(axis)) list_.addSingle(cause, list_.placeOf(axis), rowOf(axis, key));
        for (const std::vector<ConnectionAxis>& axes : list_.axisGroups()) {
            std::vector<PlacedRow> members;
            for (const ConnectionAxis& axis : axes)
                if (isThere(axis)) members.emplace_back(list_.placeOf(axis), rowOf(axis, key));
            Hypothesis* const common = list_.addCommon(cause, members);
            if (common == nullptr || !of_size) continue;
            for (const ConnectionAxis& axis : axes)
                if (isThere(axis)) addShare(*common, axis, rowOf(axis, key));
        }
    }

    /// A mechanism with an amplitude, zero in the model, and a shape in which the law is not linear: sought at one
    /// value of the shape, moved from there.
    /// @param of_size whether the amplitude is a force of a part, not a ratio of its material
    /// @param shapeOf value at an axis; 0 where the mechanism is not sought
    void addShaped(const std::string& cause, const std::string& amplitude, const std::string& shape, bool of_size,
                   const std::function<double(ConnectionAxis axis)>& shapeOf) {
        std::map<ConnectionAxis, int> probes;
        const auto probeOf = [&](ConnectionAxis axis) {
            const int size = rowOf(axis, amplitude), form = rowOf(axis, shape);
            if (size < 0 || form < 0) return -1;
            const double value = shapeOf(axis);
            if (!(value > 0)) return -1;
            const auto found = probes.find(axis);
            if (found != probes.end()) return found->second;
            return probes[axis] = list_.addProbe({size, list_.at(size).step, {{form, value}}});
        };
        const auto addSet = [&](const std::vector<ConnectionAxis>& axes) {
            Direction direction, sizes, forms;
            Hypothesis hypothesis;
            // Parts alike have one shape: as the axis that moves most shows it.
            double one = 0;
            for (const ConnectionAxis& axis : axes) one = std::max(one, probeOf(axis) < 0 ? 0.0 : shapeOf(axis));
            for (const ConnectionAxis& axis : axes) {
                const int probe = probeOf(axis);
                if (probe < 0) continue;
                const int size = rowOf(axis, amplitude), form = rowOf(axis, shape);
                hypothesis.where.push_back(list_.placeOf(axis));
                direction.emplace_back(probe, list_.at(size).reach);
                sizes.emplace_back(size, list_.at(size).reach);
                forms.emplace_back(form, one);
                hypothesis.start.emplace_back(form, one);
                hypothesis.moves.emplace_back(probe, size);
                hypothesis.reported.push_back(size);
                hypothesis.reported.push_back(form);
                if (of_size && axes.size() > 1) addShare(hypothesis, axis, size);
            }
            if (direction.empty()) return;
            hypothesis.cause = cause;
            hypothesis.directions = {direction};
            hypothesis.tangent = {sizes, forms};
            list_.catalogue().hypotheses.push_back(hypothesis);
        };
        for (const ConnectionAxis& axis : list_.axes()) addSet({axis});
        for (const std::vector<ConnectionAxis>& axes : list_.axisGroups())
            if (axes.size() > 1) addSet(axes);
    }

    /// @param time_constant s
    void addRelaxation(double time_constant) {
        addShaped("relaxation", "stiffness_ratio", "time_constant", false, [&, time_constant](ConnectionAxis axis) {
            return lawOf(axis).stiffness == 0 || lawOf(axis).relaxation ? 0.0 : time_constant;
        });
    }

    /// @param part of the largest displacement of the axis, where sliding begins
    void addHysteresis(double part) {
        addShaped("hysteresis", "hysteresis_force", "yield_displacement", true, [&, part](ConnectionAxis axis) {
            const double reached = std::max(reachOf(axis, Side::positive), reachOf(axis, Side::negative));
            return lawOf(axis).hysteresis || isStill(reached) ? 0.0 : part * reached;
        });
    }

    void addStop(const StopRow& stop) {
        list_.addSingle("stop_stiffness", stop.side, stop.stiffness);
        list_.addSingle("clearance", stop.side, stop.clearance);
        const double c = stop.stop->clearance;
        for (const double far : kFarClearances)
            if (std::min(c, far * c) <= reachOf(stop.axis, stop.stop->side))
                addFar("clearance", stop.side, stop.clearance, (far - 1) * c, c);
    }

    /// Beside that from where the offset is: so far that a stop is reached which the believed one leaves alone.
    void addPreload(ConnectionAxis axis, int index) {
        list_.addSingle("preload", list_.placeOf(axis), index);
        for (const Stop& stop : lawOf(axis).stops) {
            if (!(stop.stiffness > 0)) continue;
            for (const double far : kFarClearances)
                if (far < 1 && far * stop.clearance <= reachOf(axis, stop.side))
                    addFar("preload", list_.placeOf(axis), index,
                           (stop.side == Side::positive ? 1 : -1) * (1 - far) * stop.clearance, stop.clearance);
        }
    }

    /// A number sought at a step from where it is.
    void addFar(const std::string& cause, const std::string& where, int index, double step, double clearance) {
        const int probe = list_.addProbe({index, step, {}});
        Hypothesis& hypothesis = list_.add(cause, {where});
        hypothesis.directions = {{{probe, kFarReach * clearance}}};
        hypothesis.moves = {{probe, index}};
        hypothesis.tangent = {{{index, list_.at(index).reach}}};
        hypothesis.reported = {index};
    }

    void addMissingStop(const StopRow& stop) {
        const double reached = reachOf(stop.axis, stop.stop->side);
        if (isStill(reached)) return;
        const Unknown& stiffness = list_.at(stop.stiffness);
        for (const double part : kMissingStops) {
            const double c = part * reached;
            const int probe = list_.addProbe({stop.stiffness, stiffness.step, {{stop.clearance, c}}});
            Hypothesis& hypothesis = list_.add("clearance", {stop.side});
            hypothesis.directions = {{{probe, stiffness.reach}}};
            hypothesis.start = {{stop.clearance, c}};
            hypothesis.moves = {{probe, stop.stiffness}};
            hypothesis.tangent = {{{stop.stiffness, stiffness.reach}}, {{stop.clearance, kCommonReach * c}}};
            hypothesis.reported = {stop.clearance, stop.stiffness};
        }
    }

    HypothesisList& list_;
    const TestScales& scales_;
    const AxisReach& reach_;
};

}  // namespace

void addConnectionHypotheses(HypothesisList& list, const TestScales& scales, const AxisReach& reach) {
    ConnectionHypotheses hypotheses(list, scales, reach);
    hypotheses.addLaws();
    hypotheses.addStops();
}

}  // namespace wems::identify::updating
