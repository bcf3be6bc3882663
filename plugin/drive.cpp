#include "plugin/drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "models/common/error.hpp"

namespace wems::plugin {

CubicSpline::CubicSpline(std::vector<double> x, std::vector<double> y)
    : x_(std::move(x)), y_(std::move(y)), curvature_(x_.size(), 0.0) {
    const std::size_t n = x_.size();
    if (n < 3) return;
    // Thomas algorithm on h_{i-1} m_{i-1} + 2 (h_{i-1} + h_i) m_i + h_i m_{i+1} = 6 (slope_i − slope_{i-1}).
    std::vector<double> ratio(n, 0.0);
    for (std::size_t i = 1; i + 1 < n; ++i) {
        const double before = x_[i] - x_[i - 1], after = x_[i + 1] - x_[i];
        const double right = 6 * ((y_[i + 1] - y_[i]) / after - (y_[i] - y_[i - 1]) / before);
        const double pivot = 2 * (before + after) - before * ratio[i - 1];
        ratio[i] = after / pivot;
        curvature_[i] = (right - before * curvature_[i - 1]) / pivot;
    }
    for (std::size_t i = n - 2; i > 0; --i) curvature_[i] -= ratio[i] * curvature_[i + 1];
}

double CubicSpline::calcValue(double x) const {
    if (x <= x_.front()) return y_.front();
    if (x >= x_.back()) return y_.back();
    const auto i = static_cast<std::size_t>(std::upper_bound(x_.begin(), x_.end(), x) - x_.begin()) - 1;
    const double h = x_[i + 1] - x_[i];
    const double b = (x - x_[i]) / h, a = 1 - b;
    return a * y_[i] + b * y_[i + 1] +
           ((a * a * a - a) * curvature_[i] + (b * b * b - b) * curvature_[i + 1]) * h * h / 6;
}

namespace {

class SignalDrive : public Drive {
public:
    SignalDrive(std::shared_ptr<const Signal> signal, const Eigen::Vector3d& force, const Eigen::Vector3d& base,
                bool swept)
        : signal_(std::move(signal)), force_(force), base_(base), swept_(swept) {}
    double duration() const override { return signal_->duration(); }
    Eigen::Vector3d calcLoad(double t) const override {
        return hasLoad() ? Eigen::Vector3d(force_ * signal_->value(t)) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    }
    Eigen::Vector3d calcBaseAcceleration(double t) const override {
        return hasBase() ? Eigen::Vector3d(base_ * signal_->value(t)) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    }
    double calcFrequency(double t) const override {
        return swept_ ? signal_->frequency(t) : std::numeric_limits<double>::quiet_NaN();
    }
    double highestFrequency() const override { return signal_->highestFrequency(); }
    std::vector<double> kinks() const override { return signal_->kinks(); }
    std::optional<BaseStart> findBaseStart() const override {
        const auto integrals = signal_->integralsAtStart();
        if (!integrals) return std::nullopt;
        return BaseStart{base_ * integrals->second, base_ * integrals->first};
    }
    bool hasLoad() const override { return !force_.isZero(); }
    bool hasBase() const override { return !base_.isZero(); }

private:
    std::shared_ptr<const Signal> signal_;
    Eigen::Vector3d force_, base_;
    bool swept_;
};

using Axes = std::array<std::optional<CubicSpline>, 3>;

Eigen::Vector3d evaluate(const Axes& axes, double t) {
    Eigen::Vector3d value = Eigen::Vector3d::Zero();
    for (int i = 0; i < 3; ++i)
        if (const auto& axis = axes[i]) value[i] = axis->calcValue(t);
    return value;
}

class ReplayDrive : public Drive {
public:
    explicit ReplayDrive(const Recording& recording) {
        time_ = recording.time;
        for (double& t : time_) t -= recording.time.front();
        const Channel* strongest = nullptr;
        double largest = 0;
        for (const Channel& channel : recording.channels) {
            const auto name = parseChannelName(channel.name);
            if (!name || (name->part != Part::load && name->part != Part::base)) continue;
            auto& axes = name->part == Part::load ? load_ : base_;
            axes[name->axis].emplace(time_, channel.values);
            double power = 0;
            for (const double value : channel.values) power += value * value;
            // Loads and accelerations do not compare; with both, the load sweeps.
            if (name->part == Part::load) power *= 1e12;
            if (power > largest) {
                largest = power;
                strongest = &channel;
            }
        }
        if (!hasLoad() && !hasBase())
            throw InputError({recording.file, 0, "--from-csv"}, "nothing to replay in the recording",
                             "columns load.fx, load.fy, load.fz or base.ax, base.ay, base.az");
        if (strongest != nullptr) findFrequency(strongest->values);
    }
    double duration() const override { return time_.back(); }
    Eigen::Vector3d calcLoad(double t) const override { return evaluate(load_, t); }
    Eigen::Vector3d calcBaseAcceleration(double t) const override { return evaluate(base_, t); }
    double calcFrequency(double t) const override {
        if (crossings_.empty()) return std::numeric_limits<double>::quiet_NaN();
        const auto next = std::upper_bound(crossings_.begin(), crossings_.end(), t);
        if (next == crossings_.begin()) return frequencies_.front();
        const std::size_t i = next - crossings_.begin();
        if (i >= crossings_.size()) return frequencies_.back();
        const double fraction = (t - crossings_[i - 1]) / (crossings_[i] - crossings_[i - 1]);
        return frequencies_[i - 1] + fraction * (frequencies_[i] - frequencies_[i - 1]);
    }
    /// Of the samples; whatever the recording holds is below.
    double highestFrequency() const override {
        return 0.5 * static_cast<double>(time_.size() - 1) / std::max(duration(), 1e-300);
    }
    bool hasLoad() const override { return has(load_); }
    bool hasBase() const override { return has(base_); }

private:
    static bool has(const Axes& axes) { return axes[0] || axes[1] || axes[2]; }

    /// Frequency from one upward zero crossing to the next, assigned to the middle between them.
    void findFrequency(const std::vector<double>& values) {
        double previous = std::numeric_limits<double>::quiet_NaN();
        for (std::size_t k = 1; k < values.size(); ++k) {
            if (!(values[k - 1] < 0 && values[k] >= 0)) continue;
            const double fraction = values[k - 1] / (values[k - 1] - values[k]);
            const double crossing = time_[k - 1] + fraction * (time_[k] - time_[k - 1]);
            if (std::isfinite(previous)) {
                crossings_.push_back((previous + crossing) / 2);
                frequencies_.push_back(1 / (crossing - previous));
            }
            previous = crossing;
        }
    }

    std::vector<double> time_, crossings_, frequencies_;
    Axes load_, base_;
};

}  // namespace

std::shared_ptr<const Drive> makeSignalDrive(std::shared_ptr<const Signal> signal, const Eigen::Vector3d& force,
                                             const Eigen::Vector3d& base_acceleration, bool swept) {
    return std::make_shared<SignalDrive>(std::move(signal), force, base_acceleration, swept);
}

std::shared_ptr<const Drive> makeReplayDrive(const Recording& recording) {
    return std::make_shared<ReplayDrive>(recording);
}

}  // namespace wems::plugin
