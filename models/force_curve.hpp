/// @file
/// A measured force curve: force over displacement, between its rows by a spline that does not overshoot.
///
/// Between two rows the cubic through both with their slopes (Hermite). A slope that a row does not give comes from its
/// neighbours: zero where the curve turns, otherwise the weighted harmonic mean of the slopes on both sides (Fritsch
/// and Butland 1984, doi:10.1137/0905021), so that the curve rises and falls with its rows alone. Beyond its ends it
/// goes on with the slope there. The force is C¹ in the displacement and has a potential: a curve loses nothing.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace wems {

/// One measured point.
struct CurveRow {
    double displacement = 0;          ///< m
    double force = 0;                 ///< N
    std::optional<double> stiffness;  ///< slope there, N/m; absent: from the neighbours
};

/// What is wrong with rows, and what is accepted; nullopt if nothing is. Two rows at least, ascending displacements,
/// and one of them at zero displacement with zero force: the element counts its displacement from where it exerts
/// nothing.
struct CurveProblem {
    std::string problem, accepted;
    int row = -1;  ///< from 0; −1: the list as a whole
};
std::optional<CurveProblem> findProblem(const std::vector<CurveRow>& rows);

/// A curve prepared for evaluation. Default-constructed, or of no rows: no force.
class ForceCurve {
public:
    ForceCurve() = default;
    /// @param rows without a problem
    explicit ForceCurve(const std::vector<CurveRow>& rows);

    /// Cubics between rows; 0 if there is no curve.
    int segments() const { return static_cast<int>(segments_.size()); }
    double calcForce(double q) const;      ///< N
    double calcStiffness(double q) const;  ///< N/m
    double calcPotential(double q) const;  ///< J, from zero displacement
    double largestStiffness() const;       ///< N/m, the steepest slope
    /// Appends the constants that calcCurveForce() (models/axis_terms.hpp) reads.
    void appendConstants(std::vector<double>& constants) const;

private:
    /// Force over x = q − from: value + x (slope + x (square + x cube)).
    struct Segment {
        double from, length, value, slope, square, cube;
        double calcForce(double x) const { return value + x * (slope + x * (square + x * cube)); }
        double calcStiffness(double x) const { return slope + x * (2 * square + 3 * cube * x); }
        double calcWork(double x) const { return x * (value + x * (slope / 2 + x * (square / 3 + x * cube / 4))); }
    };
    double calcWorkFromStart(double q) const;

    std::vector<Segment> segments_;
    double last_ = 0, last_force_ = 0, last_slope_ = 0;  // of the last row
    double work_to_rest_ = 0;                            // from the first row to zero displacement, J
};

/// The rows less what a spring of that stiffness does.
std::vector<CurveRow> subtractSpring(std::vector<CurveRow> rows, double stiffness);

}  // namespace wems
