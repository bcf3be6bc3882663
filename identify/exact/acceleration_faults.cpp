#include "identify/exact/acceleration_faults.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "identify/exact/channel_faults.hpp"
#include "identify/problem/fourier.hpp"
#include "models/bryant.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kAccelerationPass = 55.0, kAccelerationStop = 110.0, kAccelerationRate = 400.0;  // Hz
constexpr double kLeastTriaxShare = 0.5;  // of what exceeds the noise
constexpr double kAttenuation = 0.2;      // how well the noise of the predictions is known

/// Sums over the samples of one triax: predicted accelerations and their rates z (6), misfit d (3).
struct TriaxMoments {
    Matrix6 signal = Matrix6::Zero();
    Eigen::Matrix<double, 3, 6> misfit = Eigen::Matrix<double, 3, 6>::Zero();
    Eigen::Vector3d square = Eigen::Vector3d::Zero();
    double independent = 0;                           // values of one channel
    Eigen::Vector3d noise = Eigen::Vector3d::Zero();  // of the predictions, in the units of signal
};

/// Variance of the second derivative of unit white noise.
double calcNoiseGain(const SmoothingKernel& kernel) {
    Eigen::MatrixXd impulse = Eigen::MatrixXd::Zero(1, 4 * kernel.halfWidth() + 1);
    impulse(0, 2 * kernel.halfWidth()) = 1;
    return kernel.apply(impulse, 2, 1).squaredNorm();
}

/// Share of a marker's noise that the rigid fit passes on to its own place, for the three axes: the diagonal of the hat
/// matrix; on average over all markers 6 / (3 markers).
Eigen::Vector3d calcLeverages(const PartMotion& part, const std::string& triad, std::size_t markers) {
    Eigen::Vector3d leverages = Eigen::Vector3d::Constant(2.0 / static_cast<double>(markers));
    const Calibration& calibration = part.displacement_calibration;
    if (calibration.channels.size() < 6) return leverages;
    const Eigen::MatrixXd hat =
        calibration.design * calibration.design.completeOrthogonalDecomposition().pseudoInverse();
    for (std::size_t c = 0; c < calibration.channels.size(); ++c)
        for (int a = 0; a < 3; ++a)
            if (calibration.channels[c] == triad + "." + kAxes[a]) leverages[a] = hat(c, c);
    return leverages;
}

bool addRun(const Recording& recording, const RunMotion& motion, const PartMotion& part, const std::string& triad,
            const Eigen::Vector3d& position, const Eigen::Vector3d& leverages, TriaxMoments& moments) {
    if (recording.sampleCount() != motion.time.size()) return false;
    const Eigen::Index samples = recording.sampleCount();
    Eigen::MatrixXd measured(3, samples), point(3, samples);
    for (int a = 0; a < 3; ++a) {
        const Channel* channel = recording.find(triad + ".a" + kAxes[a]);
        if (channel == nullptr) return false;
        measured.row(a) = Eigen::Map<const Eigen::RowVectorXd>(channel->values.data(), samples);
    }
    for (Eigen::Index k = 0; k < samples; ++k)
        point.col(k) = part.p.col(k) + rotationFromVector(part.theta.col(k)) * position;
    const SmoothingKernel kernel(motion.interval, kAccelerationPass, kAccelerationStop);
    const int step = std::max(1, static_cast<int>(1 / motion.interval / kAccelerationRate));
    const double interval = step * motion.interval;
    const Eigen::MatrixXd s = kernel.apply(point, 2, step), y = kernel.apply(measured, 0, step);
    const Eigen::Index margin = 2 + 2 * kernel.halfWidth() / step;
    for (Eigen::Index k = margin; k + margin < s.cols(); ++k) {
        Eigen::Matrix<double, 6, 1> z;
        z.head<3>() = s.col(k);
        z.tail<3>() = (8 * (s.col(k + 1) - s.col(k - 1)) - (s.col(k + 2) - s.col(k - 2))) / (12 * interval);
        const Eigen::Vector3d d = y.col(k) - s.col(k);
        moments.signal += z * z.transpose();
        moments.misfit += d * z.transpose();
        moments.square += d.cwiseAbs2();
    }
    // Noise of the displacements that predict would pass for a gain below one: its mean is taken out.
    const Eigen::Vector3d power = static_cast<double>(std::max<Eigen::Index>(0, s.cols() - 2 * margin)) *
                                  part.displacement_noise * part.displacement_noise * calcNoiseGain(kernel) * leverages;
    if (power.allFinite()) {
        moments.noise += power;
        // Along an axis that does not move nothing but this noise stands there: no signal is left, not less than none.
        moments.signal.diagonal().head<3>() = (moments.signal.diagonal().head<3>() - power).cwiseMax(0.0);
        moments.misfit.diagonal() += power;
    }
    moments.independent += static_cast<double>(s.cols()) * interval * 2 * kAccelerationPass;
    return true;
}

struct TriaxHypothesis {
    std::string cause, channel;
    std::vector<Eigen::Matrix<double, 3, 6>> maps;
};

