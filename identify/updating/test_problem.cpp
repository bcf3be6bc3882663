#include "identify/updating/test_problem.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/problem/lineariser.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/updating/missing_mode.hpp"
#include "models/common/error.hpp"
#include "models/model_tolerance.hpp"

namespace wems::identify::updating {
namespace {

/// Every axis gets a stop without stiffness on each side that has none, so that one may be found there.
MountModel addDormantStops(MountModel model, double displacement) {
    for (auto& connection : model.connections)
        for (auto& law : connection.axis)
            for (const Side side : {Side::positive, Side::negative}) {
                const bool has = std::any_of(law.stops.begin(), law.stops.end(),
                                             [side](const Stop& stop) { return stop.side == side; });
                if (!has) law.stops.push_back({side, displacement, 0.0, 0.0});
            }
    return model;
}

/// A bracket gets a mode without a shape, so that one may be found that the modes file lacks.
void addDormantMode(MountModel& model, double frequency) {
    if (model.bracket.empty()) return;
    BracketMode mode;
    mode.frequency = frequency;
    mode.damping_ratio = 0.01;
    for (const ToleranceOf what :
         {ToleranceOf::mode_frequency, ToleranceOf::mode_damping_ratio, ToleranceOf::mode_shape})
        mode.tolerances.set(what, 0.0);
    model.bracket.push_back(mode);
}

bool isDormant(const BracketMode& mode) {
    return mode.translation.isZero(0.0) && mode.rotation.isZero(0.0);
}

}  // namespace

TestProblem::TestProblem(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                         const MountModel& model, Numbers numbers)
    : identification_count_(identification.size()), numbers_(numbers), exactly_known_(isExactlyKnown(model)) {
    std::vector<Recording> all = identification;
    all.insert(all.end(), validation.begin(), validation.end());
    layout_ = makeSensorLayout(all, model);
    std::vector<TestRun> prepared(all.size());
    runParallel(all.size(), [&](std::size_t r) { prepared[r] = prepareTestRun(all[r], layout_, model); });
    runs_ = std::make_shared<const std::vector<TestRun>>(std::move(prepared));
    AxisReach reach(model);
    TestScales scales;
    ExcitedBand swept;
    LoadedAxes loaded{};
    scales.lowest = std::numeric_limits<double>::infinity();
    for (const TestRun& run : runs()) {
        reach.widen(run.motion, model);
        scales.lowest = std::min(scales.lowest, run.band.lowest);
        scales.highest = std::max(scales.highest, run.band.highest);
        scales.duration = std::max(scales.duration, run.motion.time.back() - run.motion.time.front());
        for (Eigen::Index a = 0; a < 3; ++a)
            if (run.motion.load.cols() > 0 && !run.motion.load.row(a).isZero(0.0)) loaded.at(a) = true;
        if (run.swept.is_sine && run.motion.load.cols() > 0) swept = {scales.lowest, scales.highest};
    }
    scales.displacement = std::max(reach.positive.maxCoeff(), reach.negative.maxCoeff());
    scales.velocity = reach.velocity;
    if (!(scales.displacement > 0) || !(scales.velocity > 0))
        throw InputError({runs().front().recording.file, 0, {}}, "nothing moves across the mount");
    believed_ = addDormantStops(model, scales.displacement);
    addDormantMode(believed_, scales.lowest);
    table_ = makeUnknownTable({believed_, SensorErrors(layout_)}, layout_, scales, loaded);
    carried_ = findCarried(table_, layout_);
    catalogue_ = makeCatalogue(table_, layout_, believed_, scales, reach, swept);
    pristine_ = remember();
    calibrateNoise();
}

Eigen::VectorXd TestProblem::ownDeviations() const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(catalogue_.columns.size());
    for (std::size_t i = 0; i < table_.size(); ++i)
        if (numbers_ == Numbers::within_tolerances || table_[i].kind == UnknownKind::corner)
            result[i] = table_[i].deviation;
    return result;
}

Eigen::VectorXd TestProblem::deviations() const {
    Eigen::VectorXd result = ownDeviations();
    for (const auto& [position, place] : carried_) result[place] = std::hypot(result[place], result[position]);
    return result;
}

