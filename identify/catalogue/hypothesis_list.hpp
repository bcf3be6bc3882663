/// @file
/// A catalogue in the making: what every kind of hypothesis is put together from.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identify/catalogue/hypotheses.hpp"

namespace wems::identify::updating {

constexpr double kCommonReach = 0.5;  // of the number, of a factor that many share

/// A name that results list, `4.z`, and a row of the parameter table there.
using PlacedRow = std::pair<std::string, int>;
/// Connection and axis, both from 0.
using ConnectionAxis = std::pair<int, int>;

class HypothesisList {
public:
    HypothesisList(const UnknownTable& table, const MountModel& model);

    const UnknownTable& table() const { return table_; }
    const MountModel& model() const { return model_; }
    Catalogue& catalogue() { return catalogue_; }

    /// Row of the parameter table, −1 if it has none of this name.
    int row(const std::string& name) const { return findUnknown(table_, name); }
    const Unknown& at(int index) const { return table_[index]; }
    std::string placeOf(ConnectionAxis axis) const;

    Hypothesis& add(const std::string& cause, std::vector<std::string> where);
    Hypothesis& addSingle(const std::string& cause, const std::string& where, int index);
    /// One factor for all rows of a list. @return the hypothesis until the next is added; null for fewer than two rows
    Hypothesis* addCommon(const std::string& cause, const std::vector<PlacedRow>& members);
    /// Each row by itself.
    void addEach(const std::string& cause, const std::vector<std::string>& where, const std::vector<int>& rows);
    /// @return the probe's column
    int addProbe(const Probe& probe);

    /// Every axis of every connection along which guides leave it free.
    std::vector<ConnectionAxis> axes() const;
    /// The axial, each lateral, both lateral and all axes together, as far as these differ.
    std::vector<std::vector<ConnectionAxis>> axisGroups() const;

private:
    const UnknownTable& table_;
    const MountModel& model_;
    Catalogue catalogue_;
};

/// Laws of the connections and their stops.
/// @param reach how far each axis moved
void addConnectionHypotheses(HypothesisList& list, const TestScales& scales, const AxisReach& reach);

}  // namespace wems::identify::updating
