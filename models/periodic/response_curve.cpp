#include "models/periodic/response_curve.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"
#include "models/periodic/continuation.hpp"

namespace wems {
namespace {

/// Of the amplitude. A channel's gain is known to 1 %; without a limit, lines at 100 N were 2.3 % off the dwells.
constexpr double kLargestGap = 2e-3;

/// Displacements of all connections over a period from the coefficients of all coordinates.
class PeriodOfMotion {
public:
    PeriodOfMotion(const LinearSystem& system, int harmonics) {
        for (const Eigen::MatrixXd& end : system.ends) {
            rows_.conservativeResize(rows_.rows() + 3, system.mass.rows());
            rows_.bottomRows(3) = end;
        }
        constexpr int samples = 256;
        phases_.resize(harmonics + 1, samples);
        for (int k = 0; k <= harmonics; ++k)
            for (int i = 0; i < samples; ++i) phases_(k, i) = std::polar(1.0, kTwoPi * k * i / samples);
    }
    void measure(const Eigen::MatrixXcd& motion, ResponsePoint& point) const {
        const Eigen::MatrixXcd coefficients = rows_ * motion;
        const Eigen::MatrixXd q = (coefficients * phases_).real();
        point.highest = q.rowwise().maxCoeff();
        point.lowest = q.rowwise().minCoeff();
        point.amplitude = 0.5 * (point.highest - point.lowest);
        point.first = coefficients.col(1).cwiseAbs();
    }

private:
    Eigen::MatrixXd rows_;
    Eigen::MatrixXcd phases_;
};

void findPenetration(const PeriodicSystem& system, ResponsePoint& point) {
    const MountModel& model = system.model();
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const AxisLaw& law = model.connections[i].axis[k];
            const Eigen::Index row = 3 * i + k;
            const double rest = system.rest()(k, i) + law.offset;
            for (const Stop& stop : law.stops) {
                const double reach =
                    stop.side == Side::positive ? point.highest[row] + rest : -(point.lowest[row] + rest);
                point.penetration.push_back(std::max(0.0, reach - stop.clearance));
            }
        }
}

/// Where a cubic through two points with known slopes has its turning point, as a share of the way between them.
double findTurn(double f0, double f1, double slope0, double slope1, double length) {
    const double a = slope0 * length, b = slope1 * length, d = f1 - f0;
    // f' = A u² + B u + a for u from 0 to 1
    const double A = 3 * (a + b - 2 * d), B = 2 * (3 * d - 2 * a - b);
    const double root = std::sqrt(std::max(0.0, B * B - 4 * A * a));
    for (const double u : {(-B + root) / (2 * A), (-B - root) / (2 * A), -a / B})
        if (u >= 0 && u <= 1) return u;
    return slope0 / (slope0 - slope1);
}

double evaluateCubic(double f0, double f1, double slope0, double slope1, double length, double u) {
    const double a = slope0 * length, b = slope1 * length, d = f1 - f0;
    return f0 + a * u + (3 * d - 2 * a - b) * u * u + (a + b - 2 * d) * u * u * u;
}

/// Points, folds and bifurcations of one curve from its solutions.
class CurveMeasurer {
public:
    CurveMeasurer(const PeriodicSystem& system, const HarmonicBalance& balance, const Continuation& continuation,
                  const ResponseSettings& settings)
        : system_(system),
          balance_(balance),
          continuation_(continuation),
          period_(system.linear(), settings.harmonics),
          stability_(settings.stability) {
        curve.harmonics = settings.harmonics;
    }

    void add(const CurvePoint& now) {
        ResponsePoint point;
        point.frequency = now.parameter;
        period_.measure(balance_.calcMotion(now.Q, now.parameter), point);
        findPenetration(system_, point);
        if (stability_) {
            const Eigen::VectorXcd multipliers = calcFloquetMultipliers(balance_, now.Q, now.parameter);
            point.largest_multiplier = std::abs(multipliers[0]);
            point.instability = findInstability(multipliers);
        }
        if (!curve.points.empty()) addChanges(now, point);
        curve.points.push_back(std::move(point));
        before_ = now;
    }

    ResponseCurve curve;

private:
    void addChanges(const CurvePoint& now, const ResponsePoint& point) {
        const ResponsePoint& last = curve.points.back();
        if (before_.along_parameter * now.along_parameter < 0) {
            const double unit = continuation_.parameterUnit(), length = now.length - before_.length;
            const double slope0 = unit * before_.along_parameter, slope1 = unit * now.along_parameter;
            const double u = findTurn(before_.parameter, now.parameter, slope0, slope1, length);
            curve.folds.push_back({evaluateCubic(before_.parameter, now.parameter, slope0, slope1, length, u),
                                   (1 - u) * last.amplitude + u * point.amplitude});
        }
        const bool was = last.instability != Instability::none, is = point.instability != Instability::none;
        if (was == is) return;
        const double u =
            std::clamp((1 - last.largest_multiplier) / (point.largest_multiplier - last.largest_multiplier), 0.0, 1.0);
        curve.bifurcations.push_back(
            {(1 - u) * last.frequency + u * point.frequency, is ? point.instability : last.instability});
    }

    const PeriodicSystem& system_;
    const HarmonicBalance& balance_;
    const Continuation& continuation_;
    PeriodOfMotion period_;
    bool stability_;
    CurvePoint before_;
};

}  // namespace

bool ResponsePoint::touchesStop() const {
    return std::any_of(penetration.begin(), penetration.end(), [](double depth) { return depth > 0; });
}

ResponseCurve calcResponseCurve(const MountModel& model, const HarmonicInput& input, const ResponseSettings& settings) {
    if (!(settings.from > 0 && settings.to > settings.from))
        throw InputError({"", 0, "response"}, "the band is empty", "two ascending frequencies, Hz");
    constexpr int most_harmonics = 100;
    if (settings.harmonics < 1 || settings.harmonics > most_harmonics)
        throw InputError({"", 0, "harmonics"}, "is " + std::to_string(settings.harmonics), "1 to 100");
    const std::clock_t start = std::clock();
    const PeriodicSystem system(model, input);
    if (system.calcForce(settings.from).isZero(0))
        throw InputError({"", 0, "level"}, "moves nothing in this model", "an input that acts on it");
    const HarmonicBalance balance(system, settings.harmonics);
    ContinuationSettings path;
    path.from = settings.from;
    path.to = settings.to;
    path.largest_gap = kLargestGap;
    const Continuation continuation(balance, path);
    CurveMeasurer measurer(system, balance, continuation, settings);
    std::vector<CurvePoint> known;
    const std::string incomplete = continuation.follow([&](const CurvePoint& now) {
        measurer.add(now);
        known.push_back(now);
        if (settings.progress) settings.progress(now.parameter, static_cast<int>(known.size()));
        return true;
    });
    ResponseCurve& curve = measurer.curve;
    if (curve.points.empty())
        throw InputError({"", 0, "response"}, incomplete, "a band that starts elsewhere, or a lower level");
    curve.incomplete = incomplete;
    if (settings.detached) {
        std::vector<double> folds;
        for (const ResponseFold& fold : curve.folds) folds.push_back(fold.frequency);
        DetachedSearch search;
        search.from = settings.from;
        search.to = settings.to;
        for (const DetachedCurve& detached : findDetachedCurves(balance, continuation, known, folds, search)) {
            CurveMeasurer other(system, balance, continuation, settings);
            for (const CurvePoint& point : detached.points) other.add(point);
            other.curve.incomplete = detached.incomplete;
            curve.detached.push_back(std::move(other.curve));
        }
    }
    curve.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    return curve;
}

}  // namespace wems