std::vector<Direction> TestProblem::tolerances(const HypothesisSet& set, const Eigen::VectorXd& estimate) const {
    Eigen::VectorXd own = ownDeviations();
    for (const int h : set)
        for (const Direction& direction : catalogue_.hypotheses[h].directions) {
            const double factor = calcCommonFactor(table_, direction, estimate);
            for (const auto& [column, weight] : direction) own[column] *= factor;
        }
    if (numbers_ == Numbers::within_tolerances)
        for (const int h : set) addShares(catalogue_.hypotheses[h], estimate, own);
    return linkTolerances(own, carried_);
}

Eigen::VectorXd TestProblem::reaches() const {
    Eigen::VectorXd result = Eigen::VectorXd::Ones(catalogue_.columns.size());
    for (std::size_t i = 0; i < table_.size(); ++i) result[i] = table_[i].reach;
    for (std::size_t i = 0; i < catalogue_.columns.probes.size(); ++i)
        result[table_.size() + i] = table_[static_cast<std::size_t>(catalogue_.columns.probes[i].parameter)].reach;
    return result;
}

TestPoint TestProblem::believedPoint() const {
    return pointAt(Eigen::VectorXd::Zero(catalogue_.columns.size()), {});
}

TestPoint TestProblem::pointAt(const Eigen::VectorXd& estimate, const HypothesisSet& set) const {
    TestPoint point{{believed_, SensorErrors(layout_)}, Eigen::VectorXd::Zero(estimate.size())};
    const Eigen::Index rows = table_.size();
    for (Eigen::Index i = 0; i < rows; ++i) point.values[i] = table_[i].believed + estimate[i];
    for (const int h : set) {
        const Hypothesis& hypothesis = catalogue_.hypotheses[h];
        for (const auto& [row, value] : hypothesis.start) point.values[row] = value;
        for (const auto& [column, row] : hypothesis.moves) point.values[row] += estimate[column];
    }
    for (Eigen::Index i = 0; i < rows; ++i) {
        const Unknown& row = table_[i];
        point.values[i] = std::clamp(point.values[i], row.least, row.most);
        if (point.values[i] != row.get(point.state)) row.set(point.state, point.values[i]);
    }
    const auto& hats = catalogue_.columns.hats;
    const Eigen::VectorXd gains = estimate.tail(hats.size());
    if (gains.size() == 0 || gains.isZero(0.0)) return point;
    point.values.tail(gains.size()) = gains;
    const int common = findUnknown(table_, "load.gain");
    if (!point.state.model.load) point.state.model.load.emplace();
    point.state.model.load->gain_over_frequency.clear();
    for (std::size_t k = 0; k < hats.size(); ++k)
        point.state.model.load->gain_over_frequency.emplace_back(hats[k].at,
                                                                 std::max(0.0, point.values[common] + gains[k]));
    return point;
}

TestPoint TestProblem::reduce(const TestPoint& point, const HypothesisSet& set) const {
    const Eigen::VectorXd own = deviations(), reach = reaches();
    std::vector<const Direction*> directions;
    for (const int h : set)
        for (const Direction& direction : catalogue_.hypotheses[h].directions) directions.push_back(&direction);
    // In units of the reaches, without the columns that have a tolerance of their own.
    Eigen::MatrixXd spanned = Eigen::MatrixXd::Zero(own.size(), static_cast<Eigen::Index>(directions.size()));
    for (std::size_t j = 0; j < directions.size(); ++j)
        for (const auto& [column, weight] : *directions[j])
            if (!(own[column] > 0)) spanned(column, static_cast<Eigen::Index>(j)) = weight / reach[column];
    const Eigen::VectorXd before = estimateOf(point);
    const Eigen::VectorXd scaled = (own.array() > 0).select(0.0, before.cwiseQuotient(reach));
    const Eigen::VectorXd nearest =
        spanned.cols() > 0 ? Eigen::VectorXd(spanned * spanned.completeOrthogonalDecomposition().solve(scaled))
                           : Eigen::VectorXd::Zero(own.size());
    Eigen::VectorXd estimate = (own.array() > 0).select(before, nearest.cwiseProduct(reach));
    if (numbers_ == Numbers::within_tolerances)
        for (const int h : set) keepShares(catalogue_.hypotheses[h], before, estimate);
    return pointAt(estimate, set);
}

