/// @file
/// A model laid out for the forward model's equations (identify/forward/mount_kernel.hpp).
#pragma once

#include <vector>

#include "identify/forward/drive.hpp"
#include "identify/forward/stepper.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {

/// Numbers and structure of one model. Models of equal structure can be simulated together.
class KernelModel {
public:
    explicit KernelModel(const MountModel& model);

    const std::vector<double>& constants() const { return constants_; }
    bool sameStructure(const KernelModel& other) const;
    int stateSize(bool prescribed) const;

    /// The equations with these constants (the own ones, or those of several models interleaved), for fixed parts that
    /// move by themselves or as a drive prescribes.
    template <class T>
    MountKernel<T> makeKernel(const T* constants, bool prescribed) const {
        return {constants,
                shapes_.data(),
                static_cast<int>(shapes_.size()) / 3,
                prescribed ? 0 : mode_count_,
                body_constants + mode_constants * mode_count_,
                prescribed,
                load_on_};
    }
    /// Steps of a drive from a sample on; refers to this object and the drive.
    StepPlan makePlan(const Drive& drive, int first_sample, int sample_count) const;

private:
    std::vector<double> constants_;
    std::vector<AxisShape> shapes_;
    std::vector<StopPlace> stops_;
    std::vector<BristlePlace> bristles_;  // states counted from the first internal one
    int mode_count_ = 0, internal_states_ = 0;
    LoadOn load_on_ = LoadOn::bracket;
};

}  // namespace wems::identify
