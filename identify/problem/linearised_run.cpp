#include "identify/problem/linearised_run.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/problem/run_noise.hpp"
#include "identify/problem/sensor_columns.hpp"
#include "models/bryant.hpp"
#include "models/pi.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;
using Vector6c = Eigen::Matrix<Complex, 6, 1>;
using Vector12c = Eigen::Matrix<Complex, 12, 1>;

constexpr double kFrom = 0.5;                  // of the lowest excited frequency: where equations begin to count
constexpr double kTo = 2.2;                    // of the highest
constexpr double kOfPass = 0.9;                // and of the low pass
constexpr int kNoiseBands = 4;                 // of each run, in which the noise's level is known apart
constexpr double kRoot2 = 1.4142135623730951;  // real and imaginary parts share the variance

/// Everything about a run at a state that residual and columns share.
class Lineariser {
public:
    /// @param noise null: that of the state
    Lineariser(const TestRun& test, const SensorLayout& layout, const TestState& state,
               std::shared_ptr<const RunNoise> noise)
        : test_(test),
          model_(state.model),
          open_(makeRun()),
          slow_(open_.integrated && open_.lowest > 0 ? std::make_unique<SlowBalance>(open_, model_) : nullptr),
          with_bracket_(BracketEquation::isAvailable(open_, model_)),
          spectra_(open_, std::max(kFrom * test.band.lowest, slow_ ? slow_->highestBalanced() : open_.lowest),
                   std::min(kTo * test.band.highest, kOfPass * open_.pass)),
          motion_noise_(test, layout),
          noise_(noise != nullptr && noise->binCount() == spectra_.binCount()
                     ? std::move(noise)
                     : std::make_shared<RunNoise>(test, open_, model_, motion_noise_, spectra_, slow_.get(),
                                                  with_bracket_)),
          bracket_(open_) {
        calcResiduals();
    }

    /// What the columns need beyond the residual.
    void prepareColumns() {
        K_ = calcStiffnessMatrix(model_);
        C_ = calcDampingMatrix(model_);
        M_ = calcMassMatrix(model_.body);
        demand_ = calcDemand(open_, model_.body, model_.gravity);
        if (with_bracket_) inputs_ = spectra_.transform(bracket_.calcInputs(model_));
        const auto axes = 3 * static_cast<Eigen::Index>(model_.connections.size());
        forces_.resize(axes, open_.sampleCount());
        tangent_.resize(axes, open_.sampleCount());
        rest_tangent_.resize(axes);
        touched_.assign(static_cast<std::size_t>(axes), false);
        for (Eigen::Index row = 0; row < axes; ++row) {
            const AxisLaw& law =
                model_.connections[static_cast<std::size_t>(row / 3)].axis[static_cast<std::size_t>(row % 3)];
            forces_.row(row) =
                calcAxisForce(open_, law, static_cast<int>(row / 3), static_cast<int>(row % 3)).transpose();
            const AxisForce force(law);
            rest_tangent_[row] = force.calcStaticStiffness(0);
            for (Eigen::Index k = 0; k < tangent_.cols(); ++k) {
                tangent_(row, k) = force.calcStaticStiffness(open_.q(row, k));
                if (tangent_(row, k) != rest_tangent_[row])
                    touched_[static_cast<std::size_t>(row)] = in_contact_ = true;
            }
        }
        for (Eigen::Index row = 0; row < axes; ++row) {
            const Vector6 d = calcAxisDirection(model_, static_cast<int>(row / 3), static_cast<int>(row % 3));
            Eigen::MatrixXcd products(12, spectra_.binCount()), white(12, spectra_.binCount());
            for (Eigen::Index b = 0; b < products.cols(); ++b) {
                products.col(b) = calcProduct(b, d, d);
                white.col(b) = noise_->whitener(b).leftCols<6>() * d.cast<Complex>();
            }
            if (!with_bracket_) white.bottomRows(6).setZero();
            axis_products_.push_back(std::move(products));
            axis_white_.push_back(std::move(white));
        }
    }

    const EquationSpectra& spectra() const { return spectra_; }
    const OpenLoopRun& run() const { return open_; }
    bool hasBracket() const { return with_bracket_; }
    const std::shared_ptr<const RunNoise>& noise() const { return noise_; }

    /// Whitened residual: 12 x bins, mount above bracket.
    const Eigen::MatrixXcd& residual() const { return white_; }

    Eigen::MatrixXcd whiten(const Eigen::MatrixXcd& mount, const Eigen::MatrixXcd& bracket) const {
        Eigen::MatrixXcd white = Eigen::MatrixXcd::Zero(12, spectra_.binCount());
        for (Eigen::Index b = 0; b < white.cols(); ++b) {
            const Matrix12c& L = noise_->whitener(b);
            Eigen::Map<Vector12c> values(&white(0, b));
            if (mount.size() > 0) values += L.leftCols<6>().lazyProduct(Eigen::Map<const Vector6c>(&mount(0, b)));
            if (bracket.size() > 0)
                values.tail<6>() += L.bottomRightCorner<6, 6>().lazyProduct(Eigen::Map<const Vector6c>(&bracket(0, b)));
        }
        if (!with_bracket_) white.bottomRows(6).setZero();
        return white;
    }

