/// @file
/// One run's equations about a state: whitened residuals, their derivatives by every unknown, and what they say.
///
/// Mount: what the measured motion demands minus what the laws give, six values at each frequency. Bracket: predicted
/// minus measured motion of the fixed part. Sensors: what a channel reads beyond the rigid motion of its part. All
/// along the measured motion, so that nothing chaotic enters; each in units of its own noise (run_noise.hpp).
///
/// Derivatives are of first order about the state, laws by differences of their force histories along the rest
/// direction of their axis. A contact's tangent stiffness and damping take part wherever a sensor's error moves the
/// motion, and slow motion follows. What the error moves is of second order in the motion (second_order.hpp).
#pragma once

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "identify/problem/information.hpp"
#include "identify/problem/test_run.hpp"
#include "identify/problem/unknown.hpp"

namespace wems::identify {

/// A change far from the state: a column of its own, as the equations are not linear in the number.
struct Probe {
    int parameter = 0;                           ///< row of the table, of kind law; of kind mode: that mode as preset
    double step = 0;                             ///< the column is (residual after the step − before) / step
    std::vector<std::pair<int, double>> preset;  ///< rows and values that are set first
};

/// A gain of the load about a swept frequency: a hat, linear on both sides.
struct LoadHat {
    double below = 0, at = 0, above = 0;  ///< Hz
};

/// A force of the displacement alone at one axis of a connection, beside the law that is there.
/// The law has no curve of its own.
struct AddedCurve {
    int connection = 0, axis = 0;
    std::vector<CurveRow> rows;
};

/// Columns of an Information: the table's rows, then probes, then hats, then curves.
struct ColumnSet {
    const UnknownTable* table = nullptr;
    std::size_t rows = 0;  ///< of the table
    std::vector<Probe> probes;
    std::vector<LoadHat> hats;
    std::vector<AddedCurve> curves;  ///< always formed
    std::vector<char> wanted;        ///< columns that are formed; empty: all. The others say nothing.
    void wantNone() { wanted.assign(size(), 0); }
    bool wants(std::size_t column) const { return wanted.empty() || wanted[column] != 0; }
    std::size_t firstCurve() const { return rows + probes.size() + hats.size(); }
    Eigen::Index size() const { return static_cast<Eigen::Index>(firstCurve() + curves.size()); }
};

struct LinearisedRun {
    Information information;
    /// Whitened residual of the mount's equation (6 x bins), the whitened directions of each axis (6 x bins), and
    /// frequencies (Hz): where what is left sits.
    Eigen::MatrixXcd mount_residual;
    std::vector<Eigen::MatrixXcd> axis_directions;
    Eigen::VectorXd frequency;
    double contact_share = 0;  ///< share of the mount residual's power that lies within contact, 0 … 1
};

class Lineariser;

/// @param run its motion is that of the sensors as the state has them
/// @param[in,out] at of that run and state
LinearisedRun linearise(Lineariser& at, const TestRun& run, const SensorLayout& layout, const ColumnSet& columns,
                        const TestState& state);

/// Misfit alone: chi-squared and count of each block, weighed by the covariance of the state itself.
Information calcMisfit(const Lineariser& at, const TestRun& run, const SensorLayout& layout, const TestState& state);

}  // namespace wems::identify
