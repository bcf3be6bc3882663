#include "identify/problem/linearised_run.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/problem/column_noise.hpp"
#include "identify/problem/lineariser.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/problem/sensor_columns.hpp"
#include "models/bryant.hpp"

namespace wems::identify {
namespace {

constexpr double kUnfold = 1.4142135623730951;  // real and imaginary parts share the variance

/// Real values of six complex rows: real parts, then imaginary parts, of each bin.
Eigen::VectorXf unfold(const Eigen::Ref<const Eigen::MatrixXcd>& rows) {
    Eigen::VectorXf values(2 * rows.size());
    Eigen::Map<Eigen::MatrixXf> real(values.data(), rows.rows(), rows.cols());
    Eigen::Map<Eigen::MatrixXf> imaginary(values.data() + rows.size(), rows.rows(), rows.cols());
    real = (kUnfold * rows.real()).cast<float>();
    imaginary = (kUnfold * rows.imag()).cast<float>();
    return values;
}

/// Columns of one block and their products; those that are not set are zero.
class BlockColumns {
public:
    BlockColumns(Eigen::Index rows, Eigen::Index columns) : rows_(rows), columns_(columns) {}
    void set(Eigen::Index column, Eigen::VectorXf values) { columns_[column] = std::move(values); }
    /// @param residual as the columns
    BlockInformation calcInformation(const Eigen::VectorXf& residual) const {
        std::vector<Eigen::Index> used;
        for (std::size_t c = 0; c < columns_.size(); ++c)
            if (columns_[c].size() > 0) used.push_back(c);
        const Eigen::Index count = used.size(), all = columns_.size();
        Eigen::MatrixXd A = Eigen::MatrixXd::Zero(count, count);
        Eigen::VectorXd b = Eigen::VectorXd::Zero(count);
        BlockInformation result;
        constexpr Eigen::Index kChunk = 1024;
        for (Eigen::Index first = 0; first < rows_; first += kChunk) {
            const Eigen::Index rows = std::min(kChunk, rows_ - first);
            Eigen::MatrixXd chunk(rows, count);
            for (Eigen::Index i = 0; i < count; ++i)
                chunk.col(i) = columns_[used[i]].segment(first, rows).cast<double>();
            const Eigen::VectorXd r = residual.segment(first, rows).cast<double>();
            A.selfadjointView<Eigen::Lower>().rankUpdate(chunk.transpose());
            b.noalias() += chunk.transpose() * r;
            result.chi_squared += r.squaredNorm();
        }
        A.triangularView<Eigen::StrictlyUpper>() = A.transpose();
        result.A = Eigen::MatrixXd::Zero(all, all);
        result.b = Eigen::VectorXd::Zero(all);
        result.noise_slopes = Eigen::MatrixXd::Zero(all, 0);
        result.A(used, used) = A;
        result.b(used) = b;
        result.count = static_cast<double>(rows_);
        return result;
    }

private:
    Eigen::Index rows_;
    std::vector<Eigen::VectorXf> columns_;
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
    if (kept == 0) {
        block.A.resize(0, 0);
        block.b.resize(0);
        return;
    }
    const Eigen::VectorXd b = block.b.head(kept) - cross * solved;
    const Eigen::MatrixXd A = block.A.topLeftCorner(kept, kept) - cross * factor.solve(cross.transpose());
    block.A = A;
    block.b = b;
}

/// The inverse of the prior variance of a mode's coordinate when the recording begins: it has moved the bracket no more
/// than the bracket moved.
double calcTransientPrecision(const Lineariser& at, const MountModel& model) {
    Eigen::MatrixXd fixed = at.run().fixed.p;
    fixed.colwise() -= fixed.rowwise().mean().eval();
    double largest = 0;
    for (const auto& mode : model.bracket) largest = std::max(largest, mode.translation.norm());
    const double amplitude = fixed.cwiseAbs().maxCoeff() / std::max(largest, 1e-300);
    return 1 / (amplitude * amplitude);
}

class ColumnMaker {
public:
    ColumnMaker(const Lineariser& at, const ColumnSet& columns, const TestState& state, Eigen::Index extra)
        : at_(at),
          columns_(columns),
          state_(state),
          noise_(at.run(), state.model, at.spectra(), at.noise(), at.residual()),
          mount_(12 * at.spectra().binCount(), columns.size() + extra),
          bracket_(at.hasBracket() ? 12 * at.spectra().binCount() : 0, columns.size() + extra),
          slopes_(columns.size() + extra, ColumnNoise::Slope::Zero()),
          noisy_(columns.size()) {}

