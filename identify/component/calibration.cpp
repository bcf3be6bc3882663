#include "identify/component/calibration.hpp"

#include <cmath>

#include "identify/component/block_regression.hpp"
#include "identify/component/component_fit.hpp"
#include "identify/verdict/diagnosis.hpp"
#include "models/common/format_number.hpp"
#include "models/model_tolerance.hpp"

namespace wems::identify {
namespace {

/// Of `letter` as a word of `text`: `m` of `s/m^3` is 3.
int powerOf(char letter, const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool begins = i == 0 || text[i - 1] == ' ', ends = i + 1 == text.size() || text[i + 1] == ' ';
        if (text[i] != letter || !begins) continue;
        if (ends) return 1;
        if (text[i + 1] == '^') return text[i + 2] - '0';
    }
    return 0;
}

}  // namespace

GainTolerances gainTolerancesOf(ForceSource source, const MountModel& model) {
    const double gain = toleranceOf(model, ToleranceOf::sensor_gain);
    if (source == ForceSource::recorded) return {gain, gain};
    return {std::hypot(gain, toleranceOf(model, ToleranceOf::mass, model.body.tolerances)), gain};
}

double calcGainDeviation(const std::string& unit, const GainTolerances& gains) {
    const auto slash = unit.find('/');
    const std::string above = unit.substr(0, slash), below = slash == std::string::npos ? "" : unit.substr(slash + 1);
    const int force = powerOf('N', above) - powerOf('N', below), length = powerOf('m', above) - powerOf('m', below);
    return 0.5 * std::hypot(force * gains.force, length * gains.displacement);
}

std::array<double, 2> calcIntervalWithGains(const ComponentParameter& parameter, const GainTolerances& gains) {
    const double half = std::hypot(0.5 * (parameter.upper - parameter.lower),
                                   kTwoSided95 * calcGainDeviation(parameter.unit, gains) * parameter.value);
    const double middle = 0.5 * (parameter.upper + parameter.lower);
    return {middle - half, middle + half};
}

ForceComparison compareForces(const Eigen::VectorXd& time, const Eigen::VectorXd& first,
                              const Eigen::VectorXd& second) {
    // To first order a delay is the slope of the force in time.
    const Eigen::Index count = first.size() - 2;
    Eigen::MatrixXd columns(count, 3);
    columns.col(0).setOnes();
    columns.col(1) = first.segment(1, count);
    columns.col(2) = (first.tail(count) - first.head(count)).cwiseQuotient(time.tail(count) - time.head(count));
    const Estimates e = solveBlocks(columns, second.segment(1, count), {0});
    return {e.value[1], e.calcHalfWidth(1), -e.value[2] / e.value[1], e.calcHalfWidth(2) / std::abs(e.value[1])};
}

std::string describe(const ForceComparison& comparison, const GainTolerances& gains) {
    const double excess = comparison.gain - 1;
    const std::string text = "mass x acceleration is " + formatNumber(100 * comparison.gain, 4) + " ± " +
                             formatNumber(100 * comparison.gain_half_width, 2) + " % of the recorded force and " +
                             formatNumber(1e3 * std::abs(comparison.delay), 2) + " ± " +
                             formatNumber(1e3 * comparison.delay_half_width, 1) +
                             (comparison.delay < 0 ? " ms early" : " ms late");
    // The recorded force has a gain of its own.
    const double allowed = std::hypot(gains.force, gains.displacement);
    if (std::abs(excess) <= allowed + comparison.gain_half_width)
        return text + ": within what gains and mass allow (" + formatNumber(100 * allowed, 2) + " %)";
    return text + ": gains and mass allow " + formatNumber(100 * allowed, 2) +
           " %, so that the scale of the accelerometer, of the force or the mass is off";
}

}  // namespace wems::identify
