#include "identify/fit/calibration_effect.hpp"

#include <Eigen/QR>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "identify/fit/linear_response.hpp"

namespace wems::identify {
namespace {

/// Responses of one run's residual to gain errors of its channels.
class RunResponse {
public:
    RunResponse(const RunMotion& motion, const MountModel& model, const RunEquations& equations)
        : motion_(motion),
          test_function_(equations.test_function),
          outputs_(equations.outputs),
          linear_(makeLinearResponse(motion, model)) {}

    /// Of a channel that decides the displacement of a part (and its acceleration, if `with_mass`): 6 x outputs.
    Eigen::Matrix<double, 6, Eigen::Dynamic> ofDisplacement(const PartMotion& part, const Vector6d& design,
                                                            const Vector6d& shift, double sign, bool with_mass) const {
        const Eigen::RowVectorXd s = project(design, part.p, part.theta), rate = project(design, part.v, part.w);
        Eigen::Matrix<double, 6, Eigen::Dynamic> wrench(6, s.size());
        wrench.setZero();
        for (Eigen::Index axis = 0; axis < linear_.directions.cols(); ++axis) {
            const double share = sign * linear_.directions.col(axis).dot(shift);
            wrench += linear_.directions.col(axis) *
                      (share * (linear_.tangent.row(axis).cwiseProduct(s) + linear_.damping(axis) * rate));
        }
        Eigen::Matrix<double, 6, Eigen::Dynamic> response = average(wrench, test_function_.value());
        if (with_mass) response += linear_.mass * shift * average(s, test_function_.second());
        return response;
    }

    /// Of a channel that decides the acceleration of the mobile part.
    Eigen::Matrix<double, 6, Eigen::Dynamic> ofAcceleration(const Vector6d& design, const Vector6d& shift) const {
        return linear_.mass * shift *
               average(project(design, motion_.mobile.a, motion_.mobile.alpha), test_function_.value());
    }

private:
    static Eigen::RowVectorXd project(const Vector6d& design, const Eigen::Matrix3Xd& linear,
                                      const Eigen::Matrix3Xd& angular) {
        return design.head<3>().transpose() * linear + design.tail<3>().transpose() * angular;
    }

    Eigen::MatrixXd average(const Eigen::MatrixXd& signal, const std::vector<double>& taps) const {
        const Eigen::Map<const Eigen::VectorXd> weights(taps.data(), taps.size());
        Eigen::MatrixXd result(signal.rows(), outputs_);
        for (Eigen::Index n = 0; n < outputs_; ++n)
            result.col(n) = signal.middleCols(n * test_function_.stride(), weights.size()) * weights;
        return result.colwise() - result.rowwise().mean();
    }

    const RunMotion& motion_;
    const TestFunction& test_function_;
    int outputs_;
    LinearResponse linear_;
};

/// The rigid fit of any channels of the run shows scatter of their gains.
bool hasGainScatter(const RunMotion& run) {
    return run.mobile.displacement_calibration.gain_scatter > 0 ||
           run.mobile.acceleration_calibration.gain_scatter > 0 ||
           run.fixed.displacement_calibration.gain_scatter > 0 || run.fixed.acceleration_calibration.gain_scatter > 0;
}

}  // namespace

CalibrationEffect calcCalibrationEffect(const Solver& solver, const LinearSystem& system) {
    CalibrationEffect effect;
    std::map<std::string, Eigen::VectorXd> scores;
    const NormalEquations& equations = solver.equations();
    for (std::size_t r = 0; r < solver.runCount(); ++r) {
        const RunMotion& motion = solver.motions()[r];
        if (!hasGainScatter(motion)) continue;
        const RunResponse response(motion, solver.model(), equations.runs()[r]);
        const RowMatrix sensitivity = solver.calcSensitivity(r, system);
        const auto addChannels = [&](const Calibration& calibration, const auto& calcResponse) {
            if (!(calibration.gain_scatter > 0)) return;
            const Eigen::MatrixXd shifts = calibration.design.completeOrthogonalDecomposition().pseudoInverse();
            for (std::size_t c = 0; c < calibration.channels.size(); ++c) {
                const Eigen::Index k = c;
                const Eigen::MatrixXd change =
                    equations.whitening(r) *
                    calcResponse(Vector6d(calibration.design.row(k).transpose()), Vector6d(shifts.col(k)));
                effect.residual_squares += std::pow(calibration.gain_scatter, 2) * change.squaredNorm();
                const Eigen::VectorXd score =
                    calibration.gain_scatter *
                    (sensitivity.transpose() * Eigen::Map<const Eigen::VectorXd>(change.data(), change.size()));
                auto& sum =
                    scores.try_emplace(calibration.channels[c], Eigen::VectorXd::Zero(score.size())).first->second;
                sum += score;
            }
        };
        const auto displacementOf = [&](const PartMotion& part, double sign, bool with_mass) {
            return [&, sign, with_mass](const Vector6d& design, const Vector6d& shift) {
                return response.ofDisplacement(part, design, shift, sign, with_mass);
            };
        };
        const PartMotion &mobile = motion.mobile, &fixed = motion.fixed;
        addChannels(mobile.displacement_calibration, displacementOf(mobile, 1, !mobile.acceleration_measured));
        addChannels(fixed.displacement_calibration, displacementOf(fixed, -1, false));
        addChannels(mobile.acceleration_calibration, [&](const Vector6d& design, const Vector6d& shift) {
            Eigen::Matrix<double, 6, Eigen::Dynamic> change = response.ofAcceleration(design, shift);
            if (!mobile.displacement_measured) change += response.ofDisplacement(mobile, design, shift, 1, false);
            return change;
        });
        if (!fixed.displacement_measured) addChannels(fixed.acceleration_calibration, displacementOf(fixed, -1, false));
    }
    effect.influences.resize(system.scale.size(), scores.size());
    Eigen::Index column = 0;
    for (const auto& entry : scores) effect.influences.col(column++) = system.inverse * entry.second;
    return effect;
}

}  // namespace wems::identify
