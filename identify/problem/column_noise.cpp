#include "identify/problem/column_noise.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <memory>
#include <utility>

#include "identify/problem/bracket_equation.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/axis_law.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using Complex = std::complex<double>;
using Vector12c = Eigen::Matrix<Complex, 12, 1>;
using Vector15 = Eigen::Matrix<double, 15, 1>;

// Bins at which slopes are taken, at most twice as many: noise and whitener follow spectra that are smoothed over a
// fifth of the lowest excited frequency, and a resonance of one percent of damping at the middle of the band is a
// hundredth of it wide: ten of these bins.
constexpr Eigen::Index kSlopeBins = 1024;

Vector15 relative(const Vector6& d) {
    Vector15 right = Vector15::Zero();
    right.head<6>() = d;
    right.segment<6>(6) = -d;
    return right;
}

}  // namespace

ColumnNoise::ColumnNoise(const OpenLoopRun& run, const MountModel& model, const EquationSpectra& spectra,
                         const RunNoise& noise, const Eigen::MatrixXcd& residual)
    : open_(run),
      model_(model),
      spectra_(spectra),
      noise_(&noise),
      residual_(residual),
      M_(calcMassMatrix(model.body)) {
    const Eigen::Index bins = spectra_.binCount();
    slope_step_ = std::max<Eigen::Index>(1, bins / kSlopeBins);
    for (Eigen::Index b = 0; b < bins; b += slope_step_) {
        // The residual's square times what meets it, bin by bin: of low rank, and no 12 x 12 product is needed.
        Product product = Product::Zero();
        for (Eigen::Index k = b; k < std::min(b + slope_step_, bins); ++k) {
            const Vector12c r = residual.col(k);
            Eigen::Matrix<Complex, 15, 1> all, mount;
            all << noise_->regressorNoise(b) * r, noise_->loadNoise(b) * r;
            mount << noise_->regressorNoise(b).leftCols<6>() * r.head<6>(),
                noise_->loadNoise(b).leftCols<6>() * r.head<6>();
            product.leftCols<12>() += all * r.adjoint();
            product.rightCols<6>() += mount * r.head<6>().adjoint();
        }
        products_.push_back(product);
        for (int part = 0; part < 2; ++part) {
            const Eigen::Matrix<Complex, 12, 6> motion = noise_->whitenedMotion(b).middleCols<6>(6 * part);
            const Eigen::Matrix<Complex, 6, 18> own = product.middleRows<6>(6 * part);
            MotionProduct all;
            all << own.leftCols<12>() * motion, own.rightCols<6>() * motion.topRows<6>();
            motion_products_[part].push_back(all);
        }
    }
    for (std::size_t i = 0; !model_.bracket.empty() && i < products_.size(); ++i) {
        const Eigen::Index b = static_cast<Eigen::Index>(i) * slope_step_;
        // The whitener is lower triangular: what the bracket's equation leaves moves no row of the mount.
        mode_products_.emplace_back(calcModeInputs(b) * products_[i].leftCols<12>() *
                                    noise_->whitener(b).rightCols<6>());
    }
    for (std::size_t row = 0; row < 3 * model_.connections.size(); ++row) {
        const Vector6 d = calcAxisDirection(model_, static_cast<int>(row / 3), static_cast<int>(row % 3));
        auto& own = axis_products_.emplace_back();
        for (std::size_t i = 0; i < products_.size(); ++i) {
            const auto& whitener = noise_->whitener(static_cast<Eigen::Index>(i) * slope_step_);
            own.push_back(calcProduct(i, {whitener.leftCols<6>() * d.cast<Complex>(), relative(d)}));
        }
    }
}

ColumnNoise::LawChange ColumnNoise::calcLawChange(const TestState& from, const TestState& to, int connection, int axis,
                                                  double step) const {
    const auto c = static_cast<std::size_t>(connection), a = static_cast<std::size_t>(axis);
    const Eigen::Index row = 3 * connection + axis;
    const DynamicStiffness before = calcDynamicStiffness(open_, from.model.connections[c].axis[a], row),
                           after = calcDynamicStiffness(open_, to.model.connections[c].axis[a], row);
    Eigen::VectorXcd values(spectra_.binCount());
    for (Eigen::Index b = 0; b < values.size(); ++b)
        values[b] = (after.at(spectra_.angular(b)) - before.at(spectra_.angular(b))) / step;
    if (values.isZero(0.0)) return {connection, axis, nullptr};
    return {connection, axis, std::make_shared<const Eigen::VectorXcd>(std::move(values))};
}