std::optional<TestPoint> TestProblem::goToProbes(const TestPoint& point, const HypothesisSet& set) const {
    Eigen::VectorXd estimate = estimateOf(reduce(point, set));
    bool found = false;
    for (const int h : set) {
        const Hypothesis& hypothesis = catalogue_.hypotheses[h];
        if (!hypothesis.start.empty()) continue;  // a mechanism, which begins at nothing
        for (const auto& [column, row] : hypothesis.moves) {
            estimate[column] = catalogue_.columns.probes[static_cast<std::size_t>(column) - table_.size()].step;
            found = true;
        }
    }
    if (!found) return std::nullopt;
    return pointAt(estimate, set);
}

TestProblem::Memento TestProblem::remember() const {
    Memento now{catalogue_.hypotheses, {}};
    for (const Unknown& row : table_) now.believed.push_back(row.believed);
    return now;
}

TestProblem::Memento TestProblem::adopt(const HypothesisSet& set) {
    Memento before = remember();
    for (std::size_t h = 0; h < catalogue_.hypotheses.size(); ++h) {
        if (std::binary_search(set.begin(), set.end(), static_cast<int>(h))) continue;
        if (!isAdopted(static_cast<int>(h))) continue;
        const Hypothesis& own = pristine_.hypotheses[h];
        for (const auto& [row, value] : own.start) table_[row].believed = pristine_.believed[row];
        catalogue_.hypotheses[h] = own;
    }
    for (const int h : set) {
        Hypothesis& hypothesis = catalogue_.hypotheses[h];
        if (hypothesis.tangent.empty()) continue;
        for (const auto& [row, value] : hypothesis.start) table_[row].believed = value;
        hypothesis.directions = hypothesis.tangent;
        hypothesis.start.clear();
        hypothesis.tangent.clear();
        hypothesis.moves.clear();
    }
    return before;
}

bool TestProblem::isAdopted(int hypothesis) const {
    return !pristine_.hypotheses[hypothesis].tangent.empty() && catalogue_.hypotheses[hypothesis].tangent.empty();
}

void TestProblem::release(TestPoint& point, int hypothesis) const {
    if (!isAdopted(hypothesis)) return;
    for (const auto& [row, value] : pristine_.hypotheses[hypothesis].start) {
        point.values[row] = pristine_.believed[row];
        table_[row].set(point.state, point.values[row]);
    }
}

void TestProblem::restore(const Memento& memento) {
    catalogue_.hypotheses = memento.hypotheses;
    for (std::size_t i = 0; i < table_.size(); ++i) table_[i].believed = memento.believed[i];
}

void TestProblem::seekMissingMode(const TestPoint& point, const HypothesisSet& set) {
    if (catalogue_.missing_mode < 0 || std::binary_search(set.begin(), set.end(), catalogue_.missing_mode)) return;
    const auto found = findMissingMode(*correctRuns(point), layout_, point.state);
    if (!found) return;
    TestState with = point.state;
    with.model.bracket.back() = found->mode;
    const int dormant = static_cast<int>(with.model.bracket.size()) - 1;
    Hypothesis& hypothesis = catalogue_.hypotheses[catalogue_.missing_mode];
    hypothesis.start.clear();
    hypothesis.tangent.clear();
    hypothesis.reported.clear();
    for (std::size_t i = 0; i < table_.size(); ++i) {
        Unknown& row = table_[i];
        if (row.first != dormant || (row.kind != UnknownKind::mode && row.kind != UnknownKind::shape)) continue;
        const int index = static_cast<int>(i);
        hypothesis.start.emplace_back(index, row.get(with));
        row.reach = calcModeReach(found->mode, row);
        if (Direction direction = makeModeDirection(*found, row, index); !direction.empty())
            hypothesis.tangent.push_back(std::move(direction));
        if (row.kind == UnknownKind::mode || row.second < 6) hypothesis.reported.push_back(index);
    }
    catalogue_.columns.probes[catalogue_.missing_mode_probe].preset = hypothesis.start;
    pristine_.hypotheses[catalogue_.missing_mode] = hypothesis;
}

Eigen::VectorXd TestProblem::estimateOf(const TestPoint& point) const {
    Eigen::VectorXd estimate = point.values;
    for (std::size_t i = 0; i < table_.size(); ++i) estimate[i] -= table_[i].believed;
    return estimate;
}

