/// @file
/// What the motion of a part takes from its channels, whether it has six motions or a few: which channels, from which
/// frequency to which, and what the user is told of it.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "identify/motion/part_motion.hpp"
#include "identify/motion/rigid_fit.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

class PartEstimator {
protected:
    PartEstimator(const Recording& recording, Part part)
        : recording_(recording), part_(part), interval_(recording.sampleInterval()) {}

    /// Acceleration channels; velocities differentiated where there is nothing else.
    ChannelSet collectAccelerations(const MountModel& model, const ChannelSet& displacements);
    /// What is measured and how far it is trusted, before the motion is known.
    void begin(bool displacement, bool acceleration);

    /// Cutoff (Hz) for derivatives of displacements alone; they are trusted to half of it.
    /// @param coordinates coordinates x samples, each over its deviation from unit noise on every channel
    double chooseCutoff(const Eigen::MatrixXd& coordinates);
    void noteDerivatives(double cutoff);
    /// Trusts displacements from accelerations alone from 0.6 of the lowest excited frequency on.
    /// @throws InputError if nothing moves
    void chooseIntegrationBand();
    void noteIntegration();

    void note(const std::string& text);
    /// @param fit GuidedFit or RigidFit
    template <typename Fit>
    [[noreturn]] void throwUndetermined(const Fit& displacement, const Fit& acceleration,
                                        const std::string& accepted) const {
        const bool use_displacement = displacement.channelSet().count() >= acceleration.channelSet().count();
        throwUndetermined(use_displacement ? "displacement" : "acceleration",
                          (use_displacement ? displacement : acceleration).undetermined(), accepted);
    }
    /// `mobile`, as channel names begin.
    const char* key() const { return part_ == Part::mobile ? "mobile" : "fixed"; }

    const Recording& recording_;
    Part part_;
    double interval_;
    PartEstimate result_;
    bool from_velocity_ = false;

private:
    [[noreturn]] void throwUndetermined(const std::string& kind, const std::vector<std::string>& motions,
                                        const std::string& accepted) const;
};

}  // namespace wems::identify
