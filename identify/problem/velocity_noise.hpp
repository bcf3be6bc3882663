/// @file
/// Velocities without the noise that differentiation makes of a displacement's, for laws that turn on the sign of the
/// velocity: noise of 2 µm up to 300 Hz is 2 mm/s, while friction that sticks creeps at less.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <mutex>
#include <vector>

namespace wems::identify {

/// A row for each axis, its samples side by side in memory: laws go along them.
using AxisSeries = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Wiener filter over short-time spectra (overlapping frames): what lies below twice the noise in a stretch and
/// a band goes, the rest loses the noise's share of its power. Zero phase. (Oppenheim, Verghese, Signals, Systems and
/// Inference, 2016, ch. 12; Lim, Oppenheim 1979, doi:10.1109/PROC.1979.11540.)
/// @param frame samples of a frame, as velocityNoiseFrame() gives it
/// @param velocities rows of samples `interval` (s) apart, m/s
/// @param density one-sided noise density of each row at k/(n interval), n = frame,
///     (m/s)²/Hz: rows x (n/2 + 1)
Eigen::MatrixXd removeVelocityNoise(const Eigen::MatrixXd& velocities, int frame, double interval,
                                    const Eigen::MatrixXd& density);
/// Two and a half periods of the lowest excited frequency (Hz).
int velocityNoiseFrame(double interval, double lowest);

/// Velocities as friction takes them. An axis is rid of its noise when its friction is first asked for: most have none.
class QuietVelocities {
public:
    QuietVelocities() = default;
    /// Without noise. m/s
    explicit QuietVelocities(const AxisSeries& velocities) : added_(velocities) {}
    /// As removeVelocityNoise takes them.
    QuietVelocities(const AxisSeries& velocities, int frame, double interval, const Eigen::MatrixXd& density);

    /// m/s; may be asked by several threads at once.
    Eigen::VectorXd of(Eigen::Index axis) const;
    /// Motion without such noise on top of it, m/s.
    void add(const AxisSeries& velocities);

private:
    struct Noisy {
        AxisSeries velocities;
        int frame = 0;
        double interval = 0;
        Eigen::MatrixXd density;
        std::mutex guard;
        std::vector<Eigen::VectorXd> quiet;  // of each axis, empty until it is asked for
    };
    std::shared_ptr<Noisy> noisy_;
    AxisSeries added_;
};

}  // namespace wems::identify