ColumnNoise::Column ColumnNoise::makeLaw(const LawChange& law) const {
    const auto change = law.stiffness;
    if (!change) return {};
    const Vector6 d = calcAxisDirection(model_, law.connection, law.axis);
    return [this, change, d](Eigen::Index b) -> Terms {
        return {{(*change)[b] * (noise_->whitener(b).leftCols<6>() * d.cast<Complex>()), relative(d)}};
    };
}

ColumnNoise::Column ColumnNoise::makePosition(int connection, int moved) const {
    return [this, connection, moved](Eigen::Index b) {
        Terms terms;
        const Eigen::Vector3d e = Eigen::Vector3d::Unit(moved);
        for (int a = 0; a < 3; ++a) {
            const auto& law = model_.connections[connection].axis[a];
            const Vector6 d = calcAxisDirection(model_, connection, a);
            Vector6 change;
            change << Eigen::Vector3d::Zero(), e.cross(Eigen::Vector3d::Unit(a));
            if (change.isZero(0.0)) continue;
            const Complex stiffness(law.stiffness, spectra_.angular(b) * law.damping);
            const auto whitener = noise_->whitener(b).leftCols<6>();
            terms.push_back({stiffness * (whitener * change.cast<Complex>()), relative(d)});
            terms.push_back({stiffness * (whitener * d.cast<Complex>()), relative(change)});
        }
        return terms;
    };
}

ColumnNoise::Column ColumnNoise::makeInertia(const Matrix6& dM, const Eigen::Matrix3d& gyroscopic) const {
    return [this, dM, gyroscopic](Eigen::Index b) {
        const double w = spectra_.angular(b);
        Eigen::Matrix<Complex, 12, 6> change;
        change << -w * w * dM.cast<Complex>(), w * w * noise_->receptance(b) * dM.cast<Complex>();
        change.block<3, 3>(3, 3) += Complex(0, w) * gyroscopic.cast<Complex>();
        Terms terms;
        for (int c = 0; c < 6; ++c)
            if (!change.col(c).isZero(0.0)) terms.push_back({noise_->whitener(b) * change.col(c), Vector15::Unit(c)});
        return terms;
    };
}

std::vector<ColumnNoise::Outer> ColumnNoise::calcOuters(const ModeChange& change, Eigen::Index b) const {
    const BracketMode& own = model_.bracket[change.mode];
    const Vector6 shape = calcShape(own);
    const double w = spectra_.angular(b), w0 = kTwoPi * own.frequency;
    const Complex h = calcModalResponse(own, w);
    Eigen::Matrix<double, 9, 1> input;
    input << shape, own.load_translation;
    if (change.which == 0) return {{-h * h * Complex(2 * w0, 2 * own.damping_ratio * w) * kTwoPi, shape, input}};
    if (change.which == 1) return {{-h * h * Complex(0, 2 * w0 * w), shape, input}};
    const int entry = change.which - 2;
    if (entry >= 9) return {};  // the base's acceleration has no noise here
    const Outer by_input{h, shape, Eigen::Matrix<double, 9, 1>::Unit(entry)};
    if (entry >= 6) return {by_input};
    return {{h, Vector6::Unit(entry), input}, by_input};
}

Eigen::Matrix<double, 9, 15> ColumnNoise::calcModeInputs(Eigen::Index b) const {
    const double w = spectra_.angular(b);
    Eigen::Matrix<double, 9, 15> inputs = Eigen::Matrix<double, 9, 15>::Zero();
    inputs.topLeftCorner<6, 6>() = w * w * M_;
    // With a load point of the model's own the bracket's is not loaded.
    if (model_.load_point)
        inputs.topRightCorner<6, 3>() = calcLoadArm(*model_.load_point);
    else
        inputs.bottomRightCorner<3, 3>().setIdentity();
    return inputs;
}