    /// Spectra of a wrench of the mount's equation, the slow motion following it.
    Eigen::MatrixXcd transformMount(const Eigen::MatrixXd& wrench) const {
        return spectra_.transform(slow_ ? slow_->balance(wrench) : wrench);
    }

    /// Whitened: the force's spectrum along the whitened direction of its axis.
    /// @param[out] burst what noise of the displacement in contact makes of the column's product with the residual
    Eigen::MatrixXcd calcLawColumn(const TestState& from, const TestState& to, int connection, int axis, double step,
                                   Eigen::VectorXd& burst) const {
        const auto c = static_cast<std::size_t>(connection), a = static_cast<std::size_t>(axis);
        const Eigen::VectorXd change = (calcAxisForce(open_, to.model.connections[c].axis[a], connection, axis) -
                                        calcAxisForce(open_, from.model.connections[c].axis[a], connection, axis)) /
                                       step;
        if (change.isZero(0.0)) return {};
        const Eigen::MatrixXcd spectrum = spectra_.transform(change.transpose());
        Eigen::MatrixXcd white = axis_white_[3 * c + a];
        for (Eigen::Index b = 0; b < white.cols(); ++b) white.col(b) *= spectrum(0, b);
        burst = calcBurst(spectrum.row(0).transpose(), 3 * c + a);
        if (slow_) {
            const Vector6 d = calcAxisDirection(model_, connection, axis);
            white -= whiten(spectra_.transform(slow_->calcForces(slow_->solve(change, d))), {});
        }
        return white;
    }

    /// The noise's covariance spreads evenly what a stop's stiffness makes of the displacement's noise; it comes in the
    /// instants of contact, where the columns of that stop have all they have. At each of those instants: the column's
    /// weight there times the deviation of the noise beyond the even one.
    Eigen::VectorXd calcBurst(const Eigen::VectorXcd& spectrum, std::size_t row) const {
        const auto axis = static_cast<Eigen::Index>(row);
        if (touched_[row] == 0) return {};
        Eigen::VectorXcd weighted(spectrum.size());
        for (Eigen::Index b = 0; b < spectrum.size(); ++b)
            weighted[b] = axis_white_[row].col(b).squaredNorm() * spectrum[b];
        const Eigen::VectorXd series = spectra_.calcSeries(weighted);
        const Eigen::ArrayXd stop = tangent_.row(axis).transpose().array() - rest_tangent_[axis];
        const Eigen::ArrayXd beyond = (stop.square() - stop.square().mean()).max(0.0);
        std::vector<Eigen::Index> inside;
        for (Eigen::Index k = 0; k < beyond.size(); ++k)
            if (beyond[k] > 0) inside.push_back(k);
        return (series.array() * open_.taper.array() * (noise_->contactVariance(row) * beyond).sqrt())(inside);
    }

    /// A change dM of the mass matrix, or of the spin.
    void calcBodyColumn(const TestState& to, double step, Eigen::MatrixXcd& mount, Eigen::MatrixXcd& bracket) const {
        const Eigen::MatrixXd change = (calcDemand(open_, to.model.body, to.model.gravity) - demand_) / step;
        mount = transformMount(change);
        if (!with_bracket_) return;
        const Eigen::MatrixXcd plain = spectra_.transform(change);
        bracket.resize(6, plain.cols());
        for (Eigen::Index b = 0; b < plain.cols(); ++b) bracket.col(b) = -(noise_->receptance(b) * plain.col(b));
    }

    /// The connection's laws act where it is: relative displacement and lever both move.
    Eigen::MatrixXcd calcPositionColumn(int connection, int axis) const {
        const Eigen::Vector3d e = Eigen::Vector3d::Unit(axis);
        const auto& laws = model_.connections[static_cast<std::size_t>(connection)].axis;
        Eigen::MatrixXd wrench = Eigen::MatrixXd::Zero(6, open_.sampleCount());
        Vector6 d[3];
        for (int a = 0; a < 3; ++a) d[a] = calcAxisDirection(model_, connection, a);
        for (Eigen::Index k = 0; k < wrench.cols(); ++k) {
            const Eigen::Vector3d moved = (open_.mobile.theta.col(k) - open_.fixed.theta.col(k)).cross(e);
            const Eigen::Vector3d moving = (open_.mobile.w.col(k) - open_.fixed.w.col(k)).cross(e);
            Eigen::Vector3d force;
            for (int a = 0; a < 3; ++a) {
                const Eigen::Index row = 3 * connection + a;
                force[a] = forces_(row, k);
                wrench.col(k) +=
                    d[a] * (tangent_(row, k) * moved[a] + laws[static_cast<std::size_t>(a)].damping * moving[a]);
            }
            wrench.col(k).tail<3>() += e.cross(force);
        }
        return transformMount(wrench);
    }

