#include "tests/inspect/planted_faults.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "models/bryant.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "tests/hidden/device_motion.hpp"
#include "tests/hidden/random_case.hpp"

namespace wems::test {
namespace {

using hidden::drawCoin;
using hidden::drawInteger;
using hidden::drawLog;
using hidden::drawUniform;
using hidden::Random;
using Kind = identify::MeasurementFault::Kind;

constexpr double kRate = 1000;                                          // Hz
constexpr double kDisplacementNoise = 2e-6, kAccelerationNoise = 0.02;  // m, m/s^2
constexpr double kStep = 0.25e-3;                                       // s, of the truth

Eigen::Vector3d drawVector(Random& random, double size) {
    return {drawUniform(random, -size, size), drawUniform(random, -size, size), drawUniform(random, -size, size)};
}

/// Three places that are not nearly on one line.
Eigen::Matrix3Xd drawPlaces(Random& random) {
    for (;;) {
        Eigen::Matrix3Xd places(3, 3);
        for (auto column : places.colwise()) column = drawVector(random, 0.15) + Eigen::Vector3d(0, 0, 0.05);
        const Eigen::Vector3d a = places.col(1) - places.col(0), b = places.col(2) - places.col(0),
                              c = places.col(2) - places.col(1);
        const double longest = std::max({a.norm(), b.norm(), c.norm()});
        if (a.cross(b).norm() > 0.3 * longest * longest && longest > 0.1) return places;
    }
}

double rmsOf(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Cubic through four neighbours at time t − delay − drift (t − middle).
std::vector<double> shift(const std::vector<double>& values, double delay, double drift) {
    std::vector<double> result(values.size());
    const double middle = 0.5 * static_cast<double>(values.size());
    for (std::size_t k = 0; k < values.size(); ++k) {
        const double t = static_cast<double>(k);
        const double at =
            std::clamp(t - delay * kRate - drift * (t - middle), 0.0, static_cast<double>(values.size() - 1));
        const auto first =
            static_cast<std::size_t>(std::clamp(std::floor(at) - 1, 0.0, static_cast<double>(values.size() - 4)));
        const double u = at - static_cast<double>(first + 1);
        const double* v = values.data() + first;
        result[k] = -v[0] * u * (u - 1) * (u - 2) / 6 + v[1] * (u + 1) * (u - 1) * (u - 2) / 2 -
                    v[2] * (u + 1) * u * (u - 2) / 2 + v[3] * (u + 1) * u * (u - 1) / 6;
    }
    return result;
}

void addTriaxes(const std::vector<std::string>& names, const std::string& prefix, const Eigen::MatrixXd& truth,
                double noise, Random& random, Recording& recording) {
    std::normal_distribution<double> normal(0, noise);
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Eigen::Matrix3d R = rotationFromVector(drawVector(random, 0.5 * kPi / 180));
        for (Eigen::Index a = 0; a < 3; ++a) {
            const Eigen::RowVectorXd row = R.row(a) * truth.middleRows(3 * i, 3);
            Channel channel{names[i] + "." + prefix + kAxes[a], prefix.empty() ? "m" : "m/s^2", {}, 0};
            const double gain = 1 + drawUniform(random, -0.005, 0.005);
            for (const double value : row) channel.values.push_back(gain * value + normal(random));
            recording.channels.push_back(std::move(channel));
        }
    }
}

/// Channels that other channels can check: all but a base of its own.
std::vector<std::string> listChecked(const Recording& recording) {
    std::vector<std::string> names;
    const bool rigid_table = !recording.connections(Part::fixed).empty();
    for (const Channel& channel : recording.channels)
        if (channel.name.rfind("load", 0) != 0 && (channel.name.rfind("base", 0) != 0 || rigid_table))
            names.push_back(channel.name);
    return names;
}

/// Channels of the same sensor and kind.
std::vector<std::string> listSensor(const std::vector<std::string>& names, const std::string& one) {
    const std::size_t length = one.size() - 1;
    std::vector<std::string> members;
    for (const std::string& name : names)
        if (name.size() == one.size() && name.compare(0, length, one, 0, length) == 0) members.push_back(name);
    return members;
}

PlantedFault drawFault(const std::vector<std::string>& names, bool drift_allowed, Random& random) {
    static constexpr std::array<double, 6> units{9.80665, 1 / 9.80665, 1e3, 1e-3, 25.4, 1 / 25.4};
    const std::string one = names[drawInteger(random, 0, static_cast<int>(names.size()) - 1)];
    const bool acceleration = one[one.size() - 2] == 'a';
    const bool whole = drawCoin(random, 0.3);
    const std::vector<std::string> sensor = listSensor(names, one);
    PlantedFault fault;
    switch (drawInteger(random, 0, drift_allowed ? 4 : 3)) {
        case 0:
            fault.kind = Kind::unit;
            fault.channels = whole ? sensor : std::vector<std::string>{one};
            fault.size = units[static_cast<std::size_t>(drawInteger(random, acceleration ? 0 : 2, 5))];
            break;
        case 1:
            fault.kind = Kind::sign;
            fault.channels = {one};
            fault.size = -1;
            break;
        case 2: {
            fault.kind = Kind::exchanged;
            std::vector<std::string> others;
            for (const std::string& name : names) {
                const bool same_sensor = std::count(sensor.begin(), sensor.end(), name) > 0;
                const bool same_axis = name.back() == one.back() && (name[name.size() - 2] == 'a') == acceleration &&
                                       name.front() == one.front();
                if (name != one && (same_sensor || same_axis)) others.push_back(name);
            }
            fault.channels = {one, others[drawInteger(random, 0, static_cast<int>(others.size()) - 1)]};
            break;
        }
        case 3:
            fault.kind = Kind::delay;
            fault.channels = whole ? sensor : std::vector<std::string>{one};
            fault.size = drawUniform(random, 2e-3, 10e-3);
            break;
        default:
            fault.kind = Kind::clock_drift;
            fault.channels = sensor;
            fault.size = hidden::drawSign(random) * drawLog(random, 2e-4, 1e-3);
    }
    return fault;
}

void apply(const PlantedFault& fault, Recording& recording) {
    std::vector<std::vector<double>*> values;
    for (const std::string& name : fault.channels)
        values.push_back(
            &std::find_if(recording.channels.begin(), recording.channels.end(), [&](const Channel& channel) {
                 return channel.name == name;
             })->values);
    if (fault.kind == Kind::exchanged) std::swap(*values[0], *values[1]);
    for (auto* each : values) {
        if (fault.kind == Kind::delay) *each = shift(*each, fault.size, 0);
        if (fault.kind == Kind::clock_drift) *each = shift(*each, 0, fault.size);
        if (fault.kind == Kind::unit || fault.kind == Kind::sign)
            for (double& value : *each) value *= fault.size;
    }
}

bool isVisible(const PlantedFault& fault, const Recording& before) {
    Recording after = before;
    apply(fault, after);
    std::vector<double> typical;
    const bool acceleration = fault.channels[0][fault.channels[0].size() - 2] == 'a';
    for (const Channel& channel : before.channels)
        if ((channel.name[channel.name.size() - 2] == 'a') == acceleration) typical.push_back(rmsOf(channel.values));
    std::sort(typical.begin(), typical.end());
    for (const std::string& name : fault.channels) {
        std::vector<double> change = after.find(name)->values;
        const std::vector<double>& clean = before.find(name)->values;
        for (std::size_t k = 0; k < change.size(); ++k) change[k] -= clean[k];
        const double size = rmsOf(change);
        if (size < 0.2 * rmsOf(clean) || size < 0.05 * typical[typical.size() / 2]) return false;
    }
    return true;
}

/// Channels that a fault of the result speaks of.
std::set<std::string> listBlamed(const identify::MeasurementFault& fault, const Recording& recording) {
    std::set<std::string> names;
    for (const std::string& text : {fault.channel, fault.exchanged_with}) {
        const std::size_t dot = text.rfind('.');
        const bool all = text.find('|') != std::string::npos, kind = text.find(".*.") != std::string::npos;
        for (const Channel& channel : recording.channels) {
            const std::size_t own = channel.name.rfind('.');
            const bool same_kind = all && (channel.name[own + 1] == 'a') == (text[dot + 1] == 'a') &&
                                   channel.name.size() - own == (text[dot + 1] == 'a' ? 3U : 2U);
            const bool same_place = kind ? channel.name.compare(0, text.find('.'), text, 0, text.find('.')) == 0
                                         : channel.name.substr(0, own) == text.substr(0, dot);
            if (channel.name == text || (same_kind && same_place)) names.insert(channel.name);
        }
    }
    return names;
}

}  // namespace

FaultyRun drawFaultyRun(int count, Random& random) {
    FaultyRun run;
    run.model = hidden::drawDevice(random);
    const bool shaken = drawCoin(random, 0.5), displacements = drawCoin(random, 0.5),
               fixed = !shaken || drawCoin(random, 0.5);
    if (shaken) run.model.bracket.clear();
    hidden::SetUp set_up;
    set_up.kind = shaken ? hidden::SetUp::Kind::base : hidden::SetUp::Kind::bracket;
    hidden::RunPlan plan;
    plan.excitation = static_cast<hidden::Excitation>(drawInteger(random, 0, 2));
    plan.upward = drawCoin(random, 0.5);
    plan.direction = (drawVector(random, 1) + Eigen::Vector3d(0.2, 0.2, 0.2)).normalized();
    plan.level = shaken ? drawLog(random, 2, 15) : drawLog(random, 30, 200);
    hidden::tabulate(plan, shaken, random());
    run.set_up = std::string(shaken ? "base" : "force") + ", " + hidden::formatExcitation(plan) +
                 (displacements ? ", both" : ", accelerations") + (fixed ? "" : ", table alone");
    const auto samples = static_cast<Eigen::Index>(plan.duration * kRate);
    const Eigen::Matrix3Xd mobile = drawPlaces(random), bracket = drawPlaces(random);
    const auto moved = [&](Eigen::Matrix3Xd places) {
        for (auto column : places.colwise()) column += drawVector(random, 5e-4);
        return places;
    };
    Eigen::Matrix3Xd ends(3, run.model.connections.size());
    std::vector<std::string> mobile_ends, fixed_ends;
    for (std::size_t i = 0; i < run.model.connections.size(); ++i) {
        ends.col(i) = run.model.connections[i].position;
        mobile_ends.push_back("mobile." + run.model.connections[i].name);
        fixed_ends.push_back("fixed." + run.model.connections[i].name);
    }
    const hidden::Points points{moved(ends), moved(mobile), moved(ends), moved(bracket)};
    const hidden::Drive drive = hidden::makeDrive(plan);
    hidden::DeviceMotion motion =
        hidden::simulateDevice({run.model, {}, set_up}, drive, kRate, samples, kStep, &points);
    Eigen::Matrix3Xd applied = hidden::resample(drive.values, hidden::kTableRate, kRate, samples);
    if (shaken) {
        const Eigen::Matrix3Xd travel =
            plan.direction * plan.level * hidden::resample(plan.travel.transpose(), hidden::kTableRate, kRate, samples);
        const auto carry = [](Eigen::MatrixXd& rows, const Eigen::Matrix3Xd& table) {
            for (Eigen::Index i = 0; i < rows.rows(); i += 3) rows.middleRows(i, 3) += table;
        };
        for (auto* rows : {&motion.mobile_displacement, &motion.fixed_displacement}) carry(*rows, travel);
        for (auto* rows : {&motion.mobile_acceleration, &motion.fixed_acceleration}) carry(*rows, applied);
    }
    run.recording.file = "run.csv";
    for (Eigen::Index k = 0; k < samples; ++k) run.recording.time.push_back(static_cast<double>(k) / kRate);
    for (Eigen::Index i = 0; i < 3; ++i) {
        const std::string name = "A" + std::to_string(i + 1);
        run.model.places.push_back({name, Part::mobile, true, mobile.col(i), Eigen::Vector3d::Zero(), 0, {}});
        if (fixed)
            run.model.places.push_back({name, Part::fixed, true, bracket.col(i), Eigen::Vector3d::Zero(), 0, {}});
    }
    addTriaxes({"mobile.A1", "mobile.A2", "mobile.A3"}, "a", motion.mobile_acceleration, kAccelerationNoise, random,
               run.recording);
    if (displacements)
        addTriaxes(mobile_ends, "", motion.mobile_displacement, kDisplacementNoise, random, run.recording);
    if (fixed) {
        addTriaxes({"fixed.A1", "fixed.A2", "fixed.A3"}, "a", motion.fixed_acceleration, kAccelerationNoise, random,
                   run.recording);
        if (displacements)
            addTriaxes(fixed_ends, "", motion.fixed_displacement, kDisplacementNoise, random, run.recording);
    }
    if (shaken) addTriaxes({"base"}, "a", applied, kAccelerationNoise, random, run.recording);
    const Recording clean = run.recording;
    std::vector<std::string> names = listChecked(clean);
    // Few channels may leave no room for another fault.
    constexpr int kMostDraws = 1000;
    for (int draw = 0; draw < kMostDraws && static_cast<int>(run.planted.size()) < count; ++draw) {
        const bool drifts = std::any_of(run.planted.begin(), run.planted.end(),
                                        [](const PlantedFault& fault) { return fault.kind == Kind::clock_drift; });
        const PlantedFault fault = drawFault(listChecked(clean), !drifts, random);
        const bool free = std::all_of(fault.channels.begin(), fault.channels.end(), [&](const std::string& name) {
            return std::count(names.begin(), names.end(), name) > 0;
        });
        if (!free || !isVisible(fault, clean)) continue;
        apply(fault, run.recording);
        for (const std::string& name : fault.channels) names.erase(std::find(names.begin(), names.end(), name));
        run.planted.push_back(fault);
    }
    return run;
}

FaultScore scoreFaults(const FaultyRun& run, const std::vector<identify::PartConsistency>& found) {
    FaultScore score;
    std::set<std::string> guilty, blamed;
    for (const PlantedFault& fault : run.planted) {
        std::set<std::string> named;  // with this kind and size
        for (const auto& part : found) {
            for (const auto& suspect : part.faults) {
                if (suspect.kind != fault.kind) continue;
                const std::set<std::string> channels = listBlamed(suspect, run.recording);
                const std::set<std::string> own(fault.channels.begin(), fault.channels.end());
                if (fault.kind == Kind::exchanged && channels != own) continue;
                if (fault.kind == Kind::unit && std::abs(suspect.factor / fault.size - 1) > 0.1) continue;
                named.insert(channels.begin(), channels.end());
            }
        }
        const bool all = std::all_of(fault.channels.begin(), fault.channels.end(),
                                     [&](const std::string& name) { return named.count(name) > 0; });
        ++score.planted;
        score.named += all ? 1 : 0;
        guilty.insert(fault.channels.begin(), fault.channels.end());
        if (all) continue;
        score.missed += std::string("missed ") + identify::kindName(fault.kind) + " " + std::to_string(fault.size);
        for (const std::string& name : fault.channels) score.missed += " " + name;
        score.missed += "\n";
    }
    for (const auto& part : found)
        for (const auto& suspect : part.faults)
            for (const std::string& name : listBlamed(suspect, run.recording)) blamed.insert(name);
    for (const std::string& name : listChecked(run.recording)) {
        if (guilty.count(name) > 0) continue;
        ++score.innocent;
        score.blamed += static_cast<int>(blamed.count(name));
    }
    return score;
}

}  // namespace wems::test
