#include "plugin/run_estimate.hpp"

#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::plugin {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kTypicalDisplacement = 1e-3;  // m, for what stiffens with displacement

class Search {
public:
    explicit Search(double inverse_mass) : inverse_mass_(inverse_mass) {}

    void spring(const std::string& name, double value, double stiffness) {
        offer(name, value, std::sqrt(std::abs(stiffness) * inverse_mass_));
    }
    void damper(const std::string& name, double value, double damping) {
        offer(name, value, std::abs(damping) * inverse_mass_);
    }
    void offer(const std::string& name, double value, double rate) {
        if (rate > fastest.rate) fastest = {name, value, rate};
    }
    void setInverseMass(double inverse_mass) { inverse_mass_ = inverse_mass; }

    FastestLaw fastest;

private:
    double inverse_mass_;
};

void searchAxis(const AxisLaw& law, const std::string& place, Search& search) {
    search.spring(place + "stiffness", law.stiffness, law.stiffness);
    search.damper(place + "damping", law.damping, law.damping);
    search.spring(place + "quadratic", law.quadratic, 2 * std::abs(law.quadratic) * kTypicalDisplacement);
    search.spring(place + "cubic", law.cubic, 3 * law.cubic * kTypicalDisplacement * kTypicalDisplacement);
    const double steepest = ForceCurve(law.curve).largestStiffness();
    search.spring(place + "curve", steepest, steepest);
    if (law.relaxation) {
        search.offer(place + "time_constant", law.relaxation->time_constant, 1 / law.relaxation->time_constant);
        search.spring(place + "stiffness_ratio", law.relaxation->stiffness_ratio,
                      law.stiffness * law.relaxation->stiffness_ratio);
    }
    if (law.friction) {
        search.damper(place + "friction_force", law.friction->force,
                      law.friction->force / law.friction->transition_velocity);
        if (law.friction->presliding_stiffness)
            search.spring(place + "presliding_stiffness", *law.friction->presliding_stiffness,
                          *law.friction->presliding_stiffness);
    }
    if (law.hysteresis)
        search.spring(place + "hysteresis_force", law.hysteresis->force,
                      law.hysteresis->force / law.hysteresis->yield_displacement);
    for (const MaxwellBranch& branch : law.branches) {
        search.offer(place + "branches", branch.time_constant, 1 / branch.time_constant);
        search.spring(place + "branches", branch.stiffness, branch.stiffness);
    }
    for (const Relaxation& part : law.spectrum) {
        search.offer(place + "spectrum", part.time_constant, 1 / part.time_constant);
        search.spring(place + "spectrum", part.stiffness_ratio, part.stiffness_ratio * law.stiffness);
    }
    for (const Slider& slider : law.sliders)
        search.spring(place + "sliders", slider.force, slider.force / slider.yield_displacement);
    for (const Stop& stop : law.stops) {
        const std::string side = place + (stop.side == Side::positive ? "+." : "-.");
        search.spring(side + "stiffness", stop.stiffness, law.stiffness + stop.stiffness);
        search.damper(side + "dissipation", stop.dissipation, stop.stiffness * stop.dissipation * kTypicalDisplacement);
    }
}

}  // namespace

FastestLaw findFastestLaw(const MountModel& model) {
    const double smallest_inertia =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(model.body.inertia, Eigen::EigenvaluesOnly).eigenvalues()[0];
    double bracket = 0;  // 1/kg
    for (const BracketMode& mode : model.bracket) bracket += mode.translation.squaredNorm();
    Search search(1 / model.body.mass);
    for (const Connection& connection : model.connections) {
        const double arm = (connection.position - model.body.center_of_gravity).squaredNorm();
        search.setInverseMass(1 / model.body.mass + arm / smallest_inertia + bracket);
        for (std::size_t axis = 0; axis < connection.axis.size(); ++axis)
            searchAxis(connection.axis.at(axis), connection.name + "." + "xyz"[axis] + ".", search);
    }
    for (std::size_t j = 0; j < model.bracket.size(); ++j) {
        const BracketMode& mode = model.bracket[j];
        const std::string name = "bracket mode " + std::to_string(j + 1);
        search.offer(name, mode.frequency, kTwoPi * mode.frequency);
        search.offer(name + " damping_ratio", mode.damping_ratio, 2 * kTwoPi * mode.frequency * mode.damping_ratio);
    }
    return search.fastest;
}

RunEstimate estimateRun(double samples, double channels, std::size_t connections, double duration, double longest_step,
                        std::optional<double> base_step) {
    constexpr double bytes_a_number = 12;  // nine digits, point, comma, sign
    // Of a step with its sample, s: 0.15 ms with four connections, plugin/README.md.
    constexpr double alone = 3e-5, a_connection = 3e-5;
    constexpr double bytes_a_node = 56;  // of the base motion: time, displacement, velocity
    RunEstimate estimate;
    estimate.samples = samples;
    estimate.channels = channels;
    // A step ends at each sample.
    estimate.steps = std::max(duration / longest_step, samples);
    estimate.seconds = estimate.steps * (alone + a_connection * static_cast<double>(connections));
    estimate.file_bytes = samples * (channels + 1) * bytes_a_number;
    estimate.memory_bytes = base_step ? bytes_a_node * duration / *base_step : 0;
    return estimate;
}

bool isLong(const RunEstimate& estimate) {
    constexpr double large_file = 1e9;                   // bytes
    constexpr double many_steps = 1e7, long_time = 600;  // s
    return estimate.file_bytes > large_file || estimate.steps > many_steps || estimate.seconds > long_time;
}

std::string describe(const RunEstimate& estimate) {
    std::string text = formatNumber(estimate.samples) + " samples of " + formatNumber(estimate.channels) +
                       " channels, a file of about " + formatNumber(std::ceil(estimate.file_bytes / 1e6), 3) + " MB, ";
    if (estimate.memory_bytes > 0)
        text += formatNumber(std::ceil(estimate.memory_bytes / 1e6), 3) + " MB of memory for the base motion, ";
    return text + formatNumber(std::ceil(estimate.steps), 3) + " steps or more, about " +
           formatNumber(std::round(estimate.seconds), 2) + " s or more";
}

void checkDisk(const RunEstimate& estimate, const std::string& file) {
    if (file.empty()) return;
    std::error_code unknown;
    const auto folder = std::filesystem::absolute(file, unknown).parent_path();
    const auto room = std::filesystem::space(folder, unknown).available;
    if (unknown || std::filesystem::is_other(file, unknown) || estimate.file_bytes <= static_cast<double>(room)) return;
    throw InputError({file, 0, {}},
                     "would take about " + formatNumber(estimate.file_bytes / 1e9, 3) + " GB, its disk has room for " +
                         formatNumber(static_cast<double>(room) / 1e9, 3),
                     "a shorter run, a lower --sample-rate or fewer --channels");
}

void checkMemory(const RunEstimate& estimate) {
    const double present =
        static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
    constexpr double share = 0.8;  // that one program may take
    if (!(estimate.memory_bytes > share * present)) return;
    throw InputError({{}, 0, "--duration"},
                     "the base motion of this run takes " + formatNumber(estimate.memory_bytes / 1e9, 3) +
                         " GB of memory, this computer has " + formatNumber(present / 1e9, 3),
                     "a shorter run, or a force in place of the base acceleration");
}

}  // namespace wems::plugin