    Eigen::MatrixXcd calcModeColumn(int mode, int which) const {
        const BracketMode& own = model_.bracket[static_cast<std::size_t>(mode)];
        const Vector6 shape = calcShape(own);
        const auto participation = calcParticipation(own);
        Eigen::MatrixXcd column(6, spectra_.binCount());
        const double w0 = kTwoPi * own.frequency;
        for (Eigen::Index b = 0; b < column.cols(); ++b) {
            const double w = spectra_.angular(b);
            const Complex h = calcModalResponse(own, w);
            const Complex force = participation.cast<Complex>().dot(inputs_.col(b));
            const Complex dh = which == 0 ? -h * h * Complex(2 * w0, 2 * own.damping_ratio * w) * kTwoPi
                                          : -h * h * Complex(0, 2 * w0 * w);
            column.col(b) = shape.cast<Complex>() * (dh * force);
        }
        return column;
    }

    Eigen::MatrixXcd calcShapeColumn(int mode, int entry) const {
        const BracketMode& own = model_.bracket[static_cast<std::size_t>(mode)];
        const Vector6 shape = calcShape(own);
        const auto participation = calcParticipation(own);
        Eigen::MatrixXcd column(6, spectra_.binCount());
        for (Eigen::Index b = 0; b < column.cols(); ++b) {
            const Complex h = calcModalResponse(own, spectra_.angular(b));
            column.col(b) = shape.cast<Complex>() * (h * inputs_(entry, b));
            if (entry < 6) column(entry, b) += h * participation.cast<Complex>().dot(inputs_.col(b));
        }
        return column;
    }

    /// What the load at the bracket (or on the mobile part) with spectra `load` (3 x bins) adds.
    void calcLoadColumn(const Eigen::MatrixXcd& load, Eigen::MatrixXcd& bracket) const {
        bracket = Eigen::MatrixXcd::Zero(6, spectra_.binCount());
        for (Eigen::Index b = 0; b < bracket.cols(); ++b)
            for (const auto& own : model_.bracket) {
                const Complex force = own.load_translation.cast<Complex>().dot(load.col(b));
                bracket.col(b) +=
                    calcShape(own).cast<Complex>() * (calcModalResponse(own, spectra_.angular(b)) * force);
            }
    }
    Eigen::MatrixXcd calcLoadSpectra() const { return inputs_.middleRows(6, 3); }
    /// @param[out] share of the run's time that the hat covers
    Eigen::MatrixXcd calcHatSpectra(const LoadHat& hat, double& share) const {
        Eigen::MatrixXd load = open_.load;
        for (Eigen::Index k = 0; k < load.cols(); ++k) {
            const double f = k < open_.swept.size() ? open_.swept[k] : std::nan("");
            double weight = 0;
            if (f > hat.below && f <= hat.at) weight = (f - hat.below) / (hat.at - hat.below);
            if (f > hat.at && f < hat.above) weight = (hat.above - f) / (hat.above - hat.at);
            load.col(k) *= weight;
            share += weight / static_cast<double>(load.cols());
        }
        return spectra_.transform(load);
    }

    /// Response of a mode that was moving when the recording began: cosine and sine of its free decay.
    Eigen::MatrixXcd calcTransient(int mode, bool sine) const {
        const BracketMode& own = model_.bracket[static_cast<std::size_t>(mode)];
        Eigen::MatrixXd motion(6, open_.sampleCount());
        const double w = kTwoPi * own.frequency;
        for (Eigen::Index k = 0; k < motion.cols(); ++k) {
            const double t = open_.time[k];
            motion.col(k) =
                calcShape(own) * (std::exp(-own.damping_ratio * w * t) * (sine ? std::sin(w * t) : std::cos(w * t)));
        }
        return spectra_.transform(motion);
    }

    /// A motion of one part that a sensor's error makes: its series (6 x samples) and spectra.
    void calcMotionColumn(Part part, const Eigen::MatrixXd& series, const Eigen::MatrixXcd& spectra,
                          Eigen::MatrixXcd& mount, Eigen::MatrixXcd& bracket) const {
        const bool mobile = part == Part::mobile;
        const double sign = mobile ? 1.0 : -1.0;
        mount.resize(6, spectra.cols());
        if (with_bracket_) bracket.resize(6, spectra.cols());
        for (Eigen::Index b = 0; b < spectra.cols(); ++b) {
            const double w = spectra_.angular(b);
            const Vector6c x = spectra.col(b);
            Vector6c force = sign * (K_.cast<Complex>() * x + Complex(0, w) * (C_.cast<Complex>() * x));
            if (mobile) {
                const Vector6c inertia = w * w * (M_.cast<Complex>() * x);
                force -= inertia;
                if (with_bracket_) bracket.col(b) = noise_->receptance(b) * inertia;
            } else if (with_bracket_) {
                bracket.col(b) = -x;
            }
            mount.col(b) = force;
        }
        if (!in_contact_) return;
        Eigen::MatrixXd contact = Eigen::MatrixXd::Zero(6, series.cols());
        for (Eigen::Index row = 0; row < tangent_.rows(); ++row) {
            if (!touched_[static_cast<std::size_t>(row)]) continue;
            const Vector6 d = calcAxisDirection(model_, static_cast<int>(row / 3), static_cast<int>(row % 3));
            const Eigen::RowVectorXd q = d.transpose() * series;
            contact += d * (sign * (tangent_.row(row).array() - rest_tangent_[row]) * q.array()).matrix();
        }
        mount += transformMount(contact);
    }
    bool inContact() const { return in_contact_; }
    const MotionNoise& motionNoise() const { return motion_noise_; }

