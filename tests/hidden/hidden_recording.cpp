#include "tests/hidden/hidden_recording.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

#include "identify/motion/fourier.hpp"
#include "models/bryant.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "tests/hidden/time_scale.hpp"

namespace wems::hidden {
namespace {

constexpr double kStep = 0.25e-3;  // s, longest of the truth
constexpr int kFiner = 4;          // samples before the filter for each that is recorded

/// One channel before it is sampled.
class ChannelMaker {
public:
    ChannelMaker(const HiddenCase& hidden, std::uint64_t seed, bool faults)
        : hidden_(hidden),
          faults_(faults),
          finer_(hidden.sensors.filtered ? kFiner : 1),
          filter_(0.4 / finer_),
          random_(seed) {}

    int finer() const { return finer_; }
    double fineRate() const { return finer_ * hidden_.rate; }

    /// @param truth motion of the triax at its place, 3 x fine samples; @param axes those that are recorded
    void addTriax(const std::string& side, const std::string& triax, const std::string& prefix,
                  const Eigen::MatrixXd& truth, const TriaxErrors& errors, Eigen::Index column, double noise,
                  Recording& recording) {
        const Eigen::Matrix3d turn = rotationFromVector(errors.rotation.col(column));
        for (int a = hidden_.set_up.oneAxis() ? 2 : 0; a < 3; ++a) {
            const std::string name = triax + "." + prefix + kAxes[a];
            double gain = errors.gain(a, column), delay = 0;
            Eigen::Matrix3d R = turn;
            for (const auto& sensor : hidden_.truth.sensors) {
                if (!faults_ || (sensor.channel != side && sensor.channel != triax && sensor.channel != name)) continue;
                gain *= sensor.gain;
                delay += sensor.delay;
                R = rotationFromVector(sensor.rotation) * R;
            }
            Eigen::VectorXd signal = gain * (R.row(a) * truth).transpose();
            if (delay > 0) signal = delayed(signal, delay * fineRate());
            if (!prefix.empty() && hidden_.sensors.coupling > 0)
                coupleAc(signal, hidden_.sensors.coupling * hidden_.time_scale / fineRate());
            signal +=
                noise * drawNoise(hidden_.sensors, finer_, hidden_.time_scale, fineRate(), signal.size(), random_);
            add(name, prefix.empty() ? "m" : "m/s^2", signal, recording);
        }
    }

    void addLoad(const Eigen::Matrix3Xd& load, Recording& recording) {
        std::normal_distribution<double> normal(0, 1);
        const double noise =
            hidden_.sensors.load_noise * std::sqrt(load.squaredNorm() / static_cast<double>(load.cols()));
        for (int a = hidden_.set_up.oneAxis() ? 2 : 0; a < 3; ++a) {
            Eigen::VectorXd signal = hidden_.sensors.load_gain[a] * load.row(a).transpose();
            if (noise > 0)
                for (double& value : signal) value += noise * std::sqrt(finer_ / 0.82) * normal(random_);
            add(std::string("load.f") + kAxes[a], "N", signal, recording);
        }
    }

private:
    /// Cubic through four neighbours at the delayed time.
    static Eigen::VectorXd delayed(const Eigen::VectorXd& row, double samples) {
        Eigen::VectorXd result(row.size());
        for (Eigen::Index k = 0; k < row.size(); ++k) {
            const double at = std::max(0.0, static_cast<double>(k) - samples);
            const auto first = std::clamp<Eigen::Index>(static_cast<Eigen::Index>(at) - 1, 0, row.size() - 4);
            const double u = at - static_cast<double>(first + 1);
            result[k] = -row[first] * u * (u - 1) * (u - 2) / 6 + row[first + 1] * (u + 1) * (u - 1) * (u - 2) / 2 -
                        row[first + 2] * (u + 1) * u * (u - 2) / 2 + row[first + 3] * (u + 1) * u * (u - 1) / 6;
        }
        return result;
    }

    void add(const std::string& name, const std::string& unit, Eigen::VectorXd& signal, Recording& recording) {
        if (hidden_.sensors.filtered) filter_.apply(signal);
        Channel channel;
        channel.name = name;
        channel.unit = unit;
        for (Eigen::Index k = 0; k < signal.size(); k += finer_) channel.values.push_back(signal[k]);
        recording.channels.push_back(std::move(channel));
    }