ColumnNoise::Column ColumnNoise::makeMode(const ModeChange& change) const {
    return [this, change](Eigen::Index b) {
        Terms terms;
        const auto inputs = calcModeInputs(b);
        for (const Outer& outer : calcOuters(change, b))
            terms.push_back({outer.factor * (noise_->whitener(b).rightCols<6>() * outer.a.cast<Complex>()),
                             inputs.transpose() * outer.c});
        return terms;
    };
}

ColumnNoise::Column ColumnNoise::makeLoad(double factor, int axis) const {
    return [this, factor, axis](Eigen::Index b) {
        Terms terms;
        for (int a = 0; a < 3; ++a)
            if (axis == 3 || axis == a)
                terms.push_back({factor * noise_->whitenedLoad(b).col(a), Vector15::Unit(12 + a)});
        return terms;
    };
}

ColumnNoise::Column ColumnNoise::makeSensor(const SensorEffect& effect) const {
    const auto changes = std::make_shared<const std::vector<SensorEffect::ChannelChange>>(effect.changes);
    const Eigen::Index first = effect.part == Part::mobile ? 0 : 6;
    return [this, changes, first](Eigen::Index b) {
        Terms terms;
        for (const auto& change : *changes) {
            Vector15 right = Vector15::Zero();
            right.segment<6>(first) = change.signal;
            terms.push_back({-(*change.weight)[b] *
                                 (noise_->whitenedMotion(b).middleCols<6>(first) * change.direction.cast<Complex>()),
                             right});
        }
        return terms;
    };
}

Eigen::Vector2cd ColumnNoise::calcProduct(std::size_t i, const Term& term) const {
    Eigen::Matrix<Complex, 18, 1> along = Eigen::Matrix<Complex, 18, 1>::Zero();
    for (int k = 0; k < term.right.size(); ++k)  // most are zero
        if (term.right[k] != 0) along += term.right[k] * products_[i].row(k).transpose();
    const Complex all = along.head<12>().cwiseProduct(term.left).sum();
    const Complex mount = along.tail<6>().cwiseProduct(term.left.head<6>()).sum();
    return {mount, all - mount};
}

ColumnNoise::Slope ColumnNoise::calcSlope(const Column& column) const {
    Slope sum = Slope::Zero();
    if (!column) return sum;
    for (std::size_t i = 0; i < products_.size(); ++i) {
        const Eigen::Index b = static_cast<Eigen::Index>(i) * slope_step_;
        for (const Term& term : column(b)) sum.col(bandOf(b)) += 2 * calcProduct(i, term).real();
    }
    return sum;
}

ColumnNoise::Slope ColumnNoise::calcSlope(const LawChange& change) const {
    Slope sum = Slope::Zero();
    if (!change.stiffness) return sum;
    const auto& products = axis_products_[3 * static_cast<std::size_t>(change.connection) + change.axis];
    for (std::size_t i = 0; i < products.size(); ++i) {
        const Eigen::Index b = static_cast<Eigen::Index>(i) * slope_step_;
        sum.col(bandOf(b)) += 2 * ((*change.stiffness)[b] * products[i]).real();
    }
    return sum;
}

ColumnNoise::Slope ColumnNoise::calcSlope(const ModeChange& change) const {
    Slope sum = Slope::Zero();
    for (std::size_t i = 0; i < mode_products_.size(); ++i) {
        const Eigen::Index b = static_cast<Eigen::Index>(i) * slope_step_;
        for (const Outer& outer : calcOuters(change, b))
            sum(1, bandOf(b)) +=
                2 * (outer.factor * (outer.c.transpose() * (mode_products_[i] * outer.a)).value()).real();
    }
    return sum;
}

ColumnNoise::Slope ColumnNoise::calcLevels() const {
    Slope squares = Slope::Zero(), count = Slope::Zero();
    for (Eigen::Index b = 0; b < residual_.cols(); ++b) {
        squares.col(bandOf(b)) +=
            Eigen::Vector2d(residual_.col(b).head<6>().squaredNorm(), residual_.col(b).tail<6>().squaredNorm());
        count.col(bandOf(b)) += 6 * Eigen::Vector2d(calcFreedom(model_.body).mean(), 1);
    }
    return squares.cwiseQuotient(count.cwiseMax(1.0));
}

