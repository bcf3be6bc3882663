#include "identify/solve/evidence.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace wems::identify {

namespace {

double logDeterminant(const Eigen::LLT<Eigen::MatrixXd>& factor) {
    return 2 * factor.matrixLLT().diagonal().array().log().sum();
}

}  // namespace

std::vector<Direction> makeTolerances(const Eigen::VectorXd& deviation) {
    std::vector<Direction> tolerances;
    for (Eigen::Index i = 0; i < deviation.size(); ++i)
        if (deviation[i] > 0) tolerances.push_back({{static_cast<int>(i), deviation[i]}});
    return tolerances;
}

Evidence::Evidence(const BlockInformation& information, const std::vector<Direction>& tolerances,
                   const std::vector<Hypothesis>& hypotheses)
    : information_(information), hypotheses_(&hypotheses), tolerances_(tolerances.size()) {
    std::vector<const Direction*> all;
    for (const Direction& tolerance : tolerances) all.push_back(&tolerance);
    for (const Hypothesis& hypothesis : hypotheses) {
        first_.push_back(all.size());
        for (const Direction& direction : hypothesis.directions) all.push_back(&direction);
    }
    first_.push_back(all.size());
    // Most directions move one column.
    std::vector<Eigen::Triplet<double>> weights;
    for (std::size_t d = 0; d < all.size(); ++d)
        for (const auto& [column, weight] : *all[d]) weights.emplace_back(column, static_cast<int>(d), weight);
    Eigen::SparseMatrix<double> directions(information.b.size(), static_cast<Eigen::Index>(all.size()));
    directions.setFromTriplets(weights.begin(), weights.end());
    const Eigen::MatrixXd moved = information.A * directions;
    gram_ = directions.transpose() * moved;
    right_ = -(directions.transpose() * information.b);
    directions_ = directions;
}

std::vector<Eigen::Index> Evidence::findRows(const HypothesisSet& set) const {
    std::vector<Eigen::Index> rows;
    for (Eigen::Index i = 0; i < tolerances_; ++i) rows.push_back(i);
    for (const int h : set)
        for (Eigen::Index d = first_[h]; d < first_[static_cast<std::size_t>(h) + 1]; ++d) rows.push_back(d);
    return rows;
}

double Evidence::calcOdds(const HypothesisSet& set) const {
    double sum = 0;
    for (const int h : set) sum += (*hypotheses_)[h].log_prior;
    return sum;
}

bool Evidence::mayJoin(const HypothesisSet& set, int hypothesis) const {
    const Hypothesis& joining = (*hypotheses_)[hypothesis];
    return std::none_of(set.begin(), set.end(), [&](int member) {
        const Hypothesis& other = (*hypotheses_)[member];
        if (member == hypothesis) return true;
        return other.cause == joining.cause &&
               std::any_of(other.where.begin(), other.where.end(), [&](const std::string& place) {
                   return std::find(joining.where.begin(), joining.where.end(), place) != joining.where.end();
               });
    });
}

double Evidence::calcChange(const Eigen::VectorXd& estimate) const {
    return 2 * information_.b.dot(estimate) + estimate.dot(information_.A * estimate);
}

double Evidence::calcLogEvidence(const HypothesisSet& set) const {
    const auto rows = findRows(set);
    Eigen::MatrixXd H = gram_(rows, rows);
    H.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    const Eigen::VectorXd g = right_(rows);
    return 0.5 * g.dot(factor.solve(g)) - 0.5 * logDeterminant(factor) + calcOdds(set);
}

SetSolution Evidence::solve(const HypothesisSet& set) const {
    const auto rows = findRows(set);
    Eigen::MatrixXd H = gram_(rows, rows);
    H.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    const Eigen::VectorXd z = factor.solve(right_(rows));
    return {directions_(Eigen::all, rows) * z, z.squaredNorm(), calcOdds(set) - 0.5 * logDeterminant(factor)};
}

