#include "identify/problem/fast_motion.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>
#include <vector>

#include "identify/motion/fourier.hpp"
#include "identify/problem/band_limited_force.hpp"
#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/mount_equation.hpp"
#include "models/bryant.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;

constexpr double kOfNoise = 0.1;  // of a displacement, which a further pass would change less
constexpr int kMostPasses = 20;   // for time: a pass that does not contract ends them too

/// Wrench of all laws on the mobile part, about M's origin, but for the sign: 6 x samples, tapered.
Eigen::MatrixXd calcWrench(const OpenLoopRun& run, const MountModel& model, const Eigen::MatrixXd& directions) {
    AxisSeries forces(run.q.rows(), run.q.cols());
    for (Eigen::Index row = 0; row < forces.rows(); ++row) {
        const int connection = static_cast<int>(row / 3), axis = static_cast<int>(row % 3);
        forces.row(row) = calcAxisForce(run, model.connections[connection].axis[axis], connection, axis).transpose();
    }
    return directions * forces * run.taper.asDiagonal();
}

/// What both parts answer to the laws' wrench beyond the pass band, where inertia and the bracket's modes rule.
class Response {
public:
    /// 6 x samples.
    struct Motion {
        Eigen::MatrixXd relative, relative_rate;      ///< of the mobile part to the fixed one: what the low pass took
        Eigen::MatrixXd mobile_folded, fixed_folded;  ///< at the recording's samples; empty where nothing is taken off
    };

    Response(const OpenLoopRun& run, const MountModel& model)
        : run_(run),
          fourier_(run.sampleCount()),
          bin_(1 / (fourier_.size() * run.interval)),
          first_(static_cast<Eigen::Index>(run.pass / bin_)) {
        const Vector6 freedom = calcFreedom(model.body);
        Matrix6 mass = calcMassMatrix(model.body);
        holdMotions(mass, freedom, 1);
        mobility_ = mass.inverse();
        holdMotions(mobility_, freedom, 0);
        for (Eigen::Index b = first_; b < fourier_.binCount(); ++b) {
            receptance_.push_back(Matrix6c::Zero());
            for (const BracketMode& mode : model.bracket) {
                const Vector6 shape = calcShape(mode);
                receptance_.back() += calcModalResponse(mode, angular(b)) * (shape * shape.transpose()).cast<Complex>();
            }
        }
    }

    Motion calcMotion(const Eigen::MatrixXd& wrench) const {
        const Eigen::MatrixXcd spectra = fourier_.forward(wrench);
        Eigen::MatrixXcd relative = Eigen::MatrixXcd::Zero(6, spectra.cols()), rate = relative, mobile = relative,
                         fixed = relative;
        for (Eigen::Index b = first_; b < spectra.cols(); ++b) {
            const double w = angular(b), frequency = w / kTwoPi;
            const Vector6c on_mobile = mobility_.cast<Complex>() * spectra.col(b) / (w * w),
                           on_fixed = receptance_[static_cast<std::size_t>(b - first_)] * spectra.col(b);
            relative.col(b) = (1 - run_.filter.calcResponse(frequency)) * (on_mobile - on_fixed);
            rate.col(b) = Complex(0, w) * relative.col(b);
            if (2 * frequency * run_.raw_interval <= 1) continue;
            mobile.col(b) = on_mobile;
            fixed.col(b) = on_fixed;
        }
        const bool is_alone = std::isinf(run_.mobile_acceleration_noise);
        const bool fixed_alone = run_.fixed_measured && std::isinf(run_.fixed_acceleration_noise);
        return {fourier_.inverse(relative, run_.sampleCount()), fourier_.inverse(rate, run_.sampleCount()),
                is_alone ? sample(mobile) : Eigen::MatrixXd(), fixed_alone ? sample(fixed) : Eigen::MatrixXd()};
    }

private:
    using Matrix6c = Eigen::Matrix<Complex, 6, 6>;
    using Vector6c = Eigen::Matrix<Complex, 6, 1>;

    double angular(Eigen::Index b) const { return kTwoPi * bin_ * static_cast<double>(b); }