const ColumnNoise::WeightedProducts& ColumnNoise::calcWeighted(const std::shared_ptr<const Eigen::VectorXcd>& weight,
                                                               Part part) {
    const auto [place, added] = weighted_.try_emplace({weight.get(), part});
    WeightedProducts& sums = place->second;
    if (!added) return sums;
    sums.weight = weight;
    sums.bands.fill(MotionProduct::Zero());
    const auto& products = motion_products_[part == Part::mobile ? 0 : 1];
    for (std::size_t i = 0; i < products.size(); ++i) {
        const Eigen::Index b = static_cast<Eigen::Index>(i) * slope_step_;
        sums.bands[bandOf(b)] += (*weight)[b] * products[i];
    }
    return sums;
}

ColumnNoise::Slope ColumnNoise::calcSlope(const SensorEffect& effect) {
    Slope sum = Slope::Zero();
    for (const auto& change : effect.changes) {
        const Eigen::Matrix<Complex, 1, 6> signal = change.signal.transpose().cast<Complex>();
        const Eigen::Matrix<Complex, 6, 1> direction = change.direction.cast<Complex>();
        const WeightedProducts& products = calcWeighted(change.weight, effect.part);
        for (int band = 0; band < kLevelBands; ++band) {
            const Eigen::Matrix<Complex, 1, 12> along = signal * products.bands[band];
            const Complex all = (along.leftCols<6>() * direction).value();
            const Complex mount = (along.rightCols<6>() * direction).value();
            sum.col(band) -= 2 * Eigen::Vector2cd(mount, all - mount).real();
        }
    }
    return sum;
}

ColumnNoise::Slope ColumnNoise::calcContactSlope(const TestState& from, const TestState& to, int connection, int axis,
                                                 double step) const {
    Slope sum = Slope::Zero();
    const auto c = static_cast<std::size_t>(connection), a = static_cast<std::size_t>(axis);
    const Eigen::Index row = 3 * connection + axis;
    const Eigen::RowVectorXd power = noise_->contactPower(row);
    if (power.isZero(0.0)) return sum;
    const double before = calcStiffnessFluctuation(open_, from.model.connections[c].axis[a], row).squaredNorm();
    const double after = calcStiffnessFluctuation(open_, to.model.connections[c].axis[a], row).squaredNorm();
    if (!(before > 0) || after == before) return sum;
    const double growth = (after / before - 1) / step;
    const Vector6 d = calcAxisDirection(model_, connection, axis);
    for (Eigen::Index b = 0; b < power.size(); ++b) {
        const Vector12c white = noise_->whitener(b).leftCols<6>() * d.cast<Complex>();
        const double mount = std::norm(white.head<6>().dot(residual_.col(b).head<6>()));
        const double all = std::norm(white.dot(residual_.col(b)));
        sum.col(bandOf(b)) += growth * power[b] * Eigen::Vector2d(mount, all - mount);
    }
    return sum;
}

Eigen::MatrixXd ColumnNoise::calcProducts(const std::vector<Column>& columns, Eigen::Index first) const {
    const Eigen::Index count = columns.size();
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count);
    std::vector<Eigen::Index> noisy;
    for (Eigen::Index i = 0; i < count; ++i)
        if (columns[i]) noisy.push_back(i);
    Eigen::MatrixXf own = Eigen::MatrixXf::Zero(noisy.size(), noisy.size());
    for (const RunNoise::Sample& sample : noise_->samples()) {
        Eigen::MatrixXf stacked(2 * 6 * 15, noisy.size());
        for (std::size_t i = 0; i < noisy.size(); ++i) {
            Eigen::Matrix<Complex, 6, 15> outer = Eigen::Matrix<Complex, 6, 15>::Zero();
            for (const Term& term : columns[noisy[i]](sample.bin))
                outer.noalias() +=
                    term.left.segment<6>(first) * (sample.root.transpose() * term.right.cast<Complex>()).transpose();
            const Eigen::Map<const Eigen::Matrix<double, 180, 1>> values(reinterpret_cast<const double*>(outer.data()));
            stacked.col(i) = (std::sqrt(2 * sample.weight) * values).cast<float>();
        }
        own.selfadjointView<Eigen::Lower>().rankUpdate(stacked.transpose());
    }
    own.triangularView<Eigen::StrictlyUpper>() = own.transpose();
    sum(noisy, noisy) = own.cast<double>();
    return sum;
}

}  // namespace wems::identify
