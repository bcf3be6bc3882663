#include "models/static_sag.hpp"

#include "models/bryant.hpp"
#include "models/mount_forces.hpp"

namespace wems {

std::string nameStop(const MountModel& model, const StopMargin& margin) {
    const Connection& connection = model.connections[margin.connection];
    const Stop& stop = connection.axis[margin.axis].stops[margin.stop];
    return connection.name + "." + "xyz"[margin.axis] + (stop.side == Side::positive ? ".+" : ".-");
}

StaticSag findStaticSag(const MountModel& model) {
    const StaticEquilibrium rest = findStaticEquilibrium(model);
    FrameMotion fixed;
    if (!model.bracket.empty())
        fixed = Bracket(model.bracket).calcMotion(rest.eta, Eigen::VectorXd::Zero(rest.eta.size()));
    const Eigen::Vector3d& center = model.body.center_of_gravity;
    StaticSag sag;
    sag.displacement = rest.mobile.p_GM + rest.mobile.R_GM * center - center;
    sag.rotation = vectorFromRotation(rest.mobile.R_GM);
    const MountForces laws(model);
    sag.relative.resize(3, laws.connectionCount());
    sag.force.resize(3, laws.connectionCount());
    for (int i = 0; i < laws.connectionCount(); ++i) {
        const Connection& connection = model.connections[i];
        sag.relative.col(i) = calcRelativeMotion(rest.mobile, fixed, connection.position).q;
        for (int k = 0; k < 3; ++k) {
            const double q = sag.relative(k, i);
            sag.force(k, i) = laws.axis(i, k).calcStaticForce(q);
            const AxisLaw& law = connection.axis[k];
            for (std::size_t s = 0; s < law.stops.size(); ++s) {
                const double direction = law.stops[s].side == Side::positive ? 1 : -1;
                sag.stops.push_back(
                    {i, k, s, law.stops[s].clearance, law.stops[s].clearance - direction * (q + law.offset)});
            }
        }
    }
    return sag;
}

}  // namespace wems
