#include "tests/diagnose/hidden_device.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "identify/forward/forward_model.hpp"
#include "models/common/units.hpp"
#include "models/excitation.hpp"

namespace wems::identify::testing {
namespace {

double draw(std::mt19937_64& random, double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(random);
}

BracketMode makeMode(std::mt19937_64& random, double frequency, double mass, int translation, int rotation,
                     double lever) {
    BracketMode mode;
    mode.frequency = frequency * draw(random, 0.95, 1.05);
    mode.damping_ratio = draw(random, 0.008, 0.02);
    const double scale = 1 / std::sqrt(mass);
    if (translation >= 0) mode.translation[translation] = scale;
    if (rotation >= 0) mode.rotation[rotation] = lever * scale;
    mode.load_translation = mode.translation + mode.rotation.cross(Eigen::Vector3d(0.01, 0.02, 0.0));
    return mode;
}

}  // namespace

MountModel makeRandomDevice(std::mt19937_64& random) {
    MountModel model;
    model.name = "random device";
    const int count = std::uniform_int_distribution<int>(3, 6)(random);
    const double mass = draw(random, 5, 9);
    model.body.mass = mass;
    model.body.center_of_gravity = {0, 0, draw(random, 0.0, 0.12)};
    model.body.inertia =
        Eigen::Vector3d(draw(random, 0.05, 0.1), draw(random, 0.05, 0.1), draw(random, 0.03, 0.05)).asDiagonal();
    const double axial = draw(random, 2.5e5, 4e5) / count, lateral = 0.3 * axial;
    const double clearance = draw(random, 1.0e-3, 1.6e-3);
    for (int i = 0; i < count; ++i) {
        Connection connection;
        connection.name = std::to_string(i + 1);
        const double angle = kTwoPi * (i + draw(random, -0.15, 0.15)) / count, radius = draw(random, 0.08, 0.12);
        connection.position = {radius * std::cos(angle), radius * std::sin(angle), draw(random, -0.02, 0.02)};
        for (std::size_t a = 0; a < 3; ++a) {
            auto& law = connection.axis[a];
            law.stiffness = (a == 2 ? axial : lateral) * draw(random, 0.85, 1.15);
            law.damping = 4e-4 * law.stiffness;
        }
        connection.axis[2].stops = {{Side::positive, clearance, 8 * axial, 0},
                                    {Side::negative, clearance, 8 * axial, 0}};
        const std::size_t outward = std::abs(connection.position.x()) > std::abs(connection.position.y()) ? 0 : 1;
        const Eigen::Index component = outward;
        connection.axis[outward].stops = {
            {connection.position[component] > 0 ? Side::positive : Side::negative, 1.4 * clearance, 8 * lateral, 0}};
        model.connections.push_back(connection);
    }
    model.bracket = {makeMode(random, 64, 14, 2, 0, 6),    makeMode(random, 85, 14, 0, 1, -5),
                     makeMode(random, 110, 14, 1, -1, 0),  makeMode(random, 34, 120, 0, 1, 0.3),
                     makeMode(random, 37, 120, 1, 0, 0.3), makeMode(random, 45, 140, 2, 0, 0.2)};
    model.bracket_file = "bracket.csv";
    return model;
}

Recording recordRun(const MountModel& truth, const RunPlan& plan, std::mt19937_64& random) {
    const double octaves_per_minute = 60 * std::log2(10.0) / plan.duration;
    const auto sweep =
        plan.upward ? makeLogarithmicSweep(5, 50, octaves_per_minute) : makeLogarithmicSweep(50, 5, octaves_per_minute);
    const auto samples = static_cast<int>(plan.duration * plan.rate);
    Recording recording;
    recording.file = "random.csv";
    Eigen::Matrix3Xd load(3, samples);
    for (int k = 0; k < samples; ++k) {
        recording.time.push_back(k / plan.rate);
        load.col(k) = plan.force * sweep->value(recording.time.back());
    }
    const ForwardModel forward(truth);
    TimeGrid grid{0, 1 / plan.rate, samples, 4};
    const auto drive = Drive::makeLoad(recording.time, load, {}, grid);
    const auto markers = forward.calcMarkers(forward.simulate(drive, Keep::states), drive);
    std::normal_distribution<double> noise(0, plan.noise);
    const auto add = [&](const std::string& name, const Eigen::RowVectorXd& values, bool noisy) {
        Channel channel;
        channel.name = name;
        channel.unit = noisy ? "m" : "N";
        for (Eigen::Index k = 0; k < values.size(); ++k)
            channel.values.push_back(values[k] + (noisy ? noise(random) : 0.0));
        recording.channels.push_back(channel);
    };
    for (const bool mobile : {true, false})
        for (std::size_t i = 0; i < truth.connections.size(); ++i)
            for (int a = 0; a < 3; ++a)
                add(std::string(mobile ? "mobile." : "fixed.") + truth.connections[i].name + "." + "xyz"[a],
                    (mobile ? markers.mobile_displacement : markers.fixed_displacement).row(3 * i + a), true);
    for (int a = 0; a < 3; ++a) add(std::string("load.f") + "xyz"[a], load.row(a), false);
    return recording;
}

}  // namespace wems::identify::testing
