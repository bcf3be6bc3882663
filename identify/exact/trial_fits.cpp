#include "identify/exact/trial_fits.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "identify/exact/leftover.hpp"
#include "identify/exact/missing_mode.hpp"
#include "identify/exact/screening.hpp"
#include "identify/motion/parallel.hpp"

namespace wems::identify {

namespace {

constexpr double kStep = 1e-3;      // of a knob's scale, for finite differences
constexpr double kRelative = 1e-5;  // of the misfit: smaller gains end the fit
constexpr double kAbsolute = 0.05;  // of the sum of squares

struct Linearised {
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient, scale;
};

Linearised linearise(const OpenLoopProblem& problem, const ParameterFit& at, const std::vector<Knob>& knobs) {
    const Eigen::Index count = knobs.size();
    Linearised result{Eigen::MatrixXd::Zero(count, count), Eigen::VectorXd::Zero(count), Eigen::VectorXd(count)};
    const double variance = problem.calcVariance(at.residual);
    std::vector<WhiteVector> columns;
    for (Eigen::Index i = 0; i < count; ++i) {
        const auto& knob = knobs[i];
        result.scale[i] = knob.scale(at.model);
        double step = kStep * result.scale[i];
        const double value = at.values[i];
        if (value + step > knob.highest(at.model)) step = -step;
        MountModel moved = at.model;
        knob.set(moved, value + step);
        columns.push_back(problem.calcDifference(at.model, moved));
        auto& column = columns.back();
        const double factor = result.scale[i] / step;
        if (!column.isZero()) {
            column.values *= static_cast<float>(factor);
            column.calibration *= factor;
        }
        result.gradient[i] = problem.product(column, at.residual, variance);
        for (Eigen::Index j = 0; j <= i; ++j)
            result.normal(i, j) = result.normal(j, i) = problem.product(column, columns[j], variance);
    }
    return result;
}

}  // namespace

ParameterFit fitParameters(const OpenLoopProblem& problem, const MountModel& start, const std::vector<Knob>& knobs,
                           int max_iterations) {
    ParameterFit fit;
    fit.model = start;
    for (const auto& knob : knobs) fit.values.push_back(knob.get(start));
    fit.residual = problem.calcResidual(start);
    fit.misfit = problem.calcMisfit(fit.residual);
    const Eigen::Index count = knobs.size();
    fit.covariance = Eigen::MatrixXd::Zero(count, count);
    if (count == 0) return fit;
    const double absolute = kAbsolute / static_cast<double>(problem.size());
    double damping = 1e-6;
    Linearised linear = linearise(problem, fit, knobs);
    for (fit.iterations = 0; fit.iterations < max_iterations; ++fit.iterations) {
        Eigen::MatrixXd normal = linear.normal;
        const double floor = 1e-12 * normal.diagonal().maxCoeff() + 1e-300;
        normal.diagonal() += damping * normal.diagonal() + Eigen::VectorXd::Constant(count, floor);
        const Eigen::VectorXd step = -normal.ldlt().solve(linear.gradient);
        ParameterFit next;
        next.model = fit.model;
        for (Eigen::Index i = 0; i < count; ++i) {
            const auto& knob = knobs[i];
            const double wanted = fit.values[i] + step[i] * linear.scale[i];
            next.values.push_back(std::clamp(wanted, knob.lowest(fit.model), knob.highest(fit.model)));
            knob.set(next.model, next.values.back());
        }
        next.residual = problem.calcResidual(next.model);
        next.misfit = problem.calcMisfit(next.residual);
        const double gain = fit.misfit - next.misfit;
        if (!(gain > 0)) {
            damping = std::max(damping * 30, 1e-3);
            if (damping > 1e4 || gain > -absolute) break;
            continue;
        }
        fit.model = next.model;
        fit.values = next.values;
        fit.residual = std::move(next.residual);
        fit.misfit = next.misfit;
        damping = std::max(damping * 0.1, 1e-9);
        linear = linearise(problem, fit, knobs);
        if (gain < absolute + kRelative * fit.misfit) break;
    }
    Eigen::MatrixXd normal = linear.normal;
    normal.diagonal().array() += 1e-14 * normal.diagonal().maxCoeff() + 1e-300;
    fit.covariance = linear.scale.asDiagonal() * normal.inverse() * linear.scale.asDiagonal();
    return fit;
}

namespace {

/// Where a force along one axis could make this share of the mount's residual, laws elsewhere are not tried …
constexpr double kAloneInEquation = 0.95;
/// … but for axes that could make nearly as much. The residual must stand out from the noise for that, per value.
constexpr double kNearlyAsMuch = 0.04;
constexpr double kStandsOut = 0.5;

constexpr double kPromising = 0.25;  // of the least gain
constexpr int kTrialIterations = 6;

/// `1.x` of `1.x` and `1.x.+`; empty for `body`, `mobile`, …
std::string axisOf(const std::string& place) {
    const auto dot = place.find('.');
    return dot == std::string::npos ? "" : place.substr(0, dot + 2);
}

bool overlaps(const Candidate& a, const std::vector<Candidate>& others) {
    const auto names = a.parameterNames();
    for (const auto& other : others)
        for (const auto& name : other.parameterNames())
            if (std::find(names.begin(), names.end(), name) != names.end()) return true;
    return false;
}

}  // namespace

TrialFits::TrialFits(const OpenLoopProblem& identification, const OpenLoopProblem& validation, TrialOptions options)
    : identification_(identification), validation_(validation), options_(std::move(options)) {
    for (std::size_t r = 0; r < identification.runs().size(); ++r)
        with_bracket_ = with_bracket_ || identification.hasBracket(r);
}

void TrialFits::lookAround(const MountModel& model) {
    laws_ = std::make_unique<LawDifferences>(identification_, model);
}

double TrialFits::price(double misfit) const {
    return 0.5 * std::log(static_cast<double>(identification_.size())) * std::max(1.0, misfit);
}

double TrialFits::score(const Trial& trial) const {
    return trial.identification * static_cast<double>(identification_.size()) +
           2 * price(trial.identification) * static_cast<double>(trial.candidate.knobs.size());
}

bool TrialFits::isExcluded(const Candidate& candidate) const {
    return std::any_of(options_.excluded.begin(), options_.excluded.end(), [&](const Candidate& other) {
        return other.cause == candidate.cause &&
               std::all_of(candidate.where.begin(), candidate.where.end(), [&](const std::string& place) {
                   return std::find(other.where.begin(), other.where.end(), place) != other.where.end();
               });
    });
}

std::vector<Candidate> TrialFits::makePossible(const ParameterFit& present) const {
    auto catalogue = makeCatalogue(present.model, with_bracket_);
    for (auto& candidate : makeMissingMode(identification_, present.model, present.residual))
        catalogue.push_back(std::move(candidate));
    catalogue.erase(
        std::remove_if(catalogue.begin(), catalogue.end(), [&](const Candidate& own) { return isExcluded(own); }),
        catalogue.end());
    const auto keepPossible = [&](const std::function<bool(const std::string&)>& isPossible) {
        const auto excluded = [&](const Candidate& candidate) {
            return !std::all_of(candidate.where.begin(), candidate.where.end(), isPossible);
        };
        catalogue.erase(std::remove_if(catalogue.begin(), catalogue.end(), excluded), catalogue.end());
    };
    if (!options_.only_place.empty()) {
        keepPossible([&](const std::string& place) { return axisOf(place) == options_.only_place; });
        return catalogue;
    }
    if (calcMountExcess(identification_, present.residual) < kStandsOut) return catalogue;
    const auto shares = calcPlaceShares(identification_, present.model, present.residual);
    if (shares.front().share < kAloneInEquation) return catalogue;
    keepPossible([&](const std::string& place) {
        const std::string axis = axisOf(place);
        return axis.empty() || std::any_of(shares.begin(), shares.end(), [&](const PlaceShare& share) {
                   return share.name == axis && share.share > shares.front().share - kNearlyAsMuch;
               });
    });
    return catalogue;
}

std::vector<FittedTrial> TrialFits::fitBest(const ParameterFit& present, const std::vector<Candidate>& accepted,
                                            int count) {
    const auto catalogue = makePossible(present);
    const auto screened =
        screenCandidates(identification_, *laws_, present.model, present.residual, catalogue, price(present.misfit));
    const double least = kPromising * options_.least_gain * static_cast<double>(identification_.size());
    std::vector<const Screened*> chosen;
    for (const auto& entry : screened) {
        if (static_cast<int>(chosen.size()) >= count || entry.gain < least) break;
        if (!overlaps(catalogue[entry.candidate], accepted)) chosen.push_back(&entry);
    }
    std::vector<FittedTrial> fitted(chosen.size());
    runParallel(chosen.size(), [&](std::size_t i) {
        auto& [trial, fit] = fitted[i];
        trial.candidate = catalogue[chosen[i]->candidate];
        MountModel start = present.model;
        trial.candidate.apply(start, chosen[i]->values);
        auto all = accepted;
        all.push_back(trial.candidate);
        fit = fitParameters(identification_, start, collectKnobs(all), kTrialIterations);
        for (const auto& knob : trial.candidate.knobs) trial.values.push_back(knob.get(fit.model));
        trial.identification = fit.misfit;
        trial.validation = validation_.calcMisfit(fit.model);
    });
    std::sort(fitted.begin(), fitted.end(),
              [&](const FittedTrial& a, const FittedTrial& b) { return score(a.trial) < score(b.trial); });
    return fitted;
}

std::vector<Knob> collectKnobs(const std::vector<Candidate>& candidates) {
    std::vector<Knob> knobs;
    for (const auto& candidate : candidates) knobs.insert(knobs.end(), candidate.knobs.begin(), candidate.knobs.end());
    return knobs;
}

}  // namespace wems::identify