    const HiddenCase& hidden_;
    bool faults_;
    int finer_;
    AntiAliasFilter filter_;
    Random random_;
};

Eigen::Matrix3Xd listPlaces(const MountModel& model, const TriaxErrors& errors) {
    Eigen::Matrix3Xd places = errors.place;
    for (std::size_t i = 0; i < model.connections.size(); ++i) places.col(i) += model.connections[i].position;
    return places;
}

/// Connections with a sensor: of a one-axis rig the first alone.
std::size_t countTriaxes(const HiddenCase& hidden) {
    return hidden.set_up.oneAxis() ? 1 : hidden.truth.connections.size();
}

/// Rows of all recorded connections, empty if there are none.
Eigen::MatrixXd listRows(const HiddenCase& hidden, const Recording& recording, const std::string& side,
                         const std::string& prefix) {
    const auto n = static_cast<Eigen::Index>(recording.time.size());
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3 * static_cast<Eigen::Index>(countTriaxes(hidden)), n);
    bool any = false;
    for (std::size_t i = 0; i < countTriaxes(hidden); ++i)
        for (int a = 0; a < 3; ++a) {
            const std::string triax = side + "." + hidden.truth.connections[i].name + ".";
            const Channel* channel = recording.find(triax + prefix + kAxes[a]);
            if (channel == nullptr) continue;
            any = true;
            rows.row(3 * i + a) = Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), n);
        }
    return any ? rows : Eigen::MatrixXd();
}

Eigen::Matrix3Xd findVector(const Recording& recording, const std::string& name) {
    const auto n = static_cast<Eigen::Index>(recording.time.size());
    Eigen::Matrix3Xd rows = Eigen::Matrix3Xd::Zero(3, n);
    for (int a = 0; a < 3; ++a)
        if (const Channel* channel = recording.find(name + kAxes[a]))
            rows.row(a) = Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), n);
    return rows;
}

/// Mean of the connections.
Eigen::Matrix3Xd average(const Eigen::MatrixXd& rows) {
    Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, rows.cols());
    for (Eigen::Index i = 0; i < rows.rows(); i += 3) mean += rows.middleRows(i, 3);
    return mean * 3 / static_cast<double>(rows.rows());
}

/// Five-point second difference, zero at the ends.
Eigen::Matrix3Xd differentiateTwice(const Eigen::Matrix3Xd& x, double rate) {
    Eigen::Matrix3Xd a = Eigen::Matrix3Xd::Zero(3, x.cols());
    for (Eigen::Index k = 2; k + 2 < x.cols(); ++k)
        a.col(k) =
            rate * rate / 12 * (16 * (x.col(k - 1) + x.col(k + 1)) - x.col(k - 2) - x.col(k + 2) - 30 * x.col(k));
    return a;
}

/// Displacements above 0.6 times the lowest excited frequency, from displacements or (two integrations) accelerations
/// that begin at rest: a causal high-pass of fourth order, the same for both, so that the ends of a run leave nothing.
Eigen::MatrixXd filterHigh(const Eigen::MatrixXd& rows, double rate, int integrations) {
    constexpr double corner = 0.6 * kTwoPi * kLowest, zeta = 0.7, tail = 3;
    const identify::Fourier fourier(static_cast<int>(rows.cols()) + static_cast<int>(tail * rate));
    Eigen::MatrixXd padded = Eigen::MatrixXd::Zero(rows.rows(), fourier.size());
    padded.leftCols(rows.cols()) = rows;
    Eigen::MatrixXcd spectra = fourier.forward(padded);
    for (Eigen::Index k = 0; k < spectra.cols(); ++k) {
        const std::complex<double> s(0, kTwoPi * static_cast<double>(k) * rate / fourier.size());
        const std::complex<double> low = 1.0 / (s * s + 2 * zeta * corner * s + corner * corner);
        spectra.col(k) *= (integrations == 2 ? 1.0 : s * s) * s * s * low * low;
    }
    return fourier.inverse(spectra, static_cast<int>(rows.cols()));
}

/// Rows minus the table's motion at each connection.
Eigen::MatrixXd subtract(Eigen::MatrixXd rows, const Eigen::Matrix3Xd& table) {
    for (Eigen::Index i = 0; i < rows.rows(); i += 3) rows.middleRows(i, 3) -= table;
    return rows;
}

struct Measured {
    Eigen::MatrixXd relative;
    bool high = false;  // what lies low is not measured
};

Measured measureRelative(const HiddenCase& hidden, const Recording& recording) {
    const auto rows = [&](const char* side, const char* prefix) { return listRows(hidden, recording, side, prefix); };
    const bool stands = hidden.set_up.oneAxis() && !hidden.set_up.shaken;
    const Eigen::MatrixXd mobile = rows("mobile", ""), fixed = rows("fixed", "");
    if (mobile.size() > 0 && (stands || fixed.size() > 0)) return {stands ? mobile : mobile - fixed};
    const double rate = hidden.rate;
    Eigen::MatrixXd relative =
        mobile.size() > 0 ? filterHigh(mobile, rate, 0) : filterHigh(rows("mobile", "a"), rate, 2);
    if (const Eigen::MatrixXd fixed_acceleration = rows("fixed", "a"); fixed_acceleration.size() > 0)
        relative -= filterHigh(fixed_acceleration, rate, 2);
    else if (!stands)
        relative = subtract(relative, filterHigh(findVector(recording, "base.a"), rate, 2));
    return {relative, true};
}

