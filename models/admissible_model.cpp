#include "models/admissible_model.hpp"

#include "models/axis_numbers.hpp"
#include "models/body_inertia.hpp"
#include "models/format_number.hpp"

namespace wems {
namespace {

void raiseToZero(double& value, const std::string& name, const std::string& unit, std::vector<std::string>& notes) {
    if (!(value < 0)) return;
    notes.push_back(name + " is identified as " + formatNumber(value, 4) + (unit == "-" ? "" : " " + unit) +
                    "; the fitted model holds 0, since a value below is none of a passive element");
    value = 0;
}

std::string formatMoments(const Eigen::Matrix3d& inertia) {
    const Eigen::Vector3d principal = calcPrincipalMoments(inertia);
    return formatNumber(principal[0], 4) + ", " + formatNumber(principal[1], 4) + ", " + formatNumber(principal[2], 4);
}

}  // namespace

std::vector<std::string> makeAdmissible(const MountModel& believed, MountModel& model) {
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
    if (!model.body.inertia.allFinite()) return notes;  // validate() says so
    const Eigen::Matrix3d limited = limitInertia(believed.body.inertia, model.body.inertia);
    if (limited != model.body.inertia) {
        notes.push_back("body.inertia is identified with the principal moments " + formatMoments(model.body.inertia) +
                        " kg m^2, which no body has; the fitted model holds " + formatMoments(limited) +
                        ", the way from the believed ones as far as bodies go");
        model.body.inertia = limited;
    }
    return notes;
}

}  // namespace wems
