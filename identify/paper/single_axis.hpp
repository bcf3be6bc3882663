/// @file
/// The classical identification of a mount: Newton's equation along one axis, linear in the stiffnesses,
///
///     m a + Σ_i f_i(q_i) = 0,      f_i = k_i q_i + stops with known clearances,
///
/// solved by truncated SVD. a is the acceleration of the centre of the markers (their mean) or of the centre of
/// gravity, q_i the plain difference of the displacements of both ends of connection i. No damping, no intervals, no
/// moments: what fitMount() does with six equations, this does with one, to be compared with published results.
///
/// Nonparametric force of a term: what the equation leaves to it once all other terms are taken away.
///
/// Source: Noël, Kerschen, Newerla, "Application of the restoring force surface method to a real-life spacecraft
/// structure", IMAC XXX (2012), sections 3.4 and 3.5.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/paper/truncated_svd.hpp"
#include "models/mount_model.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// Signals of the one-axis equation: relative displacements, and the acceleration of one point of the mobile part.

struct SingleAxisData {
    Eigen::MatrixXd q;         ///< samples × 3 · connections, relative displacements from rest, m
    Eigen::MatrixXd v;         ///< the same differentiated, m/s
    Eigen::MatrixXd a_centre;  ///< samples × 3, mean of the markers of the mobile part, m/s²
    Eigen::MatrixXd a_body;    ///< samples × 3, centre of gravity, m/s²
    Eigen::VectorXd hertz;     ///< swept frequency; NaN unless the drive is a sine
    std::vector<std::string> notes;
};

/// Plain differences and means of the recorded channels, as the classical method has them. What was not recorded
/// (displacements or accelerations), and the centre of gravity's acceleration, come from the rigid motion.
/// @throws InputError as estimateMotion()
SingleAxisData collectSingleAxisData(const Recording& recording, const MountModel& model);

/// The point whose acceleration enters Newton's equation.
enum class AccelerationPoint { marker_centre, center_of_gravity };

struct SingleAxisOptions {
    int axis = 2;                  ///< of Newton's equation: 0 x, 1 y, 2 z
    std::vector<int> candidates;   ///< axes whose forces may enter; empty: `axis` alone
    bool hold_elastomers = false;  ///< keep the model's elastomer stiffnesses, identify the stops alone
    bool stops = true;             ///< stops that are reached take part
    bool damping = false;          ///< one dashpot for all connections of an axis, for each candidate axis
    AccelerationPoint point = AccelerationPoint::marker_centre;
    int keep = 0;                    ///< singular values kept; 0: findNumericalRank()
    double lowest = 0, highest = 0;  ///< Hz of swept frequency, window; highest 0: the whole run
};

struct SingleAxisTerm {
    std::string name;  ///< `1.z.stiffness`, `4.z.stops.stiffness` (both sides in one), `1.x.-.stiffness`, `z.damping`
    std::string unit;
    double model_value = 0;
    double value = 0;
    double confidence = 0, confidence_refitted = 0;  ///< see truncated_svd.hpp
    bool held = false;                               ///< the model's value was kept
    Eigen::VectorXd q, force;  ///< m, N: nonparametric force of the connection's axis; for stiffness terms
};

struct SingleAxisResult {
    std::vector<SingleAxisTerm> terms;
    Eigen::VectorXd singular_percent;
    int rank = 0;
    double residual_fraction = 0;  ///< of the inertia force, held terms taken away
    std::vector<std::string> notes;
    MountModel model;  ///< with the identified stiffnesses
};

/// @throws InputError if channels are missing, the window is empty, or nothing is left to identify.
SingleAxisResult identifySingleAxis(const Recording& recording, const MountModel& model,
                                    const SingleAxisOptions& options);

}  // namespace wems::identify