Drive measureDrive(const HiddenCase& hidden, const RunPlan& plan, const Recording& recording) {
    Drive drive{hidden.rate, {}, {}};
    if (hidden.set_up.loaded()) {
        drive.values = findVector(recording, "load.f");
        if (plan.frequency.size() > 0)
            drive.frequency =
                resample(plan.frequency.transpose(), kTableRate, hidden.rate, drive.values.cols()).transpose();
        return drive;
    }
    const Eigen::MatrixXd fixed = listRows(hidden, recording, "fixed", "");
    const Eigen::MatrixXd acceleration = listRows(hidden, recording, "fixed", "a");
    drive.values = fixed.size() > 0          ? differentiateTwice(average(fixed), hidden.rate)
                   : acceleration.size() > 0 ? average(acceleration)
                                             : findVector(recording, "base.a");
    return drive;
}

}  // namespace

Recording recordRun(const HiddenCase& hidden, std::size_t run, std::uint64_t seed, bool faults) {
    const RunPlan& plan = hidden.runs[run];
    const SetUp& set_up = hidden.set_up;
    const SensorErrors& errors = hidden.sensors;
    ChannelMaker maker(hidden, seed + 1 + run, faults);
    const double rate = maker.fineRate();
    const auto samples = static_cast<Eigen::Index>(plan.duration * hidden.rate) * maker.finer();
    const Points points{
        listPlaces(hidden.truth, errors.mobile_displacement), listPlaces(hidden.truth, errors.mobile_acceleration),
        listPlaces(hidden.truth, errors.fixed_displacement), listPlaces(hidden.truth, errors.fixed_acceleration)};
    const Drive drive = makeDrive(plan);
    DeviceMotion motion = simulateDevice({hidden.truth, hidden.outside, set_up}, drive, rate, samples, kStep, &points);
    Eigen::Matrix3Xd table = Eigen::Matrix3Xd::Zero(3, samples);
    const Eigen::Matrix3Xd applied = resample(drive.values, kTableRate, rate, samples);
    if (set_up.baseDriven()) {
        table = plan.direction * plan.level * resample(plan.travel.transpose(), kTableRate, rate, samples);
        for (auto* rows : {&motion.mobile_displacement, &motion.fixed_displacement}) *rows = subtract(*rows, -table);
        for (auto* rows : {&motion.mobile_acceleration, &motion.fixed_acceleration}) *rows = subtract(*rows, -applied);
    }
    Recording recording;
    recording.file = "run.csv";
    for (Eigen::Index k = 0; k < samples; k += maker.finer())
        recording.time.push_back(static_cast<double>(k / maker.finer()) / hidden.rate);
    const auto add = [&](const std::string& side, const std::string& prefix, const Eigen::MatrixXd& rows,
                         const TriaxErrors& triax_errors, double noise) {
        for (std::size_t i = 0; noise > 0 && i < countTriaxes(hidden); ++i) {
            const Eigen::Index column = i;
            maker.addTriax(side, side + "." + hidden.truth.connections[i].name, prefix, rows.middleRows(3 * column, 3),
                           triax_errors, column, noise, recording);
        }
    };
    add("mobile", "", motion.mobile_displacement, errors.mobile_displacement, hidden.displacement_noise);
    if (set_up.records_fixed)
        add("fixed", "", motion.fixed_displacement, errors.fixed_displacement, hidden.displacement_noise);
    add("mobile", "a", motion.mobile_acceleration, errors.mobile_acceleration, hidden.acceleration_noise);
    if (set_up.records_fixed)
        add("fixed", "a", motion.fixed_acceleration, errors.fixed_acceleration, hidden.acceleration_noise);
    if (set_up.records_base) {
        const double noise = hidden.acceleration_noise > 0 ? hidden.acceleration_noise : 0.03;
        maker.addTriax("base", "base", "a", applied, errors.base, 0, noise, recording);
    }
    if (set_up.loaded()) maker.addLoad(applied, recording);
    return recording;
}

Recording recordForward(const HiddenCase& hidden, std::size_t run, std::uint64_t seed) {
    return slowDown(recordRun(hidden, run, seed), hidden.time_scale);
}

double ErrorSquares::error() const {
    return std::sqrt(difference / reference);
}

ErrorSquares calcError(const HiddenCase& hidden, std::size_t run, const MountModel& model, const OutsideEffect& outside,
                       const Recording& recording) {
    const Measured measured = measureRelative(hidden, recording);
    ErrorSquares squares;
    squares.reference = measured.relative.squaredNorm();
    try {
        Eigen::MatrixXd simulated =
            simulateDevice({model, outside, hidden.set_up}, measureDrive(hidden, hidden.runs[run], recording),
                           hidden.rate, measured.relative.cols(), kStep)
                .relative.topRows(measured.relative.rows());
        if (measured.high) simulated = filterHigh(simulated, hidden.rate, 0);
        squares.difference = (simulated - measured.relative).squaredNorm();
    } catch (const TruthDiverged&) {
        squares.difference = std::numeric_limits<double>::infinity();
    }
    return squares;
}

}  // namespace wems::hidden