Eigen::VectorXd Evidence::solveNear(const HypothesisSet& set, const Eigen::VectorXd& slope, double damping) const {
    const auto rows = findRows(set);
    const Eigen::MatrixXd V = directions_(Eigen::all, rows);
    Eigen::MatrixXd H = gram_(rows, rows);
    H.diagonal().array() += 1 + damping;
    return V * H.llt().solve(right_(rows) + damping * (V.transpose() * slope));
}

Posterior Evidence::calcPosterior(const HypothesisSet& set) const {
    const auto rows = findRows(set);
    const Eigen::MatrixXd V = directions_(Eigen::all, rows);
    Eigen::MatrixXd H = gram_(rows, rows);
    H.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    const Eigen::VectorXd g = right_(rows), z = factor.solve(g);
    Posterior posterior;
    posterior.mean = V * z;
    posterior.covariance = V * factor.solve(V.transpose());
    posterior.log_evidence = 0.5 * g.dot(z) - 0.5 * logDeterminant(factor) + calcOdds(set);
    return posterior;
}

std::vector<double> Evidence::calcExtensions(const HypothesisSet& set) const {
    const auto rows = findRows(set);
    const Eigen::Index count = directions_.cols() - tolerances_;
    Eigen::MatrixXd H = gram_(rows, rows);
    H.diagonal().array() += 1;
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    const Eigen::VectorXd g = right_(rows), z = factor.solve(g);
    const double base = 0.5 * g.dot(z) - 0.5 * logDeterminant(factor) + calcOdds(set);
    const Eigen::MatrixXd cross = gram_(rows, Eigen::seqN(tolerances_, count));
    const Eigen::MatrixXd solved = factor.matrixL().solve(cross);
    const Eigen::VectorXd beta = right_.tail(count) - cross.transpose() * z;
    std::vector<double> result(hypotheses_->size(), -std::numeric_limits<double>::infinity());
    for (std::size_t h = 0; h < hypotheses_->size(); ++h) {
        if (!mayJoin(set, static_cast<int>(h))) continue;
        const Eigen::Index first = first_[h], size = first_[h + 1] - first;
        Eigen::MatrixXd S =
            gram_.block(first, first, size, size) -
            solved.middleCols(first - tolerances_, size).transpose() * solved.middleCols(first - tolerances_, size);
        S.diagonal().array() += 1;
        const Eigen::LLT<Eigen::MatrixXd> own(S);
        const Eigen::VectorXd b = beta.segment(first - tolerances_, size);
        result[h] = base + 0.5 * b.dot(own.solve(b)) - 0.5 * logDeterminant(own) + (*hypotheses_)[h].log_prior;
    }
    return result;
}

std::vector<RankedSet> Evidence::search(const std::vector<HypothesisSet>& starts, std::size_t width,
                                        std::size_t largest) const {
    std::map<HypothesisSet, double> known;
    std::set<HypothesisSet> expanded;
    const auto remember = [&](const HypothesisSet& set) {
        if (known.count(set) == 0) known[set] = calcLogEvidence(set);
    };
    remember({});
    for (const auto& start : starts) remember(start);
    const auto best = [&](std::size_t count) {
        std::vector<RankedSet> ranked;
        for (const auto& [members, evidence] : known) ranked.push_back({members, evidence});
        std::sort(ranked.begin(), ranked.end(),
                  [](const RankedSet& a, const RankedSet& b) { return a.log_evidence > b.log_evidence; });
        if (ranked.size() > count) ranked.resize(count);
        return ranked;
    };
    for (bool changed = true; changed;) {
        changed = false;
        for (const RankedSet& ranked : best(width)) {
            if (!expanded.insert(ranked.members).second) continue;
            changed = true;
            // Without each member, which also opens the way to exchanges; then what joins best.
            for (std::size_t i = 0; i < ranked.members.size(); ++i) {
                HypothesisSet less = ranked.members;
                less.erase(less.begin() + static_cast<long>(i));
                remember(less);
                if (!expanded.insert(less).second) continue;
                const auto joined = calcExtensions(less);
                for (std::size_t h = 0; h < joined.size(); ++h) {
                    if (!std::isfinite(joined[h])) continue;
                    HypothesisSet more = less;
                    more.insert(std::lower_bound(more.begin(), more.end(), static_cast<int>(h)), static_cast<int>(h));
                    known.emplace(more, joined[h]);
                }
            }
            if (ranked.members.size() >= largest) continue;
            const auto joined = calcExtensions(ranked.members);
            for (std::size_t h = 0; h < joined.size(); ++h) {
                if (!std::isfinite(joined[h])) continue;
                HypothesisSet more = ranked.members;
                more.insert(std::lower_bound(more.begin(), more.end(), static_cast<int>(h)), static_cast<int>(h));
                known.emplace(more, joined[h]);
            }
        }
    }
    return best(known.size());
}

