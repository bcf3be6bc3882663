/// @file
/// What the errors of sensors do: to the rigid motions that the channels give, and to what the channels show beyond
/// them.
///
/// With H the channels' design, W their weights in the fused motion and s the change of a channel by a unit error, the
/// motion changes by −W H⁺ s and the channels' residual by −(1 − H W H⁺) s.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/problem/information.hpp"
#include "identify/problem/run_noise.hpp"
#include "identify/problem/unknown.hpp"

namespace wems::identify {

/// Change of a part's motion (translation above rotation, as displacement) by a unit of an error; empty if there is
/// none.
struct SensorEffect {
    /// Of one channel: how its change follows from the part's motion (6), what of it enters the motion, and where (6).
    struct ChannelChange {
        Vector6 signal, direction;
        Eigen::VectorXcd weight;  ///< at each bin
    };
    Part part = Part::mobile;
    std::vector<ChannelChange> changes;
    Eigen::MatrixXd series;    ///< 6 x samples; empty unless asked for
    Eigen::MatrixXcd spectra;  ///< 6 x bins, tapered
};

class SensorColumns {
public:
    SensorColumns(const TestRun& test, const SensorLayout& layout, const OpenLoopRun& run,
                  const EquationSpectra& spectra, const MotionNoise& noise);

    SensorEffect calcEffect(const Unknown& row, bool with_series) const;

    /// What the channels of a part say beyond its rigid motion.
    /// @param size columns of the information; those of the table come first
    /// @param wanted rows of the table that count; empty: all
    BlockInformation calcInformation(Part part, const UnknownTable& table, const std::vector<char>& wanted,
                                     Eigen::Index size) const;

private:
    /// Channels of a group in this recording.
    struct Group {
        Part part;
        Derivative derivative;
        std::vector<int> channels;
        Eigen::MatrixXd design, inverse;  // channels x 6, 6 x channels
        Eigen::MatrixXd reading;          // of the smoothed motion, channels x samples
        Eigen::MatrixXcd residual;        // tapered, channels x bins
        const NoiseDensity* noise;
        Eigen::Index rank = 0;
    };
    /// A unit error's change of one channel: its tapered spectrum at the bins and, if asked for, its series as a
    /// displacement in the fused motion.
    struct Change {
        const Group* group;
        Eigen::Index channel;
        Eigen::MatrixXcd spectrum;  // 1 x bins
        Eigen::RowVectorXd series;
        Vector6 signal;  // change = signal · motion, beside the transfer
    };
    /// What the noise of a channel's reading adds to the slope of its gain in the mean, in the sensors' own equations.
    Eigen::MatrixXd calcGainSlopes(const std::vector<const Group*>& groups, const UnknownTable& table,
                                   Eigen::Index size) const;
    std::vector<Change> calcChanges(const Unknown& row, bool with_series) const;
    /// What a corner of 1 Hz adds to each row (x samples), or to a row of the motion that follows from all channels.
    Eigen::MatrixXd integrate(const Eigen::MatrixXd& rows, Part part, bool in_motion) const;
    /// What a corner of 1 Hz changes in the channels of a part's groups beyond what it does to the motion: channels x
    /// bins, tapered.
    std::vector<Eigen::MatrixXcd> calcCornerChanges(const std::vector<const Group*>& groups, Part part) const;
    Change makeChange(const Group& group, Eigen::Index channel, const Eigen::RowVectorXd& signal, UnknownKind kind,
                      bool with_series) const;
    /// Of the fused displacement by a channel's change at a bin.
    std::complex<double> calcWeight(const Group& group, double w) const;

    const SensorLayout& layout_;
    const OpenLoopRun& run_;
    const EquationSpectra& spectra_;
    const MotionNoise& noise_;
    Fourier fourier_;
    std::vector<Group> groups_;
};

}  // namespace wems::identify
