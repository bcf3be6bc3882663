/// @file
/// Simbody as this project sees it: its headers, a guard for their layout, and conversions to and from Eigen.
#pragma once

#include <Simbody.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "models/mount_forces.hpp"

namespace wems::plugin {

// Debian's library is built with asserts. Under NDEBUG its headers give this class fewer members than the library
// has, and any force element with a cache entry corrupts memory.
static_assert(sizeof(SimTK::CacheEntryInfo) == 168, "Simbody must be compiled against without NDEBUG");

inline Eigen::Vector3d toEigen(const SimTK::Vec3& v) {
    return {v[0], v[1], v[2]};
}
inline SimTK::Vec3 toSimTK(const Eigen::Vector3d& v) {
    return {v.x(), v.y(), v.z()};
}
inline Eigen::Matrix3d toEigen(const SimTK::Mat33& m) {
    Eigen::Matrix3d result;
    result << m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2);
    return result;
}
/// @pre R is a rotation matrix to rounding; it is not checked.
inline SimTK::Rotation toSimTK(const Eigen::Matrix3d& R) {
    return SimTK::Rotation(
        SimTK::Mat33(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)), true);
}
inline SimTK::SpatialVec toSimTK(const Wrench& wrench) {
    return {toSimTK(wrench.moment), toSimTK(wrench.force)};
}

/// Motion in G of a frame that sits at X_BP on a body; needs Stage::Velocity.
inline BodyMotion calcFrameMotion(const SimTK::MobilizedBody& body, const SimTK::Transform& X_BP,
                                  const SimTK::State& state) {
    const SimTK::Transform& X_GB = body.getBodyTransform(state);
    const SimTK::SpatialVec& V_GB = body.getBodyVelocity(state);
    const SimTK::Vec3 p_BP_G = X_GB.R() * X_BP.p();
    BodyMotion motion;
    motion.R_GM = toEigen((X_GB.R() * X_BP.R()).asMat33());
    motion.p_GM = toEigen(X_GB.p() + p_BP_G);
    motion.w_GM = toEigen(V_GB[0]);
    motion.v_GM = toEigen(V_GB[1] + V_GB[0] % p_BP_G);
    return motion;
}

/// Mass properties of the mobile part about the origin of M, in M.
inline SimTK::MassProperties makeMassProperties(const MobileBody& body) {
    const Eigen::Matrix3d& I = body.inertia;
    const SimTK::Inertia about_cog(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
    const SimTK::Vec3 cog = toSimTK(body.center_of_gravity);
    return SimTK::MassProperties(body.mass, cog, about_cog.shiftFromMassCenter(-cog, body.mass));
}

}  // namespace wems::plugin
