#include "identify/residual/residual_diagnosis.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

#include "identify/catalogue/hypotheses.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify {
namespace {

constexpr double kLargestDecibels = 120.0;
constexpr double kRivalProbability = 0.02;  // a set at least this likely makes its causes rivals
constexpr double kStill = 1;                // the error of a response that does not move
constexpr double kNoStop = 0.1;             // of the believed stiffness: a stop that soft is none
constexpr double kTold = 0.25;              // of the prior variance, which the tests leave of a number
constexpr int kDraws = 100;                 // of the band: its 95 % quantile is good to a tenth of its spread
constexpr unsigned kSeed = 20260101;        // the same answer again

class Diagnostician {
public:
    Diagnostician(const ResidualProblem& problem, const DiagnosisOptions& options)
        : problem_(problem), options_(options) {}

    ResidualDiagnosis run() {
        answer_ = searchCauses(problem_, options_.progress);
        result_.error_before = problem_.calcErrors(problem_.believedValues());
        result_.error_adjusted = problem_.calcErrors(answer_.adjusted.values);
        result_.error_after = problem_.calcErrors(answer_.best.values);
        result_.noise_floor = problem_.calcNoiseFloor();
        result_.prediction_band = calcBand();
        result_.decisions = answer_.decisions;
        const double floor = result_.noise_floor.validation;
        if (floor > 0) result_.misfit_before = std::pow(result_.error_before.validation / floor, 2);
        if (floor > 0) result_.misfit_after = std::pow(result_.error_after.validation / floor, 2);
        addCauses();
        addAdjustments();
        return {std::move(result_), std::move(answer_)};
    }

private:
    const Hypothesis& at(int h) const { return problem_.hypotheses()[h]; }
    const Unknown& row(int index) const { return problem_.table()[index]; }

    /// Error below which 95 of 100 draws of the numbers lie, with the noise.
    double calcBand() const {
        const ResidualFit& best = answer_.best;
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> spread(best.covariance);
        const Eigen::MatrixXd root = spread.eigenvectors() * spread.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal();
        std::mt19937 generator(kSeed);
        std::normal_distribution<double> normal;
        std::vector<double> errors;
        for (int draw = 0; draw < kDraws; ++draw) {
            Eigen::VectorXd z(best.values.size());
            for (double& value : z) value = normal(generator);
            Eigen::VectorXd values = best.values + root * z;
            for (Eigen::Index i = 0; i < values.size(); ++i)
                values[i] = std::clamp(values[i], row(static_cast<int>(i)).least, row(static_cast<int>(i)).most);
            errors.push_back(problem_.calcJudgedDifference(values, best.values));
        }
        std::sort(errors.begin(), errors.end());
        return std::sqrt(errors[static_cast<std::size_t>(0.95 * kDraws)] + std::pow(result_.noise_floor.validation, 2));
    }

    CauseParameter makeParameter(int index, const ResidualFit& fit) const {
        const double width = kTwoSided95 * std::sqrt(std::max(0.0, fit.covariance(index, index)));
        return {row(index).name, row(index).unit, fit.values[index], fit.values[index] - width,
                fit.values[index] + width};
    }

    std::vector<CauseParameter> makeParameters(int h, const ResidualFit& fit) const {
        std::vector<CauseParameter> parameters;
        for (const int index : at(h).reported) parameters.push_back(makeParameter(index, fit));
        return parameters;
    }

    bool isRemovedStop(int h, const ResidualFit& fit) const {
        return at(h).cause == "stop_stiffness" && at(h).reported.size() == 1 &&
               fit.values[at(h).reported.front()] < kNoStop * row(at(h).reported.front()).believed;
    }

    static bool samePlace(const Hypothesis& a, const Hypothesis& b) {
        return a.cause == b.cause && std::any_of(a.where.begin(), a.where.end(), [&](const std::string& place) {
                   return std::find(b.where.begin(), b.where.end(), place) != b.where.end();
               });
    }

