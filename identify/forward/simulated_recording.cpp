#include "identify/forward/simulated_recording.hpp"

#include <cmath>
#include <random>
#include <string>
#include <utility>

#include "identify/forward/forward_model.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {

namespace {

constexpr unsigned kNoiseSeed = 1;

/// Appends one channel for each row, with noise.
class ChannelWriter {
public:
    ChannelWriter(Recording& recording, const SimulatedNoise& noise) : recording_(recording), noise_(noise) {}

    void add(const std::string& name, const Eigen::VectorXd& values, double noise) {
        Channel channel;
        channel.name = name;
        channel.values.assign(values.begin(), values.end());
        const double gain = 1 + noise_.gain_scatter * normal_(random_);
        for (double& value : channel.values) value *= gain;
        if (noise > 0 && std::isfinite(noise))
            for (double& value : channel.values) value += noise_.sign * noise * normal_(random_);
        recording_.channels.push_back(std::move(channel));
    }

    void addPart(const std::string& side, const PartMotion& part, const MountModel& model,
                 const Eigen::MatrixXd& displacement, const Eigen::MatrixXd& acceleration) {
        for (std::size_t i = 0; i < model.connections.size(); ++i)
            for (int axis = 0; axis < 3; ++axis) {
                const auto row = static_cast<Eigen::Index>(3 * i) + axis;
                const std::string at = side + "." + model.connections[i].name + ".";
                if (part.displacement_measured) add(at + kAxes[axis], displacement.row(row), part.displacement_noise);
                if (part.acceleration_measured)
                    add(at + "a" + kAxes[axis], acceleration.row(row), part.acceleration_noise);
            }
    }

    /// What drives the run, as it was recorded.
    void addDrive(const std::string& name, const Eigen::Matrix3Xd& rows) {
        for (int axis = 0; axis < 3 && rows.cols() > 0; ++axis) add(name + kAxes[axis], rows.row(axis), 0);
    }

private:
    Recording& recording_;
    SimulatedNoise noise_;
    std::mt19937 random_{kNoiseSeed};
    std::normal_distribution<double> normal_;
};

}  // namespace

Recording simulateRecording(const RunMotion& run, const MountModel& model, const SimulatedNoise& noise) {
    const ForwardModel forward(model);
    const auto drive = Drive::make(run, model, makeGrid(run, model));
    const MarkerMotion markers = forward.calcMarkers(forward.simulate(drive, Keep::states), drive);
    Recording recording;
    recording.file = run.file;
    recording.time = run.time;
    ChannelWriter writer(recording, noise);
    writer.addPart("mobile", run.mobile, model, markers.mobile_displacement, markers.mobile_acceleration);
    writer.addPart("fixed", run.fixed, model, markers.fixed_displacement, markers.fixed_acceleration);
    writer.addDrive("load.f", run.load);
    writer.addDrive("base.a", run.base);
    return recording;
}

}  // namespace wems::identify