    /// What the noise of the regressors adds to the slope of a number in the mean, in each of the whitened rows: the
    /// diagonal of 2 Re L⁻¹ ∂A P Aᴴ L⁻ᴴ, summed over the bins.
    using Slope = Eigen::Matrix<double, 12, kNoiseBands>;
    /// Of a change of an axis' law: by its equivalent dynamic stiffness.
    Slope calcLawSlope(const TestState& from, const TestState& to, int connection, int axis, double step) const {
        const auto c = static_cast<std::size_t>(connection), a = static_cast<std::size_t>(axis);
        const Eigen::Index row = 3 * connection + axis;
        const Eigen::VectorXcd change = (calcDynamicStiffness(to.model.connections[c].axis[a], row) -
                                         calcDynamicStiffness(from.model.connections[c].axis[a], row)) /
                                        step;
        Slope sum = Slope::Zero();
        for (Eigen::Index b = 0; b < change.size(); ++b)
            sum.col(bandOf(b)) += 2 * (axis_products_[static_cast<std::size_t>(row)].col(b) * change[b]).real();
        return sum;
    }
    Slope calcPositionSlope(int connection, int moved) const {
        Slope sum = Slope::Zero();
        const Eigen::Vector3d e = Eigen::Vector3d::Unit(moved);
        const auto& laws = model_.connections[static_cast<std::size_t>(connection)].axis;
        for (int a = 0; a < 3; ++a) {
            const Vector6 d = calcAxisDirection(model_, connection, a);
            Vector6 change;
            change << Eigen::Vector3d::Zero(), e.cross(Eigen::Vector3d::Unit(a));
            const auto& law = laws[static_cast<std::size_t>(a)];
            for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
                const Complex stiffness(law.stiffness, spectra_.angular(b) * law.damping);
                sum.col(bandOf(b)) += 2 * (stiffness * (calcProduct(b, change, d) + calcProduct(b, d, change))).real();
            }
        }
        return sum;
    }
    /// Of a change of the mass matrix, or of what multiplies the angular velocity in the moments.
    Slope calcInertiaSlope(const Matrix6& dM, const Eigen::Matrix3d& gyroscopic) const {
        Slope sum = Slope::Zero();
        for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
            const double w = spectra_.angular(b);
            Eigen::Matrix<Complex, 12, 6> change;
            change << -w * w * dM.cast<Complex>(), w * w * noise_->receptance(b) * dM.cast<Complex>();
            change.block<3, 3>(3, 3) += Complex(0, w) * gyroscopic.cast<Complex>();
            const Eigen::Matrix<Complex, 12, 6> left = noise_->whitener(b) * change;
            const Eigen::Matrix<Complex, 12, 6> right = noise_->regressorNoise(b).topRows<6>().transpose();
            for (int c = 0; c < 6; ++c) sum.col(bandOf(b)) += 2 * left.col(c).cwiseProduct(right.col(c)).real();
        }
        return sum;
    }
    /// Of a mode: at each bin its change is Σ a cᵀ of the interface's receptance and Σ a c_Lᵀ of the load's.
    /// @param which 0 frequency, 1 damping ratio, 2 + entry of the shape
    Slope calcModeSlope(int mode, int which) const {
        const BracketMode& own = model_.bracket[static_cast<std::size_t>(mode)];
        const Vector6 shape = calcShape(own);
        const Eigen::Vector3d load = own.load_translation;
        Slope sum = Slope::Zero();
        const auto addOuter = [&](Eigen::Index b, Complex factor, const Vector6& a, const Vector6& c,
                                  const Eigen::Vector3d& c_load) {
            const Vector12c left = noise_->whitener(b).rightCols<6>() * a.cast<Complex>();
            const double w2 = spectra_.angular(b) * spectra_.angular(b);
            const Vector6 inertia = w2 * (M_ * c);
            Vector12c right = noise_->regressorNoise(b).topRows<6>().transpose() * inertia.cast<Complex>();
            right += noise_->loadNoise(b).transpose() * c_load.cast<Complex>();
            sum.col(bandOf(b)) += 2 * (factor * left.cwiseProduct(right)).real();
        };
        const double w0 = kTwoPi * own.frequency;
        for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
            const double w = spectra_.angular(b);
            const Complex h = calcModalResponse(own, w);
            if (which == 0)
                addOuter(b, -h * h * Complex(2 * w0, 2 * own.damping_ratio * w) * kTwoPi, shape, shape, load);
            else if (which == 1)
                addOuter(b, -h * h * Complex(0, 2 * w0 * w), shape, shape, load);
            else if (which < 8) {
                const Vector6 e = Vector6::Unit(which - 2);
                addOuter(b, h, e, shape, load);
                addOuter(b, h, shape, e, Eigen::Vector3d::Zero());
            } else {
                addOuter(b, h, shape, Vector6::Zero(), Eigen::Vector3d::Unit(which - 8));
            }
        }
        return sum;
    }
    Slope calcLoadSlope() const {
        Slope sum = Slope::Zero();
        for (const auto& own : model_.bracket) {
            const Vector6 shape = calcShape(own);
            for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
                const Vector12c left = noise_->whitener(b).rightCols<6>() * shape.cast<Complex>();
                const Vector12c right = noise_->loadNoise(b).transpose() * own.load_translation.cast<Complex>();
                sum.col(bandOf(b)) +=
                    2 * (calcModalResponse(own, spectra_.angular(b)) * left.cwiseProduct(right)).real();
            }
        }
        return sum;
    }
    /// Of a sensor's error: each channel's change follows from the motion and moves it.
    Slope calcSensorSlope(const SensorEffect& effect) const {
        Slope sum = Slope::Zero();
        const Eigen::Index first = effect.part == Part::mobile ? 0 : 6;
        for (const auto& change : effect.changes)
            for (Eigen::Index b = 0; b < spectra_.binCount(); ++b) {
                const Vector12c left =
                    noise_->whitenedMotion(b).middleCols<6>(first) * change.direction.cast<Complex>();
                const Vector12c right =
                    noise_->regressorNoise(b).middleRows<6>(first).transpose() * change.signal.cast<Complex>();
                sum.col(bandOf(b)) -= 2 * (change.weight[b] * left.cwiseProduct(right)).real();
            }
        return sum;
    }
    Eigen::MatrixXcd whitenDirection(const Vector6& d) const {
        Eigen::MatrixXcd white(6, spectra_.binCount());
        for (Eigen::Index b = 0; b < white.cols(); ++b)
            white.col(b) = noise_->whitener(b).topLeftCorner<6, 6>() * d.cast<Complex>();
        return white;
    }

    /// Share of the mount residual's power that lies within contact, tapered.
    double calcContactShare() const {
        double inside = 0, all = 0;
        for (Eigen::Index k = 0; k < mount_series_.cols(); ++k) {
            const double power = open_.taper[k] * mount_series_.col(k).head<3>().squaredNorm();
            bool contact = false;
            for (Eigen::Index row = 0; row < tangent_.rows() && !contact; ++row)
                contact = tangent_(row, k) != rest_tangent_[row];
            all += power;
            if (contact) inside += power;
        }
        return all > 0 ? inside / all : 0;
    }