    void addCauses() {
        const ResidualFit& best = answer_.best;
        for (const int h : best.set) {
            Cause cause;
            cause.cause = at(h).cause;
            cause.where = at(h).where;
            cause.parameters = makeParameters(h, best);
            if (isRemovedStop(h, best)) {
                const double none = std::numeric_limits<double>::quiet_NaN();
                cause.cause = "clearance";
                cause.parameters = {{cause.where.front() + ".clearance", "m", none, none, none}};
            }
            cause.probability = weighRivals(h, cause);
            const double error = problem_.calcErrors(leaveOut(problem_, best, h).values).validation;
            const double before = result_.error_before.validation, after = result_.error_after.validation;
            cause.gain_db = after > 0 ? toDecibel(error / after) : kLargestDecibels;
            if (before > after)
                cause.share = std::clamp((error * error - after * after) / (before * before - after * after), 0.0, 1.0);
            result_.causes.push_back(std::move(cause));
        }
        std::stable_sort(result_.causes.begin(), result_.causes.end(),
                         [](const Cause& a, const Cause& b) { return a.gain_db > b.gain_db; });
    }

    /// Probability of the statement over the sets that differ from the best in this member; adds the rivals.
    double weighRivals(int h, Cause& cause) const {
        const ResidualFit& best = answer_.best;
        HypothesisSet others = best.set;
        others.erase(std::find(others.begin(), others.end(), h));
        double with = 0, all = 0;
        std::vector<std::pair<double, const ResidualFit*>> rivals;
        for (const ResidualFit& fit : answer_.ranked) {
            if (!std::includes(fit.set.begin(), fit.set.end(), others.begin(), others.end())) continue;
            const double weight = std::exp(fit.log_evidence - best.log_evidence);
            const int other = otherOf(fit, others);
            all += weight;
            if (other >= 0 && (other == h || samePlace(at(other), at(h))))
                with += weight;
            else if (other >= 0)
                rivals.emplace_back(weight, &fit);
        }
        for (const auto& [weight, fit] : rivals) {
            const int other = otherOf(*fit, others);
            if (weight < kRivalProbability * all) continue;
            const bool known = std::any_of(cause.rivals.begin(), cause.rivals.end(), [&](const Rival& rival) {
                return rival.cause == at(other).cause && rival.where == at(other).where;
            });
            if (!known)
                cause.rivals.push_back({at(other).cause, at(other).where, makeParameters(other, *fit),
                                        updating::findSeparatingRun(cause.cause, at(other).cause)});
        }
        return std::min(0.999, all > 0 ? with / all : 0);
    }

    /// The member of a fit beside some others; −1 if there is none.
    static int otherOf(const ResidualFit& fit, const HypothesisSet& others) {
        for (const int h : fit.set)
            if (!std::binary_search(others.begin(), others.end(), h)) return h;
        return -1;
    }

    void addAdjustments() {
        const ResidualFit& best = answer_.best;
        for (int index = 0; index < static_cast<int>(problem_.table().size()); ++index) {
            const Unknown& number = row(index);
            if (!(number.deviation > 0) || best.values[index] == number.believed) continue;
            if (std::any_of(best.set.begin(), best.set.end(), [&](int h) {
                    return std::find(at(h).reported.begin(), at(h).reported.end(), index) != at(h).reported.end();
                }))
                continue;
            if (best.covariance(index, index) > kTold * number.deviation * number.deviation) continue;
            result_.adjustments.push_back({makeParameter(index, best), number.believed, 2 * number.deviation});
        }
    }

    const ResidualProblem& problem_;
    const DiagnosisOptions& options_;
    ResidualAnswer answer_;
    Diagnosis result_;
};

}  // namespace

ResidualDiagnosis diagnoseResidual(const ResidualProblem& problem, const DiagnosisOptions& options) {
    return Diagnostician(problem, options).run();
}

bool isLeft(const Diagnosis& diagnosis) {
    const double error = diagnosis.error_after.validation;
    if (error >= kStill) return true;
    return !(error <= diagnosis.prediction_band.value_or(0)) &&
           isWorthExplaining({error, diagnosis.noise_floor.validation});
}

Diagnosis::Verdict judgeVerdict(const Diagnosis& diagnosis) {
    if (isLeft(diagnosis)) return Diagnosis::Verdict::unexplained;
    const bool falls = diagnosis.error_after.validation < diagnosis.error_before.validation;
    return !diagnosis.causes.empty() && falls ? Diagnosis::Verdict::explained : Diagnosis::Verdict::nothing_missing;
}

double toDecibel(double ratio) {
    return ratio > 0 ? std::clamp(20 * std::log10(ratio), -kLargestDecibels, kLargestDecibels) : kLargestDecibels;
}

}  // namespace wems::identify
