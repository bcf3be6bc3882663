#include "tests/hidden/random_case.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace wems::hidden {
namespace {

constexpr double kSmallest = 0.05, kLargest = 0.5;  // change of the motion
constexpr double kChaotic = 30;                     // amplification
constexpr int kAttempts = 400;
constexpr double kFast = 1000;  // Hz, samples of what is simulated for drawing alone

double calcChange(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).norm() / b.norm();
}

/// Largest displacement over clearance.
double calcReach(const HiddenCase& hidden, const MountModel& device, std::size_t run) {
    const Eigen::MatrixXd q = simulateRelative(hidden, device, run);
    double reach = 0;
    for (std::size_t i = 0; i < device.connections.size(); ++i)
        for (std::size_t a = 0; a < 3; ++a)
            for (const auto& stop : device.connections[i].axis[a].stops)
                reach = std::max(
                    reach, (stop.side == Side::positive ? 1.0 : -1.0) / stop.clearance * q.row(3 * i + a).maxCoeff());
    return reach;
}

Excitation drawExcitation(Random& random) {
    const double u = drawUniform(random, 0, 1);
    return u < 0.67 ? Excitation::logarithmic : u < 0.84 ? Excitation::linear : Excitation::random;
}

/// All but the levels.
void drawRuns(HiddenCase& hidden, Excitation excitation, Random& random) {
    const double duration = drawUniform(random, 8, 15);
    for (std::size_t r = 0; r < 3; ++r) {
        auto& plan = hidden.runs[r];
        plan.excitation = excitation;
        plan.duration = duration;
        plan.direction = {drawUniform(random, -0.6, 0.6), drawUniform(random, -0.6, 0.6), drawUniform(random, 0.2, 1)};
        if (r == 2) plan.direction = {drawUniform(random, -1, 1), drawUniform(random, -1, 1), 0.5};
        if (hidden.set_up.oneAxis()) plan.direction = Eigen::Vector3d::UnitZ();
        plan.direction.normalize();
        plan.upward = r != 1 || drawInteger(random, 0, 1) == 0;
        tabulate(plan, hidden.set_up.baseDriven(), random());
    }
}

/// The first run leaves the stops alone, the second reaches them, the third may.
void drawLevel(HiddenCase& hidden, const MountModel& device, std::size_t run, Random& random) {
    constexpr double reaches[3][2] = {{0.4, 0.9}, {1.15, 1.5}, {0.8, 1.4}};
    const double reach = drawUniform(random, reaches[run][0], reaches[run][1]);
    double& level = hidden.runs[run].level;
    level = hidden.set_up.baseDriven() ? 10 : 60;
    for (int i = 0; i < 4; ++i) {
        const double factor = std::clamp(reach / calcReach(hidden, device, run), 0.2, 5.0);
        level *= factor;
        if (std::abs(factor - 1) < 0.1) break;
    }
}

SetUp drawSetUp(const std::string& kind, Random& random) {
    SetUp set_up;
    const double u = kind == "axis" ? 0 : kind == "base" ? 0.3 : kind == "bracket" ? 1 : drawUniform(random, 0, 1);
    set_up.kind = u < 0.1 ? SetUp::Kind::axis : u < 0.48 ? SetUp::Kind::base : SetUp::Kind::bracket;
    if (set_up.kind == SetUp::Kind::bracket) return set_up;
    set_up.shaken = drawCoin(random, 0.6);
    const int recorded = drawInteger(random, 0, set_up.oneAxis() ? 1 : 2);
    set_up.records_base = recorded != 1;
    set_up.records_fixed = recorded != 0;
    if (set_up.oneAxis() && !set_up.shaken) set_up.records_base = set_up.records_fixed = false;
    return set_up;
}

/// Noise of small errors is what a bench has; without them it is the only thing between model and truth.
void drawSensors(HiddenCase& hidden, const CaseOptions& options, Random& random) {
    const Sensors sensors = options.sensors;
    const int kind = sensors == Sensors::any ? drawInteger(random, 1, 3) : static_cast<int>(sensors);
    const bool exact = options.level == 0;
    const double displacement = drawLog(random, 1e-6, exact ? 1e-5 : 4e-6);
    const double acceleration = drawLog(random, exact ? 0.01 : 0.005, exact ? 0.1 : 0.03);
    if (kind != static_cast<int>(Sensors::accelerations)) hidden.displacement_noise = displacement;
    if (kind != static_cast<int>(Sensors::displacements)) hidden.acceleration_noise = acceleration;
}

bool isSensor(const Effect& effect) {
    return effect.cause.rfind("sensor_", 0) == 0;
}

