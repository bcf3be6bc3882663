// One simulation of a mount without bracket under a logarithmic sweep of its base, by the forward model or by Simbody
// as `simulate` runs it, for scripts/peers:
//
//     peer_run PLAN.json
//
// The plan: model (file), sweep [Hz, Hz], octaves_per_minute, base_acceleration [m/s^2 in x, y, z], duration (s, less
// than the sweep's), sample_rate (Hz), output (file), repetitions, program. Program "forward" takes steps_per_sample,
// "simbody" takes accuracy and longest_step (s). Writes the relative displacements at all samples (m, rows of 3 x
// connections doubles) to `output`, and one line of JSON to standard output: computing time of the process in each
// repetition (s), from the model in memory to the displacements, and the number of evaluations of the equations of
// motion.
#include <Eigen/Core>
#include <cmath>
#include <ctime>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "identify/forward/forward_model.hpp"
#include "models/excitation.hpp"
#include "plugin/simulation.hpp"

namespace {

using namespace wems;

struct Plan {
    MountModel model;
    std::shared_ptr<const Signal> sweep;
    Eigen::Vector3d base_acceleration = Eigen::Vector3d::Zero();
    double interval = 0;  // s between samples
    int samples = 0;
    nlohmann::json options;  // of the program
};

struct Run {
    Eigen::MatrixXd q;  // m, row 3 i + axis of connection i, a column for each sample
    long evaluations = 0;
};

Plan readPlan(const char* file) {
    std::ifstream stream(file);
    Plan plan;
    plan.options = nlohmann::json::parse(stream);
    const nlohmann::json& from = plan.options;
    plan.model = readMountModel(from.at("model").get<std::string>());
    if (!plan.model.bracket.empty()) throw std::invalid_argument("the model has a bracket");
    plan.sweep = makeLogarithmicSweep(from.at("sweep").at(0).get<double>(), from.at("sweep").at(1).get<double>(),
                                      from.at("octaves_per_minute").get<double>());
    for (int axis = 0; axis < 3; ++axis)
        plan.base_acceleration[axis] = from.at("base_acceleration").at(axis).get<double>();
    const auto rate = from.at("sample_rate").get<double>();
    plan.interval = 1 / rate;
    plan.samples = static_cast<int>(std::lround(from.at("duration").get<double>() * rate)) + 1;
    return plan;
}

Run runForward(const Plan& plan) {
    identify::TimeGrid grid;
    grid.interval = plan.interval;
    grid.samples = plan.samples;
    grid.steps_per_sample = plan.options.at("steps_per_sample").get<int>();
    // The sweep at all times that the integrator asks for: nothing is interpolated, as in the other programs.
    std::vector<double> time;
    Eigen::Matrix3Xd base(3, grid.halfSteps());
    for (int half = 0; half < grid.halfSteps(); ++half) {
        time.push_back(grid.halfStepTime(half));
        base.col(half) = plan.base_acceleration * plan.sweep->value(time.back());
    }
    const auto drive = identify::Drive::makeLoad(time, {}, base, grid);
    const identify::Simulation simulation = identify::ForwardModel(plan.model).simulate(drive);
    return {simulation.q, simulation.evaluations};
}

Run runSimbody(const Plan& plan) {
    plugin::SimulationSettings settings;
    for (int k = 0; k < plan.samples; ++k) settings.times.push_back(k * plan.interval);
    settings.channels = {true, false, false};
    settings.accuracy = plan.options.at("accuracy").get<double>();
    settings.longest_step = plan.options.at("longest_step").get<double>();
    const auto drive = plugin::makeSignalDrive(plan.sweep, Eigen::Vector3d::Zero(), plan.base_acceleration, true);
    const plugin::SimulationResult result = plugin::simulate(plan.model, drive, settings);
    Run run;
    run.evaluations = result.cost.realizations;
    run.q = Eigen::MatrixXd::Zero(3 * plan.model.connections.size(), plan.samples);
    for (const Channel& channel : result.recording.channels) {
        const auto name = parseChannelName(channel.name);
        if (!name || (name->part != Part::mobile && name->part != Part::fixed)) continue;
        Eigen::Index row = name->axis;
        for (const Connection& connection : plan.model.connections) {
            if (connection.name == name->connection) break;
            row += 3;
        }
        const Eigen::Map<const Eigen::RowVectorXd> values(channel.values.data(), plan.samples);
        run.q.row(row) += (name->part == Part::mobile ? 1.0 : -1.0) * values;
    }
    return run;
}

double cpuTime() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        if (argc != 2) throw std::invalid_argument("usage: peer_run PLAN.json");
        const Plan plan = readPlan(argv[1]);
        const bool forward = plan.options.at("program") == "forward";
        auto times = nlohmann::json::array();
        Run run;
        for (int repetition = 0; repetition < plan.options.at("repetitions").get<int>(); ++repetition) {
            const double start = cpuTime();
            run = forward ? runForward(plan) : runSimbody(plan);
            times.push_back(cpuTime() - start);
        }
        std::ofstream output(plan.options.at("output").get<std::string>(), std::ios::binary);
        output.write(reinterpret_cast<const char*>(run.q.data()),
                     static_cast<std::streamsize>(sizeof(double)) * run.q.size());
        if (!output.flush()) throw std::runtime_error("cannot write the output");
        std::cout << nlohmann::json{{"cpu_time", times}, {"evaluations", run.evaluations}} << "\n";
        return 0;
    } catch (const std::exception& error) {
        std::cerr << "peer_run: " << error.what() << "\n";
    }
    return 2;
}
