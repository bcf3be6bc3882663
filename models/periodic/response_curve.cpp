#include "models/periodic/response_curve.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/periodic/continuation.hpp"
#include "models/pi.hpp"

namespace wems {
namespace {

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
            const auto row = static_cast<Eigen::Index>(3 * i + k);
            const double rest = system.rest()(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)) + law.offset;
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
    const auto start = std::chrono::steady_clock::now();
    const PeriodicSystem system(model, input);
    if (system.calcForce(settings.from).isZero(0))
        throw InputError({"", 0, "level"}, "moves nothing in this model", "an input that acts on it");
    const HarmonicBalance balance(system, settings.harmonics);
    ContinuationSettings path;
    path.from = settings.from;
    path.to = settings.to;
    const Continuation continuation(balance, path);
    const PeriodOfMotion period(system.linear(), settings.harmonics);
    ResponseCurve curve;
    curve.harmonics = settings.harmonics;
    CurvePoint before;
    curve.incomplete = continuation.follow([&](const CurvePoint& now) {
        ResponsePoint point;
        point.frequency = now.frequency;
        period.measure(balance.calcMotion(now.Q, now.frequency), point);
        findPenetration(system, point);
        if (settings.stability) {
            const Eigen::VectorXcd multipliers = calcFloquetMultipliers(balance, now.Q, now.frequency);
            point.largest_multiplier = std::abs(multipliers[0]);
            point.instability = findInstability(multipliers);
        }
        if (!curve.points.empty() && before.along_frequency * now.along_frequency < 0) {
            const double unit = continuation.frequencyUnit(), length = now.length - before.length;
            const double slope0 = unit * before.along_frequency, slope1 = unit * now.along_frequency;
            const double u = findTurn(before.frequency, now.frequency, slope0, slope1, length);
            curve.folds.push_back({evaluateCubic(before.frequency, now.frequency, slope0, slope1, length, u),
                                   (1 - u) * curve.points.back().amplitude + u * point.amplitude});
        }
        curve.points.push_back(std::move(point));
        before = now;
        if (settings.progress) settings.progress(now.frequency, static_cast<int>(curve.points.size()));
        return true;
    });
    curve.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return curve;
}

}  // namespace wems