/// `mobile.1.z` is an accelerometer where no displacement is recorded.
void nameAccelerations(HiddenCase& hidden) {
    if (hidden.displacement_noise > 0) return;
    const auto rename = [](std::string& name) {
        const auto dot = name.find('.', name.find('.') + 1);
        if (dot != std::string::npos && dot + 1 < name.size() && (dot + 2 == name.size() || name[dot + 2] == '.') &&
            name[dot + 1] >= 'x')
            name.insert(dot + 1, "a");
    };
    for (auto& effect : hidden.effects) {
        if (!isSensor(effect)) continue;
        for (auto& place : effect.where) rename(place);
        for (auto& name : effect.names) rename(name);
    }
    for (auto& sensor : hidden.truth.sensors) rename(sensor.channel);
}

/// A device without and with an effect.
struct Pair {
    MountModel base, truth;
    bool moves = true;  // faults of sensors change no motion: they count as they are
};

/// Change by an effect of the runs from `first` to `last`, relative to the truth.
double calcChange(const HiddenCase& hidden, const Pair& pair, std::size_t first, std::size_t last) {
    double difference = 0, signal = 0;
    for (std::size_t r = first; r <= last; ++r) {
        const Eigen::MatrixXd truth = simulateRelative(hidden, pair.truth, r);
        difference += (simulateRelative(hidden, pair.base, r) - truth).squaredNorm();
        signal += truth.squaredNorm();
    }
    return std::sqrt(difference / signal);
}

bool isVisible(const HiddenCase& hidden, const std::vector<Pair>& alone, std::size_t first, std::size_t last) {
    return std::all_of(alone.begin(), alone.end(), [&](const Pair& pair) {
        const double change = pair.moves ? calcChange(hidden, pair, first, last) : kSmallest;
        return change >= kSmallest && change < kLargest;
    });
}

bool isPredictable(HiddenCase& hidden) {
    MountModel heavier = hidden.truth;
    heavier.body.mass *= 1 + 1e-5;
    for (const std::size_t r : {std::size_t{1}, std::size_t{2}, std::size_t{0}}) {
        hidden.amplification[r] =
            1e5 * calcChange(simulateRelative(hidden, heavier, r), simulateRelative(hidden, hidden.truth, r));
        if (!(hidden.amplification[r] < kChaotic)) return false;
    }
    return true;
}

/// Scales an outside effect until it changes the motion as wanted. False if it does not.
bool scaleOutside(HiddenCase& hidden, Random& random) {
    const double wanted = drawLog(random, 1.2 * kSmallest, 0.35);
    for (int i = 0; i < 5; ++i) {
        double difference = 0, signal = 0;
        for (std::size_t r = 1; r < 3; ++r) {
            const auto n = static_cast<Eigen::Index>(hidden.runs[r].duration * kFast);
            Eigen::MatrixXd truth;
            try {
                truth = simulateDevice({hidden.truth, hidden.outside, hidden.set_up}, makeDrive(hidden.runs[r]), kFast,
                                       n, 1 / kFast)
                            .relative;
            } catch (const TruthDiverged&) {
                return false;
            }
            difference += (simulateRelative(hidden, hidden.base, r) - truth).squaredNorm();
            signal += truth.squaredNorm();
        }
        hidden.change[0] = hidden.change[1] = std::sqrt(difference / signal);
        if (std::abs(std::log(hidden.change[0] / wanted)) < 0.3) return true;
        hidden.outside.size *= std::clamp(wanted / hidden.change[0], 0.3, 3.0);
    }
    return false;
}

/// Hides the effects in a device. Each of them alone, too: each must show by itself.
std::vector<Pair> drawEffects(HiddenCase& hidden, const MountModel& device, const std::vector<std::string>& wanted,
                              int level, Random& random) {
    hidden.base = hidden.truth = device;
    hidden.effects.clear();
    std::vector<Pair> alone;
    for (const auto& cause : wanted) {
        Pair pair{device, device};
        Random again = random;
        drawEffect(cause, pair.base, pair.truth, again, level, hidden.set_up);
        hidden.effects.push_back(drawEffect(cause, hidden.base, hidden.truth, random, level, hidden.set_up));
        pair.moves = !isSensor(hidden.effects.back());
        alone.push_back(std::move(pair));
    }
    return alone;
}

