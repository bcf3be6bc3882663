#include "identify/fit/linear_response.hpp"

#include <Eigen/Geometry>

#include "identify/fit/law_history.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {
namespace {

/// About M's origin, translation above rotation, at rest.
Matrix6d makeMassMatrix(const MobileBody& body) {
    const Eigen::Vector3d& c = body.center_of_gravity;
    Eigen::Matrix3d cross;
    cross << 0, -c.z(), c.y(), c.z(), 0, -c.x(), -c.y(), c.x(), 0;
    Matrix6d mass;
    mass << body.mass * Eigen::Matrix3d::Identity(), -body.mass * cross, body.mass * cross,
        body.inertia - body.mass * cross * cross;
    return mass;
}

}  // namespace

LinearResponse makeLinearResponse(const RunMotion& motion, const MountModel& model) {
    LinearResponse response;
    response.mass = makeMassMatrix(model.body);
    const RelativeHistory relative = calcRelativeHistory(motion, model);
    response.tangent.resize(relative.q.cols(), relative.q.rows());
    response.directions.resize(6, relative.q.cols());
    response.damping.resize(relative.q.cols());
    for (Eigen::Index axis = 0; axis < relative.q.cols(); ++axis) {
        const Connection& connection = model.connections[axis / 3];
        const AxisLaw& law = connection.axis.at(axis % 3);
        const AxisForce force(law);
        const Eigen::Vector3d e = Eigen::Vector3d::Unit(axis % 3);
        response.directions.col(axis) << e, connection.position.cross(e);
        response.damping(axis) = law.damping;
        for (Eigen::Index k = 0; k < relative.q.rows(); ++k)
            response.tangent(axis, k) = force.calcStaticStiffness(relative.q(k, axis));
    }
    return response;
}

}  // namespace wems::identify