private:
    /// (L⁻¹ left) ⊙ (right · U): of a term left rightᵀ of the dynamic stiffness between the parts.
    Vector12c calcProduct(Eigen::Index b, const Vector6& left, const Vector6& right) const {
        const Matrix12c& U = noise_->regressorNoise(b);
        const Vector12c l = noise_->whitener(b).leftCols<6>() * left.cast<Complex>();
        const Vector12c r = (U.topRows<6>() - U.bottomRows<6>()).transpose() * right.cast<Complex>();
        return l.cwiseProduct(r);
    }
    /// Of the noise's level, which each has to itself.
    Eigen::Index bandOf(Eigen::Index b) const { return b * kNoiseBands / spectra_.binCount(); }

    /// What small motion about the measured one meets in the mean, at each bin. Dry friction is left out: it takes a
    /// velocity without noise.
    Eigen::VectorXcd calcDynamicStiffness(AxisLaw law, Eigen::Index row) const {
        law.friction.reset();
        const AxisForce force(law);
        const std::vector<double> z(static_cast<std::size_t>(force.stateCount()) + 1, 0.0);
        constexpr int kEvery = 4;  // samples; the mean of thousands needs no more
        double stiffness = 0, damping = 0, count = 0;
        for (int k = 0; k < open_.sampleCount(); k += kEvery) {
            stiffness += force.calcStiffness(open_.q(row, k), open_.v(row, k), open_.time[k], z.data());
            damping += force.calcDamping(open_.q(row, k), open_.v(row, k), open_.time[k], z.data());
            ++count;
        }
        Eigen::VectorXcd result(spectra_.binCount());
        for (Eigen::Index b = 0; b < result.size(); ++b) {
            const double w = spectra_.angular(b);
            result[b] = Complex(stiffness / count, w * damping / count);
            for (const auto& branch : force.branches())
                result[b] -= branch.stiffness / Complex(1, w * branch.time_constant);
        }
        return result;
    }

    OpenLoopRun makeRun() const {
        OpenLoopRun run = makeOpenLoopRun(test_.motion, model_, test_.band, test_.swept.hertz);
        followSlowMotion(run, model_);
        return run;
    }

    void calcResiduals() {
        mount_series_ = calcMountResidual(open_, model_);
        Eigen::MatrixXcd bracket;
        if (with_bracket_) {
            Eigen::MatrixXd series = bracket_.calcResidual(model_);
            series.colwise() -= series.rowwise().mean().eval();
            bracket = spectra_.transform(series);
        }
        white_ = whiten(transformMount(mount_series_), bracket);
    }

    const TestRun& test_;
    const MountModel& model_;
    OpenLoopRun open_;
    std::unique_ptr<SlowBalance> slow_;
    bool with_bracket_;
    EquationSpectra spectra_;
    MotionNoise motion_noise_;
    std::shared_ptr<const RunNoise> noise_;
    BracketEquation bracket_;
    Matrix6 K_, C_, M_;
    Eigen::MatrixXd demand_, mount_series_, forces_, tangent_;
    Eigen::VectorXd rest_tangent_;
    std::vector<char> touched_;
    bool in_contact_ = false;
    std::vector<Eigen::MatrixXcd> axis_products_, axis_white_;
    Eigen::MatrixXcd inputs_, white_;
};

