#include "identify/updating/test_problem.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "identify/verdict/free_error.hpp"
#include "models/bryant.hpp"
#include "models/common/error.hpp"

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

/// Largest relative displacement of each axis along a run.
void widen(AxisReach& reach, const RunMotion& motion, const MountModel& model, double& velocity) {
    for (std::size_t i = 0; i < model.connections.size(); ++i) {
        const Eigen::Vector3d r = model.connections[i].position;
        for (Eigen::Index k = 0; k < motion.mobile.p.cols(); ++k) {
            const Eigen::Vector3d q = motion.mobile.p.col(k) + rotationFromVector(motion.mobile.theta.col(k)) * r -
                                      motion.fixed.p.col(k) - rotationFromVector(motion.fixed.theta.col(k)) * r;
            const Eigen::Vector3d v = motion.mobile.v.col(k) + motion.mobile.w.col(k).cross(r) - motion.fixed.v.col(k) -
                                      motion.fixed.w.col(k).cross(r);
            velocity = std::max(velocity, v.cwiseAbs().maxCoeff());
            for (int a = 0; a < 3; ++a) {
                const Eigen::Index row = 3 * static_cast<Eigen::Index>(i) + a;
                reach.positive[row] = std::max(reach.positive[row], q[a]);
                reach.negative[row] = std::max(reach.negative[row], -q[a]);
            }
        }
    }
}

}  // namespace

TestProblem::TestProblem(const std::vector<Recording>& identification, const std::vector<Recording>& validation,
                         const MountModel& model)
    : identification_count_(identification.size()) {
    std::vector<Recording> all = identification;
    all.insert(all.end(), validation.begin(), validation.end());
    layout_ = makeSensorLayout(all, model);
    runs_.resize(all.size());
    runParallel(all.size(), [&](std::size_t r) { runs_[r] = prepareTestRun(all[r], layout_, model); });
    const auto axes = 3 * static_cast<Eigen::Index>(model.connections.size());
    AxisReach reach{Eigen::VectorXd::Zero(axes), Eigen::VectorXd::Zero(axes)};
    TestScales scales;
    ExcitedBand swept;
    LoadedAxes loaded{};
    scales.lowest = std::numeric_limits<double>::infinity();
    for (const TestRun& run : runs_) {
        widen(reach, run.motion, model, scales.velocity);
        scales.lowest = std::min(scales.lowest, run.band.lowest);
        scales.highest = std::max(scales.highest, run.band.highest);
        scales.duration = std::max(scales.duration, run.motion.time.back() - run.motion.time.front());
        for (Eigen::Index a = 0; a < 3; ++a)
            if (run.motion.load.cols() > 0 && !run.motion.load.row(a).isZero(0.0)) loaded.at(a) = true;
        if (run.swept.is_sine && run.motion.load.cols() > 0) swept = {scales.lowest, scales.highest};
    }
    scales.displacement = std::max(reach.positive.maxCoeff(), reach.negative.maxCoeff());
    if (!(scales.displacement > 0) || !(scales.velocity > 0))
        throw InputError({runs_.front().recording.file, 0, {}}, "nothing moves across the mount");
    believed_ = addDormantStops(model, scales.displacement);
    table_ = makeUnknownTable({believed_, SensorErrors(layout_)}, layout_, scales, loaded);
    catalogue_ = makeCatalogue(table_, layout_, believed_, scales, reach, swept);
}

Eigen::VectorXd TestProblem::deviations() const {
    Eigen::VectorXd result = Eigen::VectorXd::Zero(catalogue_.columns.size());
    for (std::size_t i = 0; i < table_.size(); ++i) result[i] = table_[i].deviation;
    return result;
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

TestProblem::Memento TestProblem::adopt(const HypothesisSet& set) {
    Memento before{catalogue_.hypotheses, {}};
    for (const Unknown& row : table_) before.believed.push_back(row.believed);
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

void TestProblem::restore(const Memento& memento) {
    catalogue_.hypotheses = memento.hypotheses;
    for (std::size_t i = 0; i < table_.size(); ++i) table_[i].believed = memento.believed[i];
}

Eigen::VectorXd TestProblem::estimateOf(const TestPoint& point) const {
    Eigen::VectorXd estimate = point.values;
    for (std::size_t i = 0; i < table_.size(); ++i) estimate[i] -= table_[i].believed;
    return estimate;
}

std::array<double, 2> TestProblem::calcDisplacementNoise(std::size_t index) const {
    std::array<double, 2> noise{0, 0};
    for (std::size_t g = 0; g < layout_.groups.size(); ++g)
        if (layout_.groups[g].derivative == Derivative::displacement)
            noise[layout_.groups[g].part == Part::mobile ? 0 : 1] = runs_[index].noise[g].variance();
    return noise;
}

TestProblem::ExactRun TestProblem::calcExactRun(std::size_t index, const TestPoint& point) const {
    TestRun exact = correctRun(runs_[index], point);
    const Eigen::MatrixXd relative = calcMeasuredRelative(exact.recording, exact.motion, believed_);
    return {std::move(exact.motion), relative};
}

TestRun TestProblem::correctRun(const TestRun& run, const TestPoint& point) const {
    TestRun corrected = run;
    if (point.state.sensors.isZero()) return corrected;
    corrected.recording = correctSensors(run.recording, layout_, point.state.sensors, run.band.lowest, &run.motion);
    corrected.motion = estimateMotion(corrected.recording, believed_, ContactEdges::filtered);
    // Taking a gain off a channel takes it off the channel's noise.
    for (std::size_t g = 0; g < layout_.groups.size(); ++g) {
        const auto& channels = layout_.groups[g].channels;
        double square = 0;
        for (const int c : channels) square += std::pow(1 + point.state.sensors.gain[c], -2);
        if (!channels.empty()) corrected.noise[g].scale(square / static_cast<double>(channels.size()));
    }
    return corrected;
}

TestMisfit TestProblem::misfit(const TestPoint& point) const {
    std::vector<Information> own(runs_.size());
    runParallel(runs_.size(),
                [&](std::size_t r) { own[r] = calcMisfit(correctRun(runs_[r], point), layout_, point.state); });
    TestMisfit sum;
    for (std::size_t r = 0; r < own.size(); ++r)
        add(r < identification_count_ ? sum.identification : sum.validation, own[r]);
    return sum;
}

TestView TestProblem::view(const TestPoint& point) const {
    return view(point, catalogue_.columns);
}

TestView TestProblem::view(const TestPoint& point, const HypothesisSet& set) const {
    ColumnSet columns = catalogue_.columns;
    columns.wanted.assign(columns.size(), 0);
    for (std::size_t i = 0; i < table_.size(); ++i) columns.wanted[i] = table_[i].deviation > 0;
    for (const int h : set)
        for (const Direction& direction : catalogue_.hypotheses[h].directions)
            for (const auto& [column, weight] : direction) columns.wanted[column] = 1;
    return view(point, columns);
}

TestView TestProblem::view(const TestPoint& point, const ColumnSet& columns) const {
    TestView result;
    result.at = point;
    result.runs.resize(runs_.size());
    runParallel(runs_.size(), [&](std::size_t r) {
        result.runs[r] = linearise(correctRun(runs_[r], point), layout_, columns, point.state);
    });
    Eigen::VectorXd offset = -estimateOf(point);
    for (std::size_t r = 0; r < runs_.size(); ++r)
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
    return model;
}

}  // namespace wems::identify::updating