    void add(Eigen::Index column, const Eigen::MatrixXcd& mount, const Eigen::MatrixXcd& bracket) {
        if (mount.size() == 0 && bracket.size() == 0) return;
        addWhite(column, at_.whiten(mount, bracket), mount.size() > 0);
    }
    void addWhite(Eigen::Index column, const Eigen::MatrixXcd& white, bool mount = true) {
        if (white.size() == 0) return;
        if (mount) {
            mount_.set(column, unfold(white.topRows(6)));
            Eigen::VectorXd bursts = at_.calcBursts(white);
            if (bursts.size() > 0) bursts_.emplace_back(column, std::move(bursts));
        }
        if (at_.hasBracket()) bracket_.set(column, unfold(white.bottomRows(6)));
    }

    void addBracket(Eigen::Index column, const Eigen::MatrixXcd& white) { bracket_.set(column, unfold(white)); }

    void addLaw(Eigen::Index column, int connection, int axis, const TestState& from, const TestState& to,
                double step) {
        addWhite(column, at_.calcLawColumn(from, to, connection, axis, step));
        const auto change = noise_.calcLawChange(from, to, connection, axis, step);
        slopes_[column] = noise_.calcSlope(change);
        noisy_[column] = noise_.makeLaw(change);
        slopes_[column] += noise_.calcContactSlope(from, to, connection, axis, step);
    }

    Eigen::MatrixXd calcScatter(Eigen::Index size) const {
        Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(size, size);
        if (bursts_.empty()) return scatter;
        Eigen::MatrixXd bursts(bursts_.front().second.size(), bursts_.size());
        for (std::size_t i = 0; i < bursts_.size(); ++i) bursts.col(static_cast<Eigen::Index>(i)) = bursts_[i].second;
        Eigen::MatrixXd products = Eigen::MatrixXd::Zero(bursts.cols(), bursts.cols());
        products.selfadjointView<Eigen::Lower>().rankUpdate(bursts.transpose());
        products.triangularView<Eigen::StrictlyUpper>() = products.transpose();
        std::vector<Eigen::Index> rows;
        for (const auto& [column, own] : bursts_) rows.push_back(column);
        scatter(rows, rows) = products;
        return scatter;
    }