/// Real values of six complex rows: real parts, then imaginary parts, of each bin.
Eigen::VectorXf unfold(const Eigen::Ref<const Eigen::MatrixXcd>& rows) {
    const Eigen::MatrixXd real = kRoot2 * rows.real(), imaginary = kRoot2 * rows.imag();
    Eigen::VectorXf values(2 * rows.size());
    values << real.reshaped().cast<float>(), imaginary.reshaped().cast<float>();
    return values;
}

/// Columns of one block and their products.
class BlockColumns {
public:
    BlockColumns(Eigen::Index rows, Eigen::Index columns)
        : J_(Eigen::MatrixXf::Zero(rows, columns)), used_(static_cast<std::size_t>(columns), false) {}
    void set(Eigen::Index column, const Eigen::VectorXf& values) {
        J_.col(column) = values;
        used_[static_cast<std::size_t>(column)] = true;
    }
    /// @param residual as the columns
    BlockInformation calcInformation(const Eigen::VectorXf& residual) const {
        std::vector<Eigen::Index> used;
        for (std::size_t c = 0; c < used_.size(); ++c)
            if (used_[c]) used.push_back(static_cast<Eigen::Index>(c));
        const auto count = static_cast<Eigen::Index>(used.size());
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
        Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
        BlockInformation result;
        constexpr Eigen::Index kChunk = 1024;
        for (Eigen::Index first = 0; first < J_.rows(); first += kChunk) {
            const Eigen::Index rows = std::min(kChunk, J_.rows() - first);
            const Eigen::MatrixXd chunk = J_.middleRows(first, rows)(Eigen::all, used).cast<double>();
            const Eigen::VectorXd r = residual.segment(first, rows).cast<double>();
            A.selfadjointView<Eigen::Lower>().rankUpdate(chunk.transpose());
            b.noalias() += chunk.transpose() * r;
            result.chi_squared += r.squaredNorm();
        }
        A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
        result.A = Eigen::MatrixXd::Zero(J_.cols(), J_.cols());
        result.b = Eigen::VectorXd::Zero(J_.cols());
        result.noise_slopes = Eigen::MatrixXd::Zero(J_.cols(), 0);
        result.A(used, used) = A;
        result.b(used) = b;
        result.count = static_cast<double>(J_.rows());
        return result;
    }

private:
    Eigen::MatrixXf J_;
    std::vector<bool> used_;
};

/// Takes the last `count` unknowns, which belong to this run alone, out of an information.
void marginalise(BlockInformation& block, Eigen::Index count, double precision) {
    const Eigen::Index kept = block.b.size() - count;
    if (count == 0) return;
    Eigen::MatrixXd own = block.A.bottomRightCorner(count, count);
    own.diagonal().array() += precision;
    const Eigen::LDLT<Eigen::MatrixXd> factor(own);
    const Eigen::MatrixXd cross = block.A.topRightCorner(kept, count);
    const Eigen::VectorXd right = block.b.tail(count);
    const Eigen::VectorXd solved = factor.solve(right);
    block.chi_squared -= right.dot(solved);
    const Eigen::VectorXd b = block.b.head(kept) - cross * solved;
    const Eigen::MatrixXd A = block.A.topLeftCorner(kept, kept) - cross * factor.solve(cross.transpose());
    block.A = A;
    block.b = b;
}

class ColumnMaker {
public:
    ColumnMaker(const Lineariser& at, const ColumnSet& columns, const TestState& state, Eigen::Index extra)
        : at_(at),
          columns_(columns),
          state_(state),
          mount_(12 * at.spectra().binCount(), columns.size() + extra),
          bracket_(at.hasBracket() ? 12 * at.spectra().binCount() : 0, columns.size() + extra),
          slopes_(static_cast<std::size_t>(columns.size() + extra), Lineariser::Slope::Zero()) {}

    void add(Eigen::Index column, const Eigen::MatrixXcd& mount, const Eigen::MatrixXcd& bracket) {
        if (mount.size() == 0 && bracket.size() == 0) return;
        addWhite(column, at_.whiten(mount, bracket), mount.size() > 0);
    }
    void addWhite(Eigen::Index column, const Eigen::MatrixXcd& white, bool mount = true) {
        if (white.size() == 0) return;
        if (mount) mount_.set(column, unfold(white.topRows(6)));
        if (at_.hasBracket()) bracket_.set(column, unfold(white.bottomRows(6)));
    }

    void addLaw(Eigen::Index column, const Unknown& row, const TestState& from, const TestState& to, double step) {
        Eigen::VectorXd burst;
        addWhite(column, at_.calcLawColumn(from, to, row.first, row.second, step, burst));
        if (burst.size() > 0) bursts_[3 * row.first + row.second].emplace_back(column, std::move(burst));
    }

