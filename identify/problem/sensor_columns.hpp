/// @file
/// What the errors of sensors do: to the rigid motions that the channels give, and to what the channels show beyond
/// them.
///
/// With H the channels' design, W their weights in the fused motion and s the change of a channel by a unit error, the
/// motion changes by −W H⁺ s and the channels' residual by −(1 − H W H⁺) s. The motion that has changed turns the
/// sensors' levers otherwise: with N what it makes the channels read beyond H times itself (second_order.hpp), both
/// change by as much again with N in the place of s.
#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "identify/problem/information.hpp"
#include "identify/problem/run_noise.hpp"
#include "identify/problem/second_order.hpp"
#include "identify/problem/unknown.hpp"

namespace wems::identify {

/// Six signals, by which errors of a kind in a group of channels move a part: for each coordinate of its motion.
struct SensorSignals {
    SecondOrder::Signals samples;
    /// The equations' terms are tapered when they have been formed. What the spectra of the tapered signal and of its
    /// derivatives have beyond S, iωS and −ω²S, S the spectrum that the channels' tapered readings give: 6 x bins.
    std::array<Eigen::MatrixXcd, 3> edges;
    Eigen::MatrixXcd modal_edges;  ///< of the bracket's modes (TurningWrench)
};

/// Change of a part's motion (translation above rotation, as displacement) by a unit of an error.
struct SensorEffect {
    /// Of one channel: the motion moves by `spectrum` along `direction`.
    struct ChannelChange {
        Vector6 signal;     ///< by which the channel's change follows from the motion
        Vector6 direction;  ///< in which the channel moves the fused motion
        /// At each bin: what of signal · motion enters the motion. One for all channels of a kind under errors of a
        /// kind.
        std::shared_ptr<const Eigen::VectorXcd> weight;
        Eigen::VectorXcd spectrum;  ///< tapered, at each bin
    };
    /// Of the channels of a group: the motion moves by `turn` times signals that all errors of a kind share.
    struct GroupChange {
        Matrix6 turn;
        std::shared_ptr<const SensorSignals> signals;
    };
    Part part = Part::mobile;
    std::vector<ChannelChange> changes;  ///< none: the unknown is no sensor's
    std::vector<GroupChange> groups;     ///< the same at the samples, to first order; after addSecondOrder
    /// Beyond first order (SecondOrder): of the motion (6 x bins), and beside it of what is demanded of the mobile part
    /// above what the laws give (12 x bins). Empty where it is nothing.
    Eigen::MatrixXcd correction, wrench;
};

/// Of the unknowns of a table.
class SensorColumns {
public:
    /// @param wanted rows of the table that count; empty: all
    SensorColumns(const TestRun& test, const SensorLayout& layout, const OpenLoopRun& run,
                  const EquationSpectra& spectra, const MotionNoise& noise, const UnknownTable& table,
                  const std::vector<char>& wanted);

    /// Forms what the errors do at the samples and beyond first order: before calcEffect and calcInformation.
    /// @param wrenches by the mobile and by the fixed part's motion
    void addSecondOrder(const std::array<TurningWrench, 2>& wrenches);

    SensorEffect calcEffect(std::size_t row) const;

    /// What the channels of a part say beyond its rigid motion.
    /// @param size columns of the information; those of the table come first
    BlockInformation calcInformation(Part part, Eigen::Index size) const;

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
    /// A unit error's change of one channel.
    struct Change {
        std::size_t group;
        Eigen::Index channel;
        Eigen::VectorXcd spectrum;  // tapered, at the bins
        Vector6 signal;             // change = signal · motion, beside the transfer
    };
    /// Of the smoothed motion.
    Eigen::RowVectorXd calcReading(const SensorChannel& channel, const Group& group) const;
    /// What a unit of an unknown makes of a channel beside the transfer; empty if nothing.
    /// @param from by which it follows from the motion
    Eigen::RowVectorXd calcSignal(const Unknown& row, const Group& group, Eigen::Index channel, Vector6& from) const;
    std::vector<Change> calcChanges(const Unknown& row) const;
    /// What a change of that spectrum in a channel of a group is as a displacement in the fused motion, with its two
    /// derivatives, at the samples.
    Eigen::MatrixX3d calcDerivatives(const Eigen::RowVectorXcd& spectrum, const Group& group, UnknownKind kind) const;
    /// Of the fused displacement by a channel's change at a bin.
    double calcWeight(const Group& group, double w) const;
    /// By which errors of a kind in a group move the part, for each coordinate of its motion.
    SensorSignals calcSignals(const Group& group, UnknownKind kind, const TurningWrench& wrench) const;
    /// Of a part's channels, those of all its groups below each other, then the wrench of the mobile part.
    TurningOutputs makeOutputs(const std::vector<std::size_t>& groups, const TurningWrench& wrench) const;
    std::vector<std::size_t> findGroups(Part part) const;
    /// By how the channels' errors move the part.
    Matrix6 calcMotionChange(std::size_t row, std::size_t group) const;
    // Of sensor_information.cpp, at `count` bins from one on: whitened, real beside imaginary parts.
    Eigen::VectorXd calcColumn(const std::vector<std::size_t>& groups, Eigen::Index unknown, Eigen::Index rows,
                               Eigen::Index from, Eigen::Index count) const;
    Eigen::VectorXd whiten(const std::vector<std::size_t>& groups, Eigen::MatrixXcd& rows, Eigen::Index from) const;
    /// What the noise of a channel's reading adds to the slope of its gain in the mean, in the sensors' own equations.
    Eigen::MatrixXd calcGainSlopes(const std::vector<std::size_t>& groups, Eigen::Index size) const;

    /// What a channel of a group, changed by an error of a kind, enters the motion with.
    void addWeight(std::size_t group, UnknownKind kind);

    const SensorLayout& layout_;
    const OpenLoopRun& run_;
    const EquationSpectra& spectra_;
    const MotionNoise& noise_;
    const UnknownTable& table_;
    Fourier fourier_;
    std::vector<Group> groups_;
    std::vector<std::vector<Change>> changes_;  // of each row of the table
    std::vector<Eigen::MatrixXcf> second_;      // of each row: makeOutputs x bins; empty: nothing
    std::map<std::pair<std::size_t, UnknownKind>, std::shared_ptr<const Eigen::VectorXcd>> weights_;
    std::map<std::pair<std::size_t, UnknownKind>, std::shared_ptr<const SensorSignals>> signals_;
};

}  // namespace wems::identify
