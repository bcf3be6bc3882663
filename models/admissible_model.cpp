#include "models/admissible_model.hpp"

#include "models/axis_numbers.hpp"
#include "models/format_number.hpp"

namespace wems {
namespace {

void raiseToZero(double& value, const std::string& name, const std::string& unit, std::vector<std::string>& notes) {
    if (!(value < 0)) return;
    notes.push_back(name + " is identified as " + formatNumber(value, 4) + (unit == "-" ? "" : " " + unit) +
                    "; the model that is written holds 0, since a value below is none of a passive element");
    value = 0;
}

}  // namespace

std::vector<std::string> makeAdmissible(MountModel& model) {
    std::vector<std::string> notes;
    for (Connection& connection : model.connections) {
        for (std::size_t axis = 0; axis < connection.axis.size(); ++axis) {
            AxisLaw& law = connection.axis.at(axis);
            const std::string place = connection.name + "." + "xyz"[axis] + ".";
            for (const AxisNumber& number : kAxisNumbers)
                if (number.range == AxisNumber::Range::not_negative)
                    raiseToZero(law.*number.member, place + number.key, number.unit, notes);
            for (Stop& stop : law.stops)
                raiseToZero(stop.dissipation, place + (stop.side == Side::positive ? "+" : "-") + ".dissipation", "s/m",
                            notes);
            if (law.friction) raiseToZero(law.friction->force, place + "friction_force", "N", notes);
        }
    }
    return notes;
}

}  // namespace wems