    /// Of columns of the same axis, whose bursts are the same.
    Eigen::MatrixXd calcScatter(Eigen::Index size) const {
        Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(size, size);
        for (const auto& [axis, members] : bursts_)
            for (const auto& [i, a] : members)
                for (const auto& [j, b] : members) scatter(i, j) = a.dot(b);
        return scatter;
    }

    void makeTable() {
        const UnknownTable& table = *columns_.table;
        TestState moved = state_;
        for (std::size_t i = 0; i < table.size(); ++i) {
            if (!columns_.wants(i)) continue;
            const Unknown& row = table[i];
            const auto column = static_cast<Eigen::Index>(i);
            Eigen::MatrixXcd mount, bracket;
            switch (row.kind) {
                case UnknownKind::law: {
                    const double value = row.get(state_);
                    row.set(moved, value + row.step);
                    addLaw(column, row, state_, moved, row.step);
                    slopes_[static_cast<std::size_t>(column)] =
                        at_.calcLawSlope(state_, moved, row.first, row.second, row.step);
                    resetLaw(moved, row);
                    break;
                }
                case UnknownKind::position:
                    mount = at_.calcPositionColumn(row.first, row.second);
                    slopes_[static_cast<std::size_t>(column)] = at_.calcPositionSlope(row.first, row.second);
                    break;
                case UnknownKind::body: {
                    row.set(moved, row.get(state_) + row.step);
                    at_.calcBodyColumn(moved, row.step, mount, bracket);
                    slopes_[static_cast<std::size_t>(column)] = at_.calcInertiaSlope(
                        (calcMassMatrix(moved.model.body) - calcMassMatrix(state_.model.body)) / row.step,
                        crossMatrix((state_.model.body.spin - moved.model.body.spin) / row.step));
                    moved.model.body = state_.model.body;
                    break;
                }
                case UnknownKind::mode:
                    if (!at_.hasBracket()) break;
                    bracket = at_.calcModeColumn(row.first, row.second);
                    slopes_[static_cast<std::size_t>(column)] = at_.calcModeSlope(row.first, row.second);
                    break;
                case UnknownKind::shape:
                    if (!at_.hasBracket()) break;
                    bracket = at_.calcShapeColumn(row.first, row.second);
                    slopes_[static_cast<std::size_t>(column)] = at_.calcModeSlope(row.first, 2 + row.second);
                    break;
                case UnknownKind::load:
                    if (at_.hasBracket() && at_.run().load.cols() > 0)
                        at_.calcLoadColumn(at_.calcLoadSpectra() / row.get(state_), bracket);
                    if (bracket.size() > 0)
                        slopes_[static_cast<std::size_t>(column)] = at_.calcLoadSlope() / row.get(state_);
                    break;
                default:
                    continue;  // sensors
            }
            add(column, mount, bracket);
        }
    }

    void makeProbes() {
        const UnknownTable& table = *columns_.table;
        for (std::size_t i = 0; i < columns_.probes.size(); ++i) {
            if (!columns_.wants(table.size() + i)) continue;
            const Probe& probe = columns_.probes[i];
            const Unknown& row = table[static_cast<std::size_t>(probe.parameter)];
            TestState from = state_;
            for (const auto& [other, value] : probe.preset) table[static_cast<std::size_t>(other)].set(from, value);
            TestState to = from;
            row.set(to, row.get(from) + probe.step);
            const auto column = static_cast<Eigen::Index>(table.size() + i);
            addLaw(column, row, from, to, probe.step);
            slopes_[static_cast<std::size_t>(column)] = at_.calcLawSlope(from, to, row.first, row.second, probe.step);
        }
        if (!at_.hasBracket() || at_.run().load.cols() == 0) return;
        for (std::size_t i = 0; i < columns_.hats.size(); ++i) {
            if (!columns_.wants(table.size() + columns_.probes.size() + i)) continue;
            Eigen::MatrixXcd bracket;
            double share = 0;
            at_.calcLoadColumn(at_.calcHatSpectra(columns_.hats[i], share), bracket);
            const auto column = static_cast<Eigen::Index>(table.size() + columns_.probes.size() + i);
            add(column, {}, bracket);
            slopes_[static_cast<std::size_t>(column)] = share * at_.calcLoadSlope();
        }
    }

    void setSlope(Eigen::Index column, const Lineariser::Slope& slope) {
        slopes_[static_cast<std::size_t>(column)] = slope;
    }
    BlockColumns& mount() { return mount_; }
    BlockColumns& bracket() { return bracket_; }
    /// Of the mount's rows, or of the bracket's.
    Eigen::MatrixXd calcNoiseSlopes(bool bracket) const {
        Eigen::MatrixXd result(static_cast<Eigen::Index>(slopes_.size()), kNoiseBands);
        for (std::size_t c = 0; c < slopes_.size(); ++c)
            result.row(static_cast<Eigen::Index>(c)) = slopes_[c].middleRows<6>(bracket ? 6 : 0).colwise().sum();
        return result;
    }

private:
    void resetLaw(TestState& moved, const Unknown& row) const {
        const auto c = static_cast<std::size_t>(row.first), a = static_cast<std::size_t>(row.second);
        moved.model.connections[c].axis[a] = state_.model.connections[c].axis[a];
    }