std::vector<TriaxHypothesis> listHypotheses(const std::string& triad) {
    std::vector<TriaxHypothesis> list;
    TriaxHypothesis turned{"sensor_misalignment", triad + ".a", {}};
    for (int a = 0; a < 3; ++a) {
        Eigen::Matrix<double, 3, 6> gain = Eigen::Matrix<double, 3, 6>::Zero(), delay = gain, turn = gain;
        gain(a, a) = 1;
        delay(a, 3 + a) = -1;
        turn((a + 1) % 3, (a + 2) % 3) = -1;
        turn((a + 2) % 3, (a + 1) % 3) = 1;
        list.push_back({"sensor_gain", triad + ".a" + kAxes[a], {gain}});
        list.push_back({"sensor_delay", triad + ".a" + kAxes[a], {delay}});
        turned.maps.push_back(turn);
    }
    list.push_back(turned);
    Eigen::Matrix<double, 3, 6> all = Eigen::Matrix<double, 3, 6>::Zero();
    for (int a = 0; a < 3; ++a) all(a, 3 + a) = -1;
    list.push_back({"sensor_delay", triad + ".a", {all}});
    return list;
}

void testTriax(const TriaxMoments& moments, const std::string& triad, double gain_scatter,
               std::vector<ChannelFault>& faults) {
    // What all columns together leave is noise.
    const Matrix6 inverse = (moments.signal + 1e-12 * moments.signal.trace() * Matrix6::Identity()).inverse();
    Eigen::Vector3d noise;
    double explainable = 0;
    for (int a = 0; a < 3; ++a) {
        const double taken = moments.misfit.row(a) * inverse * moments.misfit.row(a).transpose();
        noise[a] = std::max((moments.square[a] - taken) / moments.independent, 1e-12);
        explainable += taken / noise[a];
    }
    double best = 0;
    ChannelFault chosen;
    for (const auto& hypothesis : listHypotheses(triad)) {
        const Eigen::Index count = hypothesis.maps.size();
        Eigen::MatrixXd normal(count, count);
        Eigen::VectorXd right(count);
        const Eigen::Matrix3d weight = noise.cwiseInverse().asDiagonal();
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto& map = hypothesis.maps[i];
            right[i] = (weight * map).cwiseProduct(moments.misfit).sum();
            for (Eigen::Index j = 0; j < count; ++j)
                normal(i, j) = (weight * map * moments.signal).cwiseProduct(hypothesis.maps[j]).sum();
        }
        if (hypothesis.cause == "sensor_misalignment") normal.diagonal().array() += 1 / (kTurned * kTurned);
        const Eigen::VectorXd values = normal.ldlt().solve(right);
        const Eigen::VectorXd errors = normal.inverse().diagonal().cwiseAbs().cwiseSqrt();
        const double gain = values.dot(right) - 30.0 * static_cast<double>(count);
        const Eigen::Vector3d signal = moments.signal.diagonal().head<3>().cwiseMax(1e-300);
        const double attenuation = kAttenuation * moments.noise.cwiseQuotient(signal).maxCoeff();
        const bool large = hypothesis.cause == "sensor_gain"
                               ? std::abs(values[0]) > kScatters * gain_scatter + attenuation
                           : hypothesis.cause == "sensor_delay" ? std::abs(values[0]) > kLeastDelay
                                                                : isTurned(values);
        if (gain <= best || !large) continue;
        best = gain;
        chosen = {};
        chosen.cause = hypothesis.cause;
        chosen.fault.channel = hypothesis.channel;
        chosen.improvement = gain;
        if (hypothesis.cause == "sensor_gain") {
            chosen.fault.gain = 1 + values[0];
            chosen.gain_error = errors[0];
        } else if (hypothesis.cause == "sensor_delay") {
            chosen.fault.delay = values[0];
            chosen.delay_error = errors[0];
        } else {
            chosen.fault.rotation = values.head<3>();
            chosen.rotation_error = errors.maxCoeff();
        }
    }
    if (best > std::max(kLeastFaultGain, kLeastTriaxShare * explainable)) faults.push_back(chosen);
}

}  // namespace

std::vector<ChannelFault> findAccelerationFaults(const std::vector<Recording>& recordings,
                                                 const std::vector<RunMotion>& motions, const MountModel& model,
                                                 double gain_scatter) {
    std::vector<ChannelFault> faults;
    for (const bool mobile : {true, false})
        for (const auto& connection : model.connections) {
            const std::string triad = (mobile ? "mobile." : "fixed.") + connection.name;
            TriaxMoments moments;
            bool complete = true;
            for (std::size_t r = 0; r < recordings.size() && complete; ++r) {
                const PartMotion& part = mobile ? motions[r].mobile : motions[r].fixed;
                complete =
                    part.displacement_measured && addRun(recordings[r], motions[r], part, triad, connection.position,
                                                         calcLeverages(part, triad, model.connections.size()), moments);
            }
            if (complete && moments.independent > 0) testTriax(moments, triad, gain_scatter, faults);
        }
    return faults;
}

}  // namespace wems::identify
