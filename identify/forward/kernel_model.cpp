#include "identify/forward/kernel_model.hpp"

#include <Eigen/LU>

#include "models/common/units.hpp"
#include "models/mount_forces.hpp"

namespace wems::identify {
namespace {

template <class Matrix>
void append(std::vector<double>& constants, const Matrix& matrix) {
    constants.insert(constants.end(), matrix.data(), matrix.data() + matrix.size());
}

}  // namespace

KernelModel::KernelModel(const MountModel& model) : mode_count_(static_cast<int>(model.bracket.size())) {
    const MobileBody& body = model.body;
    Eigen::Vector3d load_arm = Eigen::Vector3d::Zero();
    if (model.load_point) {
        const bool mobile = model.load_point->part == Part::mobile;
        load_on_ = mobile ? LoadOn::mobile : LoadOn::fixed;
        load_arm = model.load_point->position;
        if (mobile) load_arm -= body.center_of_gravity;
    }
    constants_.push_back(1 / body.mass);
    append(constants_, body.inertia);
    append(constants_, Eigen::Matrix3d(body.inertia.inverse()));
    append(constants_, body.spin);
    append(constants_, model.gravity);
    append(constants_, load_arm);
    for (const BracketMode& mode : model.bracket) {
        const double omega = kTwoPi * mode.frequency;
        append(constants_, mode.translation);
        append(constants_, mode.rotation);
        append(constants_, mode.load_translation);
        append(constants_, mode.base_participation);
        constants_.push_back(2 * mode.damping_ratio * omega);
        constants_.push_back(omega * omega);
    }
    for (const Connection& connection : model.connections) {
        append(constants_, connection.position);
        append(constants_, Eigen::Vector3d(connection.position - body.center_of_gravity));
        for (const AxisLaw& law : connection.axis) {
            const AxisForce force(law);
            const AxisShape& shape = force.shape();
            const int axis = static_cast<int>(shapes_.size()), at = static_cast<int>(constants_.size());
            for (int i = 0; i < shape.stops; ++i) stops_.push_back({axis, at + shape.stopConstants(i)});
            for (int i = 0; i < shape.draggedCount(); ++i)
                bristles_.push_back({axis, at + shape.draggedConstants(i), internal_states_ + shape.branches + i});
            internal_states_ += shape.stateCount();
            shapes_.push_back(shape);
            constants_.insert(constants_.end(), force.constants().begin(), force.constants().end());
        }
    }
}

bool KernelModel::sameStructure(const KernelModel& other) const {
    return shapes_ == other.shapes_ && mode_count_ == other.mode_count_ && load_on_ == other.load_on_;
}

int KernelModel::stateSize(bool prescribed) const {
    return at_modes + (prescribed ? 0 : 2 * mode_count_) + internal_states_;
}

StepPlan KernelModel::makePlan(const Drive& drive, int first_sample, int sample_count) const {
    const TimeGrid& grid = drive.grid();
    StepPlan plan;
    plan.drive = drive.rows();
    plan.first_half = grid.halfStepOf(first_sample);
    plan.steps_per_sample = grid.steps_per_sample;
    plan.samples = sample_count;
    plan.state_size = stateSize(drive.prescribesMotion());
    plan.at_internal = plan.state_size - internal_states_;
    plan.stops = stops_.data();
    plan.stop_count = static_cast<int>(stops_.size());
    plan.bristles = bristles_.data();
    plan.bristle_count = static_cast<int>(bristles_.size());
    return plan;
}

}  // namespace wems::identify