    void makeTable() {
        const UnknownTable& table = *columns_.table;
        TestState moved = state_;
        for (std::size_t i = 0; i < table.size(); ++i) {
            if (!columns_.wants(i)) continue;
            const Unknown& row = table[i];
            const Eigen::Index column = i;
            Eigen::MatrixXcd mount, bracket;
            switch (row.kind) {
                case UnknownKind::law: {
                    const double value = row.get(state_);
                    row.set(moved, value + row.step);
                    addLaw(column, row.first, row.second, state_, moved, row.step);
                    resetLaw(moved, row);
                    break;
                }
                case UnknownKind::position:
                    mount = at_.calcPositionColumn(row.first, row.second);
                    setNoise(column, noise_.makePosition(row.first, row.second));
                    break;
                case UnknownKind::body: {
                    row.set(moved, row.get(state_) - row.step);
                    const MobileBody behind = moved.model.body;
                    row.set(moved, row.get(state_) + row.step);
                    const MobileBody ahead = std::exchange(moved.model.body, state_.model.body);
                    const double apart = 2 * row.step;
                    at_.calcBodyColumn(behind, ahead, apart, mount, bracket);
                    setNoise(column, noise_.makeInertia((calcMassMatrix(ahead) - calcMassMatrix(behind)) / apart,
                                                        crossMatrix((behind.spin - ahead.spin) / apart)));
                    break;
                }
                case UnknownKind::mode:
                    if (!at_.hasBracket()) break;
                    addBracket(column, at_.calcModeColumn(row.first, row.second));
                    setNoise(column, ColumnNoise::ModeChange{row.first, row.second});
                    break;
                case UnknownKind::shape:
                    if (!at_.hasBracket()) break;
                    addBracket(column, at_.calcShapeColumn(row.first, row.second));
                    setNoise(column, ColumnNoise::ModeChange{row.first, 2 + row.second});
                    break;
                case UnknownKind::load:
                    if (at_.run().load.cols() > 0)
                        at_.calcLoadColumn(at_.calcLoadOf(row.second) / row.get(state_), mount, bracket);
                    if (mount.size() > 0 || bracket.size() > 0)
                        setNoise(column, noise_.makeLoad(1 / row.get(state_), row.second));
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
            const Unknown& row = table[probe.parameter];
            std::optional<TestState> preset;
            if (!probe.preset.empty()) preset = state_;
            for (const auto& [other, value] : probe.preset) table[other].set(*preset, value);
            const TestState& from = preset ? *preset : state_;
            if (row.kind == UnknownKind::mode) {
                if (at_.hasBracket()) addBracket(table.size() + i, at_.calcAddedMode(from.model.bracket[row.first]));
                continue;
            }
            TestState to = from;
            row.set(to, row.get(from) + probe.step);
            const Eigen::Index column = table.size() + i;
            addLaw(column, row.first, row.second, from, to, probe.step);
        }
    }

    void makeHats() {
        const UnknownTable& table = *columns_.table;
        if (at_.run().load.cols() == 0) return;
        for (std::size_t i = 0; i < columns_.hats.size(); ++i) {
            if (!columns_.wants(table.size() + columns_.probes.size() + i)) continue;
            Eigen::MatrixXcd mount, bracket;
            double share = 0;
            at_.calcLoadColumn(at_.calcHatLoad(columns_.hats[i], share), mount, bracket);
            const Eigen::Index column = table.size() + columns_.probes.size() + i;
            add(column, mount, bracket);
            setNoise(column, noise_.makeLoad(share, 3));
        }
    }

    void makeCurves() {
        for (std::size_t i = 0; i < columns_.curves.size(); ++i) {
            const AddedCurve& added = columns_.curves[i];
            const std::size_t c = added.connection, a = added.axis;
            TestState with = state_;
            with.model.connections[c].axis[a].curve = added.rows;
            addLaw(columns_.firstCurve() + i, added.connection, added.axis, state_, with, 1);
        }
    }

    void setNoise(Eigen::Index column, ColumnNoise::Column noise) {
        slopes_[column] = noise_.calcSlope(noise);
        noisy_[column] = std::move(noise);
    }
    void setNoise(Eigen::Index column, const ColumnNoise::ModeChange& change) {
        slopes_[column] = noise_.calcSlope(change);
        noisy_[column] = noise_.makeMode(change);
    }
    void setNoise(Eigen::Index column, const SensorEffect& effect) {
        slopes_[column] = noise_.calcSlope(effect);
        noisy_[column] = noise_.makeSensor(effect);
    }
    Eigen::VectorXd calcNoiseLevels(bool bracket) const { return noise_.calcLevels().row(bracket ? 1 : 0).transpose(); }
    Eigen::MatrixXd calcNoiseProducts(bool bracket) const { return noise_.calcProducts(noisy_, bracket ? 6 : 0); }
    BlockColumns& mount() { return mount_; }
    BlockColumns& bracket() { return bracket_; }
    /// Of the mount's rows, or of the bracket's.
    Eigen::MatrixXd calcNoiseSlopes(bool bracket) const {
        Eigen::MatrixXd result(slopes_.size(), kLevelBands);
        for (std::size_t c = 0; c < slopes_.size(); ++c) result.row(c) = slopes_[c].row(bracket ? 1 : 0);
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
    ColumnNoise noise_;
    BlockColumns mount_, bracket_;
    std::vector<ColumnNoise::Slope> slopes_;
    std::vector<ColumnNoise::Column> noisy_;
    std::vector<std::pair<Eigen::Index, Eigen::VectorXd>> bursts_;
};

}  // namespace

LinearisedRun linearise(Lineariser& at, const TestRun& run, const SensorLayout& layout, const ColumnSet& columns,
                        const TestState& state) {
    at.prepareColumns();
    const auto modes = at.hasBracket() ? static_cast<int>(state.model.bracket.size()) : 0;
    const Eigen::Index extra = 2 * modes;
    ColumnMaker maker(at, columns, state, extra);
    std::optional<SensorColumns> sensors;
    runParallel({[&] {
                     maker.makeTable();
                     maker.makeProbes();
                     maker.makeHats();
                     maker.makeCurves();
                     for (int j = 0; j < modes; ++j)
                         for (int sine = 0; sine < 2; ++sine)
                             maker.addBracket(columns.size() + 2 * j + sine, at.calcTransient(j, sine != 0));
                 },
                 [&] {
                     sensors.emplace(run, layout, at.run(), at.spectra(), at.motionNoise(), *columns.table,
                                     columns.wanted);
                     sensors->addSecondOrder({at.makeTurningWrench(Part::mobile), at.makeTurningWrench(Part::fixed)});
                 }});
    for (std::size_t i = 0; i < columns.table->size(); ++i) {
        const SensorEffect effect = sensors->calcEffect(i);
        if (effect.changes.empty()) continue;
        maker.addWhite(i, at.calcMotionColumn(effect));
        maker.setNoise(i, effect);
    }
    LinearisedRun result;
    const auto informMount = [&] {
        auto& mount = result.information[indexOf(Block::mount)];
        mount = maker.mount().calcInformation(unfold(at.residual().topRows(6)));
        mount.count *= calcFreedom(state.model.body).mean();
        mount.A = mount.A.topLeftCorner(columns.size(), columns.size()).eval();
        mount.b = mount.b.head(columns.size()).eval();
        mount.noise_slopes = maker.calcNoiseSlopes(false).topRows(columns.size());
        mount.noise_levels = maker.calcNoiseLevels(false);
        mount.noise = maker.calcNoiseProducts(false);
        mount.scatter = maker.calcScatter(columns.size());
    };
    const auto informBracket = [&] {
        if (!at.hasBracket()) return;
        auto& bracket = result.information[indexOf(Block::bracket)];
        bracket = maker.bracket().calcInformation(unfold(at.residual().bottomRows(6)));
        marginalise(bracket, extra, calcTransientPrecision(at, state.model));
        bracket.noise_slopes = maker.calcNoiseSlopes(true).topRows(columns.size());
        bracket.noise_levels = maker.calcNoiseLevels(true);
        bracket.noise = maker.calcNoiseProducts(true);
    };
    const auto informSensors = [&](Part part) {
        result.information[indexOf(part == Part::mobile ? Block::mobile_sensors : Block::fixed_sensors)] =
            sensors->calcInformation(part, columns.size());
    };
    runParallel(
        {informMount, informBracket, [&] { informSensors(Part::mobile); }, [&] { informSensors(Part::fixed); }});
    for (BlockInformation& block : result.information)
        if (!block.empty()) block.growth = calcGrowth(block);
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

Information calcMisfit(const Lineariser& at, const TestRun& run, const SensorLayout& layout, const TestState& state) {
    Information result;
    const auto measure = [&](Block block, const Eigen::MatrixXcd& rows) {
        auto& own = result[indexOf(block)];
        own.A.resize(0, 0);
        own.b.resize(0);
        own.noise_slopes.resize(0, 0);
        own.chi_squared = 2 * rows.squaredNorm();
        own.count = 2 * static_cast<double>(rows.size());
    };
    measure(Block::mount, at.residual().topRows(6));
    result[indexOf(Block::mount)].count *= calcFreedom(state.model.body).mean();
    if (at.hasBracket()) {
        measure(Block::bracket, at.residual().bottomRows(6));
        const auto modes = static_cast<int>(state.model.bracket.size());
        BlockColumns transients(12 * at.spectra().binCount(), 2 * modes);
        for (int j = 0; j < modes; ++j)
            for (int sine = 0; sine < 2; ++sine) transients.set(2 * j + sine, unfold(at.calcTransient(j, sine != 0)));
        BlockInformation own = transients.calcInformation(unfold(at.residual().bottomRows(6)));
        marginalise(own, 2 * modes, calcTransientPrecision(at, state.model));
        result[indexOf(Block::bracket)].chi_squared = own.chi_squared;
    }
    const UnknownTable none;
    const SensorColumns sensors(run, layout, at.run(), at.spectra(), at.motionNoise(), none, {});
    for (const Part part : {Part::mobile, Part::fixed})
        result[indexOf(part == Part::mobile ? Block::mobile_sensors : Block::fixed_sensors)] =
            sensors.calcInformation(part, 0);
    return result;
}

}  // namespace wems::identify
