#include "identify/catalogue/hypothesis_list.hpp"

#include <algorithm>
#include <cmath>

#include "models/common/format_number.hpp"
#include "models/guided_motion.hpp"

namespace wems::identify::updating {

HypothesisList::HypothesisList(const UnknownTable& table, const MountModel& model) : table_(table), model_(model) {
    catalogue_.columns.table = &table;
    catalogue_.columns.rows = table.size();
}

std::string HypothesisList::placeOf(ConnectionAxis axis) const {
    return model_.connections[axis.first].name + "." + kAxes[axis.second];
}

Hypothesis& HypothesisList::add(const std::string& cause, std::vector<std::string> where) {
    Hypothesis hypothesis;
    hypothesis.cause = cause;
    hypothesis.where = std::move(where);
    catalogue_.hypotheses.push_back(std::move(hypothesis));
    return catalogue_.hypotheses.back();
}

Hypothesis& HypothesisList::addSingle(const std::string& cause, const std::string& where, int index) {
    Hypothesis& hypothesis = add(cause, {where});
    hypothesis.directions = {{{index, at(index).reach}}};
    hypothesis.reported = {index};
    return hypothesis;
}

Hypothesis* HypothesisList::addCommon(const std::string& cause, const std::vector<PlacedRow>& members) {
    if (members.size() < 2) return nullptr;
    Direction direction;
    std::vector<std::string> where;
    std::vector<int> rows;
    for (const auto& [place, index] : members) {
        const Unknown& number = at(index);
        direction.emplace_back(index, number.believed != 0 ? kCommonReach * std::abs(number.believed) : number.reach);
        if (std::find(where.begin(), where.end(), place) == where.end()) where.push_back(place);
        rows.push_back(index);
    }
    Hypothesis& hypothesis = add(cause, where);
    hypothesis.directions = {direction};
    hypothesis.reported = rows;
    return &hypothesis;
}

void HypothesisList::addEach(const std::string& cause, const std::vector<std::string>& where,
                             const std::vector<int>& rows) {
    Hypothesis& hypothesis = add(cause, where);
    for (const int index : rows) hypothesis.directions.push_back({{index, at(index).reach}});
    hypothesis.reported = rows;
}

int HypothesisList::addProbe(const Probe& probe) {
    catalogue_.columns.probes.push_back(probe);
    return static_cast<int>(table_.size() + catalogue_.columns.probes.size()) - 1;
}

std::vector<ConnectionAxis> HypothesisList::axes() const {
    const GuidedMotion guide(model_.body);
    std::vector<ConnectionAxis> free;
    for (int i = 0; i < static_cast<int>(model_.connections.size()); ++i)
        for (int a = 0; a < 3; ++a)
            if (guide.moves(model_.connections[i].position, a)) free.emplace_back(i, a);
    return free;
}

std::vector<std::vector<ConnectionAxis>> HypothesisList::axisGroups() const {
    using Filter = bool (*)(int axis);
    const Filter filters[] = {[](int a) { return a == 2; }, [](int a) { return a == 0; }, [](int a) { return a == 1; },
                              [](int a) { return a != 2; }, [](int) { return true; }};
    std::vector<std::vector<ConnectionAxis>> groups;
    for (const Filter filter : filters) {
        std::vector<ConnectionAxis> group;
        for (const ConnectionAxis& axis : axes())
            if (filter(axis.second)) group.push_back(axis);
        if (!group.empty() && std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    }
    return groups;
}

}  // namespace wems::identify::updating