PointEquations TestProblem::formEquations(const TestPoint& point) const {
    PointEquations equations{correctRuns(point), {}};
    const std::vector<TestRun>& runs = *equations.runs;
    equations.at.resize(runs.size());
    runParallel(runs.size(),
                [&](std::size_t r) { equations.at[r] = std::make_shared<Lineariser>(runs[r], layout_, point.state); });
    return equations;
}

TestMisfit TestProblem::misfit(const TestPoint& point) const {
    TestMisfit sum;
    sum.equations = formEquations(point);
    const PointEquations& equations = sum.equations;
    std::vector<Information> own(equations.at.size());
    runParallel(own.size(), [&](std::size_t r) {
        own[r] = calcMisfit(*equations.at[r], (*equations.runs)[r], layout_, point.state);
    });
    for (std::size_t r = 0; r < own.size(); ++r)
        add(r < identification_count_ ? sum.identification : sum.validation, own[r]);
    return sum;
}

TestView TestProblem::view(const TestPoint& point) const {
    if (numbers_ == Numbers::within_tolerances) return view(point, catalogue_.columns, {});
    HypothesisSet all(catalogue_.hypotheses.size());
    std::iota(all.begin(), all.end(), 0);
    return view(point, all);
}

ColumnSet TestProblem::columnsOf(const HypothesisSet& set) const {
    ColumnSet columns = catalogue_.columns;
    columns.wantNone();
    const Eigen::VectorXd own = deviations();
    for (std::size_t i = 0; i < table_.size(); ++i) columns.wanted[i] = own[i] > 0;
    for (const int h : set)
        for (const Direction& direction : catalogue_.hypotheses[h].directions)
            for (const auto& [column, weight] : direction) columns.wanted[column] = 1;
    return columns;
}

TestView TestProblem::view(const TestPoint& point, const HypothesisSet& set, PointEquations equations) const {
    return view(point, columnsOf(set), std::move(equations));
}

TestView TestProblem::view(const TestPoint& point, const HypothesisSet& set,
                           const std::vector<AddedCurve>& curves) const {
    ColumnSet columns = columnsOf(set);
    columns.curves = curves;
    return view(point, std::move(columns), {});
}

TestView TestProblem::viewAlone(const TestPoint& point, const std::vector<AddedCurve>& curves) const {
    ColumnSet columns = catalogue_.columns;
    columns.wantNone();
    columns.curves = curves;
    return view(point, columns, {});
}

TestView TestProblem::view(const TestPoint& point, ColumnSet columns, PointEquations equations) const {
    columns.table = &table_;  // of this copy
    if (equations.at.empty()) equations = formEquations(point);
    const std::vector<TestRun>& runs = *equations.runs;
    TestView result;
    result.at = point;
    result.runs.resize(runs.size());
    runParallel(runs.size(), [&](std::size_t r) {
        result.runs[r] = linearise(*equations.at[r], runs[r], layout_, columns, point.state);
        equations.at[r].reset();
    });
    Eigen::VectorXd offset = Eigen::VectorXd::Zero(columns.size());
    offset.head(point.values.size()) = -estimateOf(point);
    for (std::size_t r = 0; r < runs.size(); ++r)
        add(r < identification_count_ ? result.identification : result.validation,
            shiftToBelieved(result.runs[r].information, offset));
    return result;
}

MountModel TestProblem::cleanModel(const TestPoint& point) const {
    MountModel model = point.state.model;
    for (auto& connection : model.connections)
        for (auto& law : connection.axis) {
            law.stops.erase(std::remove_if(law.stops.begin(), law.stops.end(),
                                           [](const Stop& stop) { return stop.stiffness == 0; }),
                            law.stops.end());
            if (law.relaxation && law.relaxation->stiffness_ratio == 0) law.relaxation.reset();
            if (law.friction && law.friction->force == 0) law.friction.reset();
            if (law.hysteresis && law.hysteresis->force == 0) law.hysteresis.reset();
        }
    model.bracket.erase(std::remove_if(model.bracket.begin(), model.bracket.end(), isDormant), model.bracket.end());
    return model;
}

}  // namespace wems::identify::updating
