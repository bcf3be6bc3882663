#include "models/viscoelastic.hpp"

#include <Eigen/Core>
#include <cmath>

#include "models/common/non_negative.hpp"
#include "models/common/units.hpp"

namespace wems {
namespace {

using Complex = std::complex<double>;

/// With two, spring-pots of exponents from 0.02 to 0.9 from 1 to 2000 Hz are met within 2e-4, with three within 1e-4.
constexpr int kBranchesPerDecade = 2;
/// The grid reaches so far beyond the band, as a factor: what relaxes beyond is a spring or a dashpot within the band.
constexpr double kBeyond = 4;
/// Rows that a spring-pot is sampled at: several for each branch.
constexpr int kRowsPerDecade = 12;

/// s τ / (1 + s τ)
Complex relax(double frequency, double time_constant) {
    const Complex turn(0, kTwoPi * frequency * time_constant);
    return turn / (1.0 + turn);
}

std::vector<double> listTimeConstants(double lower, double upper) {
    const double longest = kBeyond / (kTwoPi * lower), decades = std::log10(kBeyond * kBeyond * upper / lower);
    const int count = static_cast<int>(std::ceil(decades * kBranchesPerDecade)) + 1;
    std::vector<double> grid;
    for (int i = 0; i < count; ++i) grid.push_back(longest * std::pow(10, -decades * i / (count - 1)));
    return grid;
}

}  // namespace

Complex SpringPot::complexStiffness(double at_frequency) const {
    return stiffness * std::pow(Complex(0, at_frequency / frequency), exponent);
}

Complex ViscoelasticSeries::complexStiffness(double frequency) const {
    Complex sum(stiffness, kTwoPi * frequency * damping);
    for (const MaxwellBranch& branch : branches) sum += branch.stiffness * relax(frequency, branch.time_constant);
    return sum;
}

double mostDecades() {
    return static_cast<double>(kMostBranches - 2) / kBranchesPerDecade - 2 * std::log10(kBeyond);
}

namespace {

ViscoelasticSeries fitSeriesWith(bool dashpot, const std::vector<StiffnessRow>& rows) {
    const std::vector<double> grid = listTimeConstants(rows.front().frequency, rows.back().frequency);
    // Columns: spring, dashpot, branches; rows: real and imaginary parts, each over the magnitude that the sheet gives.
    const auto count = static_cast<Eigen::Index>(rows.size()), columns = static_cast<Eigen::Index>(grid.size()) + 2;
    Eigen::MatrixXd X(2 * count, columns);
    Eigen::VectorXd y(2 * count);
    const double middle = std::sqrt(rows.front().frequency * rows.back().frequency);
    for (Eigen::Index n = 0; n < count; ++n) {
        const StiffnessRow& row = rows[n];
        const Complex given = row.complexStiffness();
        const double weight = 1 / std::abs(given);
        const auto set = [&](Eigen::Index column, Complex value) {
            X(n, column) = weight * value.real();
            X(count + n, column) = weight * value.imag();
        };
        set(0, 1);
        set(1, dashpot ? Complex(0, row.frequency / middle) : 0);
        for (std::size_t b = 0; b < grid.size(); ++b)
            set(static_cast<Eigen::Index>(b) + 2, relax(row.frequency, grid[b]));
        y[n] = weight * given.real();
        y[count + n] = weight * given.imag();
    }
    const Eigen::VectorXd size = X.colwise().norm().transpose().cwiseMax(1e-300);
    const Eigen::MatrixXd scaled = X * size.cwiseInverse().asDiagonal();
    const Eigen::VectorXd solution =
        solveNonNegative(scaled.transpose() * scaled, scaled.transpose() * y, std::vector<bool>(columns, true))
            .cwiseQuotient(size);
    ViscoelasticSeries series;
    series.stiffness = solution[0];
    series.damping = solution[1] / (kTwoPi * middle);
    for (std::size_t b = 0; b < grid.size(); ++b)
        if (const double stiffness = solution[static_cast<Eigen::Index>(b) + 2]; stiffness > 0)
            series.branches.push_back({stiffness, grid[b]});
    for (const StiffnessRow& row : rows) {
        const Complex given = row.complexStiffness();
        const double error = std::abs(series.complexStiffness(row.frequency) - given) / std::abs(given);
        if (!(error <= series.largest_error)) series.largest_error = error;  // not a number is the largest
    }
    return series;
}

}  // namespace

ViscoelasticSeries fitSeries(const std::vector<StiffnessRow>& rows) {
    // Branches follow the stiffness when it is moved, a dashpot does not: one that hardly helps is left out.
    constexpr double hardly = 5e-3;  // less than what a sheet is read to
    const ViscoelasticSeries with = fitSeriesWith(true, rows), without = fitSeriesWith(false, rows);
    return without.largest_error <= with.largest_error + hardly ? without : with;
}

ViscoelasticSeries makeSeries(const SpringPot& pot) {
    const double decades = std::log10(pot.band.upper / pot.band.lower);
    const int count = static_cast<int>(std::ceil(decades * kRowsPerDecade)) + 2;
    std::vector<StiffnessRow> rows;
    for (int i = 0; i < count; ++i) {
        const double f = pot.band.lower * std::pow(pot.band.upper / pot.band.lower, i / (count - 1.0));
        const Complex K = pot.complexStiffness(f);
        rows.push_back({f, K.real(), K.imag() / K.real()});
    }
    return fitSeries(rows);
}

}  // namespace wems
