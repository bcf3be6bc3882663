#include "identify/updating/remainder.hpp"

#include <Eigen/Dense>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <random>
#include <utility>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/parallel.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify::updating {

namespace {

// The next draw lies below the largest of 19 with a probability of 19 in 20.
constexpr std::size_t kDraws = 19;

}  // namespace

double calcPredictionBand(const TestProblem& problem, const HypothesisSet& set, const TestPoint& point,
                          const Posterior& posterior, const std::vector<FreeRun>& runs, std::size_t first,
                          double noise_floor, unsigned seed) {
    std::vector<Eigen::MatrixXd> reference;
    double signal = 0;
    const MountModel best = problem.cleanModel(point);
    try {
        for (const FreeRun& run : runs) {
            reference.push_back(calcFreeResidual(run, best));
            signal += run.measured.squaredNorm();
        }
    } catch (const SimulationDiverged&) {
        return std::numeric_limits<double>::infinity();
    }
    const Eigen::MatrixXd root = calcCovarianceRoot(posterior.covariance);
    std::mt19937 generator(seed);
    std::normal_distribution<double> normal;
    std::vector<Eigen::VectorXd> draws;
    for (std::size_t d = 0; d < kDraws; ++d) {
        Eigen::VectorXd z(root.cols());
        for (double& value : z) value = normal(generator);
        draws.push_back(problem.estimateOf(point) + root * z);
    }
    std::vector<double> errors(kDraws);
    runParallel(kDraws, [&](std::size_t d) {
        try {
            const TestPoint drawn = problem.pointAt(draws[d], set);
            const MountModel model = problem.cleanModel(drawn);
            double difference = 0;
            for (std::size_t r = 0; r < runs.size(); ++r) {
                // What the sensors have wrong is in what is compared and, without a load, in what drives.
                const auto exact = problem.calcExactRun(first + r, drawn);
                difference +=
                    (calcFreeResidual({&exact.motion, exact.relative, {}}, model) - reference[r]).squaredNorm();
            }
            errors[d] = difference / signal;
        } catch (const SimulationDiverged&) {
            errors[d] = std::numeric_limits<double>::infinity();
        } catch (const InputError&) {  // a draw that is no model, as one whose weight nothing carries
            errors[d] = std::numeric_limits<double>::infinity();
        }
    });
    return std::sqrt(*std::max_element(errors.begin(), errors.end()) + noise_floor * noise_floor);
}

namespace {

constexpr double kAloneShare = 0.7;  // share of the residual that one axis must carry alone
constexpr double kNoticeable = 0.2;  // share of the connection's that an axis must carry to be named
constexpr double kRegime = 0.7;      // share of the power within contact, or outside, that makes it the regime

/// Share (0 … 1) of what exceeds the noise that lies in the span of the whitened directions of some axes.
double calcShare(const TestView& view, const std::vector<std::size_t>& axes) {
    double inside = 0, total = 0;
    for (const LinearisedRun& run : view.runs)
        for (Eigen::Index b = 0; b < run.mount_residual.cols(); ++b) {
            Eigen::MatrixXcd span(6, axes.size());
            for (std::size_t i = 0; i < axes.size(); ++i) span.col(i) = run.axis_directions[axes[i]].col(b);
            const Eigen::VectorXcd y = run.mount_residual.col(b);
            const Eigen::VectorXcd right = span.adjoint() * y;
            const Eigen::MatrixXcd normal = span.adjoint() * span;
            inside += right.dot(normal.ldlt().solve(right)).real() - static_cast<double>(axes.size());
            total += y.squaredNorm() - 6;
        }
    return total > 0 ? std::clamp(inside / total, 0.0, 1.0) : 0.0;
}

}  // namespace

std::vector<std::string> locateRemainder(const TestView& view, const std::vector<double>& misfit,
                                         const MountModel& model) {
    if (misfit[indexOf(Block::bracket)] > 3 * misfit[indexOf(Block::mount)] && misfit[indexOf(Block::bracket)] > 1)
        return {"bracket"};
    const auto nameOf = [&](std::size_t axis) { return model.connections[axis / 3].name + "." + kAxes[axis % 3]; };
    std::vector<std::pair<double, std::size_t>> single;
    for (std::size_t axis = 0; axis < 3 * model.connections.size(); ++axis)
        single.emplace_back(calcShare(view, {axis}), axis);
    std::sort(single.rbegin(), single.rend());
    std::vector<std::string> places;
    if (single.front().first > kAloneShare) {
        places.push_back(nameOf(single.front().second));
    } else {
        std::size_t best = 0;
        double best_share = -1;
        for (std::size_t i = 0; i < model.connections.size(); ++i) {
            const double share = calcShare(view, {3 * i, 3 * i + 1, 3 * i + 2});
            if (share > best_share) {
                best_share = share;
                best = i;
            }
        }
        double sum = 0;
        for (const auto& [share, axis] : single)
            if (axis / 3 == best) sum += share;
        for (const auto& [share, axis] : single)
            if (axis / 3 == best && share > kNoticeable * sum) places.push_back(nameOf(axis));
    }
    double contact = 0;
    for (const LinearisedRun& run : view.runs) contact += run.contact_share / static_cast<double>(view.runs.size());
    if (contact < kRegime) places.emplace_back("free");
    if (contact > 1 - kRegime) places.emplace_back("contact");
    return places;
}

namespace {

constexpr double kBandsPerOctave = 8;

/// Mean square of six complex values in each band, by its number.
std::map<int, double> calcBandMisfit(const TestView& view, std::size_t first) {
    std::map<int, std::pair<double, double>> sums;
    for (std::size_t r = first; r < view.runs.size(); ++r) {
        const LinearisedRun& run = view.runs[r];
        for (Eigen::Index b = 0; b < run.mount_residual.cols(); ++b) {
            auto& [square, count] = sums[static_cast<int>(std::floor(kBandsPerOctave * std::log2(run.frequency[b])))];
            square += run.mount_residual.col(b).squaredNorm();
            count += 6;
        }
    }
    std::map<int, double> misfit;
    for (const auto& [band, sum] : sums) misfit[band] = sum.first / sum.second;
    return misfit;
}

}  // namespace

MisfitSpectrum calcMisfitSpectrum(const TestView& before, const TestView& after, std::size_t first) {
    MisfitSpectrum spectrum;
    const std::map<int, double> with = calcBandMisfit(after, first);
    for (const auto& [band, misfit] : calcBandMisfit(before, first)) {
        const auto own = with.find(band);
        if (own == with.end()) continue;
        spectrum.frequency.push_back(std::exp2((band + 0.5) / kBandsPerOctave));
        spectrum.before.push_back(misfit);
        spectrum.after.push_back(own->second);
    }
    return spectrum;
}

}  // namespace wems::identify::updating