    const Lineariser& at_;
    const ColumnSet& columns_;
    const TestState& state_;
    BlockColumns mount_, bracket_;
    std::vector<Lineariser::Slope> slopes_;
    std::map<int, std::vector<std::pair<Eigen::Index, Eigen::VectorXd>>> bursts_;
};

}  // namespace

LinearisedRun linearise(const TestRun& run, const SensorLayout& layout, const ColumnSet& columns,
                        const TestState& state) {
    Lineariser at(run, layout, state, nullptr);
    at.prepareColumns();
    const auto modes = at.hasBracket() ? static_cast<int>(state.model.bracket.size()) : 0;
    const Eigen::Index extra = 2 * modes;
    ColumnMaker maker(at, columns, state, extra);
    maker.makeTable();
    maker.makeProbes();
    for (int j = 0; j < modes; ++j)
        for (int sine = 0; sine < 2; ++sine)
            maker.add(columns.size() + 2 * j + sine, {}, at.calcTransient(j, sine != 0));
    LinearisedRun result;
    result.noise = at.noise();
    const SensorColumns sensors(run, layout, at.run(), at.spectra(), at.motionNoise());
    for (std::size_t i = 0; i < columns.table->size(); ++i) {
        if (!columns.wants(i)) continue;
        const SensorEffect effect = sensors.calcEffect((*columns.table)[i], at.inContact());
        if (effect.spectra.size() == 0) continue;
        Eigen::MatrixXcd mount, bracket;
        at.calcMotionColumn(effect.part, effect.series, effect.spectra, mount, bracket);
        maker.add(static_cast<Eigen::Index>(i), mount, bracket);
        maker.setSlope(static_cast<Eigen::Index>(i), at.calcSensorSlope(effect));
    }
    auto& mount = result.information[static_cast<std::size_t>(Block::mount)];
    mount = maker.mount().calcInformation(unfold(at.residual().topRows(6)));
    mount.A = mount.A.topLeftCorner(columns.size(), columns.size()).eval();
    mount.b = mount.b.head(columns.size()).eval();
    mount.noise_slopes = maker.calcNoiseSlopes(false).topRows(columns.size());
    mount.scatter = maker.calcScatter(columns.size());
    if (at.hasBracket()) {
        auto& bracket = result.information[static_cast<std::size_t>(Block::bracket)];
        bracket = maker.bracket().calcInformation(unfold(at.residual().bottomRows(6)));
        Eigen::MatrixXd fixed = at.run().fixed.p;
        fixed.colwise() -= fixed.rowwise().mean().eval();
        double largest = 0;
        for (const auto& mode : state.model.bracket) largest = std::max(largest, mode.translation.norm());
        const double amplitude = fixed.cwiseAbs().maxCoeff() / std::max(largest, 1e-300);
        marginalise(bracket, extra, 1 / (amplitude * amplitude));
        bracket.noise_slopes = maker.calcNoiseSlopes(true).topRows(columns.size());
    }
    for (const Part part : {Part::mobile, Part::fixed})
        result.information[static_cast<std::size_t>(part == Part::mobile ? Block::mobile_sensors
                                                                         : Block::fixed_sensors)] =
            sensors.calcInformation(part, *columns.table, columns.size());
    result.mount_residual = at.residual().topRows(6);
    for (std::size_t c = 0; c < state.model.connections.size(); ++c)
        for (int a = 0; a < 3; ++a)
            result.axis_directions.push_back(
                at.whitenDirection(calcAxisDirection(state.model, static_cast<int>(c), a)));
    result.frequency.resize(at.spectra().binCount());
    for (Eigen::Index b = 0; b < result.frequency.size(); ++b) result.frequency[b] = at.spectra().frequency(b);
    result.contact_share = at.calcContactShare();
    return result;
}

Information calcMisfit(const TestRun& run, const SensorLayout& layout, const TestState& state,
                       const std::shared_ptr<const RunNoise>& noise) {
    const Lineariser at(run, layout, state, noise);
    Information result;
    const auto measure = [&](Block block, const Eigen::MatrixXcd& rows) {
        auto& own = result[static_cast<std::size_t>(block)];
        own.A.resize(0, 0);
        own.b.resize(0);
        own.noise_slopes.resize(0, 0);
        own.chi_squared = 2 * rows.squaredNorm();
        own.count = 2 * static_cast<double>(rows.size());
    };
    measure(Block::mount, at.residual().topRows(6));
    if (at.hasBracket()) measure(Block::bracket, at.residual().bottomRows(6));
    const SensorColumns sensors(run, layout, at.run(), at.spectra(), at.motionNoise());
    for (const Part part : {Part::mobile, Part::fixed})
        result[static_cast<std::size_t>(part == Part::mobile ? Block::mobile_sensors : Block::fixed_sensors)] =
            sensors.calcInformation(part, {}, 0);
    return result;
}

}  // namespace wems::identify