    Eigen::MatrixXd sample(const Eigen::MatrixXcd& spectra) const {
        const Eigen::MatrixXd all = fourier_.inverse(spectra, run_.sampleCount());
        const auto step = static_cast<Eigen::Index>(std::lround(run_.raw_interval / run_.interval));
        Eigen::MatrixXd sampled(6, (all.cols() - 1) / step + 1);
        for (Eigen::Index k = 0; k < sampled.cols(); ++k) sampled.col(k) = all.col(k * step);
        return sampled;
    }

    const OpenLoopRun& run_;
    Fourier fourier_;
    double bin_;
    Eigen::Index first_;
    Matrix6 mobility_;
    std::vector<Matrix6c, Eigen::aligned_allocator<Matrix6c>> receptance_;
};

/// A part's motion less what the low pass made of a small one (translation above rotation, at the recording's samples).
SmoothPart takeOff(SmoothPart part, const Eigen::MatrixXd& motion, const RunFilter& filter) {
    const Eigen::MatrixXd position = filter.apply(motion, 0), rate = filter.apply(motion, 1),
                          second = filter.apply(motion, 2);
    part.p -= position.topRows(3);
    part.v -= rate.topRows(3);
    part.a -= second.topRows(3);
    part.theta -= position.bottomRows(3);
    part.w -= rate.bottomRows(3);
    part.alpha -= second.bottomRows(3);
    for (std::size_t k = 0; k < part.R.size(); ++k)
        part.R[k] = rotationFromVector(part.theta.col(static_cast<Eigen::Index>(k)));
    return part;
}

}  // namespace

bool reachesStops(const OpenLoopRun& run, const MountModel& model) {
    for (Eigen::Index row = 0; row < run.q.rows(); ++row) {
        const AxisLaw& law = model.connections[row / 3].axis[row % 3];
        if ((calcStopStiffness(law, run.q.row(row), run.v.row(row), run.interval).array() != 0).any()) return true;
    }
    return false;
}

OpenLoopRun restoreFastMotion(OpenLoopRun run, const MountModel& model) {
    if (!run.filter.refines()) return run;
    Eigen::MatrixXd directions(6, run.q.rows());
    for (Eigen::Index row = 0; row < directions.cols(); ++row)
        directions.col(row) = calcAxisDirection(model, static_cast<int>(row / 3), static_cast<int>(row % 3));
    const SmoothPart measured_mobile = run.mobile, measured_fixed = run.fixed;
    const AxisSeries measured_q = run.q, measured_v = run.v;
    const Response response(run, model);
    const double enough = kOfNoise * std::hypot(run.mobile_noise, run.fixed_noise);
    double change = std::numeric_limits<double>::infinity();
    for (int pass = 0; pass < kMostPasses && change > enough; ++pass) {
        Response::Motion fast = response.calcMotion(calcWrench(run, model, directions));
        const bool mobile_folds = fast.mobile_folded.size() > 0, fixed_folds = fast.fixed_folded.size() > 0;
        SmoothPart mobile, fixed;
        if (mobile_folds) mobile = takeOff(measured_mobile, fast.mobile_folded, run.filter);
        if (fixed_folds) fixed = takeOff(measured_fixed, fast.fixed_folded, run.filter);
        AxisSeries q = measured_q, v = measured_v;
        if (mobile_folds || fixed_folds)
            calcRelative(model, mobile_folds ? mobile : measured_mobile, fixed_folds ? fixed : measured_fixed, q, v);
        q += directions.transpose() * fast.relative;
        v += directions.transpose() * fast.relative_rate;
        const double before = change;
        change = std::sqrt((q - run.q).squaredNorm() / static_cast<double>(q.size()));
        if (!(change < before)) break;
        run.q = std::move(q);
        run.v = std::move(v);
        if (mobile_folds) run.mobile = std::move(mobile);
        if (fixed_folds) run.fixed = std::move(fixed);
        run.mobile_folded = std::move(fast.mobile_folded);
        run.fixed_folded = std::move(fast.fixed_folded);
    }
    return run;
}

}  // namespace wems::identify