BlockInformation shiftToBelieved(const BlockInformation& about_state, const Eigen::VectorXd& offset) {
    BlockInformation shifted = about_state;
    if (shifted.empty()) return shifted;
    const Eigen::VectorXd moved = about_state.A * offset;
    shifted.chi_squared += 2 * about_state.b.dot(offset) + offset.dot(moved);
    shifted.b += moved;
    if (shifted.noise.size() > 0) {
        if (shifted.noise_right.size() == 0) shifted.noise_right = Eigen::VectorXd::Zero(offset.size());
        shifted.noise_right -= shifted.noise * offset;
    }
    if (shifted.growth.size() > 0) {
        if (shifted.growth_right.size() == 0) shifted.growth_right = Eigen::VectorXd::Zero(offset.size());
        shifted.growth_right -= shifted.growth * offset;
    }
    return shifted;
}

Information shiftToBelieved(const Information& about_state, const Eigen::VectorXd& offset) {
    Information shifted;
    for (std::size_t k = 0; k < kBlocks; ++k) shifted[k] = shiftToBelieved(about_state[k], offset);
    return shifted;
}

Eigen::VectorXd calcPriorSlope(const std::vector<Direction>& directions, const Eigen::VectorXd& estimate) {
    // Most columns are moved by one direction, which moves nothing else.
    std::vector<char> linked(estimate.size(), 0), seen(estimate.size(), 0);
    for (const Direction& direction : directions)
        for (const auto& [column, weight] : direction)
            if (std::exchange(seen[column], 1) != 0 || direction.size() > 1) linked[column] = 1;
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(estimate.size());
    std::vector<Eigen::Index> columns, place(estimate.size(), -1);
    for (Eigen::Index i = 0; i < estimate.size(); ++i)
        if (linked[i] != 0) {
            place[i] = columns.size();
            columns.push_back(i);
        }
    Eigen::MatrixXd C = Eigen::MatrixXd::Zero(columns.size(), columns.size());
    for (const Direction& direction : directions)
        for (const auto& [column, weight] : direction) {
            if (linked[column] == 0) slope[column] = estimate[column] / (weight * weight);
            for (const auto& [other, own] : direction)
                if (linked[column] != 0) C(place[column], place[other]) += weight * own;
        }
    if (columns.empty()) return slope;
    const Eigen::VectorXd size = C.diagonal().cwiseSqrt();
    const Eigen::MatrixXd scaled = size.cwiseInverse().asDiagonal() * C * size.cwiseInverse().asDiagonal();
    slope(columns) = size.cwiseInverse().cwiseProduct(
        scaled.completeOrthogonalDecomposition().solve(estimate(columns).cwiseQuotient(size)));
    return slope;
}

Eigen::MatrixXd calcCovarianceRoot(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const Eigen::VectorXd inverse = deviation.unaryExpr([](double own) { return own > 0 ? 1 / own : 0.0; });
    const Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(correlation);
    return deviation.asDiagonal() * solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

double calcBlockMisfit(const BlockInformation& block, const Eigen::VectorXd& estimate) {
    if (block.empty()) return 0;
    return (block.chi_squared + 2 * block.b.dot(estimate) + estimate.dot(block.A * estimate)) / block.count;
}

}  // namespace wems::identify