/// Levels of the runs and effects for a device; the validation run first, which is the sooner out of bounds.
bool drawVisible(HiddenCase& hidden, const MountModel& device, const std::vector<std::string>& wanted, int level,
                 Random& random) {
    constexpr int kEffects = 3;
    drawLevel(hidden, device, 2, random);
    std::vector<Pair> alone;
    bool visible = false;
    for (int draw = 0; draw < kEffects && !visible; ++draw) {
        alone = drawEffects(hidden, device, wanted, level, random);
        visible = isVisible(hidden, alone, 2, 2);
    }
    if (!visible) return false;
    drawLevel(hidden, device, 0, random);
    drawLevel(hidden, device, 1, random);
    if (!isVisible(hidden, alone, 0, 1) || !isPredictable(hidden)) return false;
    for (std::size_t group = 0; group < 2; ++group)
        hidden.change[group] = calcChange(hidden, {hidden.base, hidden.truth}, 2 * group, 1 + group);
    return true;
}

}  // namespace

HiddenCase drawCase(const CaseOptions& options, Random& random) {
    const std::string& kind = options.kind;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
        // The same causes are drawn again and again until a device shows them, so that no cause is rarer than others.
        static_assert(kAttempts > 20);
        HiddenCase hidden;
        hidden.kind = kind;
        hidden.set_up = options.set_up.value_or(drawSetUp(options.set_up_kind, random));
        const auto causes = listCauses(hidden.set_up);
        const auto drawCause = [&] { return causes[drawInteger(random, 0, static_cast<int>(causes.size()) - 1)]; };
        drawSensors(hidden, options, random);
        std::vector<std::string> wanted;
        if (kind == "single") wanted = {drawCause()};
        if (kind == "two") wanted = {drawCause(), drawCause()};
        if (wanted.empty() && kind != "none" && kind != "outside") {
            wanted = {kind};
            hidden.kind = "single";
            // Another set-up, or another cause where the set-up was asked for.
            if (std::count(causes.begin(), causes.end(), kind) == 0) {
                if (options.set_up_kind == "any") continue;
                wanted = {drawCause()};
            }
        }
        if (wanted.size() == 2 && wanted[0] == wanted[1]) continue;
        hidden.time_scale = options.time_scale.value_or(drawLog(random, 0.05, 20));
        // Its band is stated in Hz.
        if (std::count(wanted.begin(), wanted.end(), "structural_damping") > 0) hidden.time_scale = 1;
        const Excitation excitation = options.excitation.value_or(drawExcitation(random));
        constexpr double rates[] = {1000, 1250, 1600, 2000};
        hidden.rate = rates[drawInteger(random, 0, 3)];
        for (int device = 0; device < 3; ++device) {
            MountModel model = hidden.set_up.oneAxis() ? drawAxisDevice(random) : drawDevice(random);
            if (hidden.set_up.kind != SetUp::Kind::bracket) model.bracket.clear();
            if (hidden.set_up.oneAxis() && hidden.set_up.loaded()) model.load_point = LoadPoint{};
            drawRuns(hidden, excitation, random);
            if (!drawVisible(hidden, model, wanted, options.level, random)) continue;
            const bool drops = hidden.truth.load && hidden.truth.load->gain_over_frequency.size() > 1;
            if (drops && excitation == Excitation::random) continue;
            if (kind == "outside") {
                hidden.outside = drawOutside(hidden.base, hidden.set_up.oneAxis(), random);
                if (!scaleOutside(hidden, random)) continue;
            }
            nameAccelerations(hidden);
            const SmallErrors errors = makeSmallErrors(options.level);
            hidden.small_errors = errors.share;
            hidden.believed = options.level == 0 ? hidden.base : drawBelieved(hidden.base, errors, random);
            hidden.sensors = drawSensorErrors(options.level, hidden.base.connections.size(), hidden.time_scale, random);
            return hidden;
        }
    }
    throw std::runtime_error("no such case was found in " + std::to_string(kAttempts) + " attempts");
}

HiddenCase drawCase(const std::string& kind, Random& random, Sensors sensors) {
    CaseOptions options;
    options.kind = kind;
    options.sensors = sensors;
    options.set_up = SetUp{};
    options.excitation = Excitation::logarithmic;
    options.time_scale = 1;
    return drawCase(options, random);
}

Eigen::MatrixXd simulateRelative(const HiddenCase& hidden, const MountModel& model, std::size_t run) {
    const auto& plan = hidden.runs[run];
    const auto samples = static_cast<Eigen::Index>(plan.duration * kFast);
    static const OutsideEffect none;
    try {
        return simulateDevice({model, none, hidden.set_up}, makeDrive(plan), kFast, samples, 1 / kFast).relative;
    } catch (const TruthDiverged&) {
        return Eigen::MatrixXd::Constant(3 * model.connections.size(), samples, 1.0);
    }
}

}  // namespace wems::hidden
