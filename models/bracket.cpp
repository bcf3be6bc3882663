#include "models/bracket.hpp"

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"
#include "models/common/units.hpp"

namespace wems {

namespace {

/// shape · coordinates. A column at a time: there are few, perhaps none, and Eigen's general kernels cost more.
Eigen::Vector3d combine(const Eigen::Matrix3Xd& shape, const Eigen::Ref<const Eigen::VectorXd>& coordinates) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (Eigen::Index j = 0; j < shape.cols(); ++j) sum += shape.col(j) * coordinates[j];
    return sum;
}

}  // namespace

Bracket::Bracket(std::vector<BracketMode> modes) : modes_(std::move(modes)) {
    const Eigen::Index n = modes_.size();
    for (auto* shape : {&translation_, &rotation_, &load_, &base_}) shape->resize(3, n);
    omega_squared_.resize(n);
    two_zeta_omega_.resize(n);
    for (Eigen::Index j = 0; j < n; ++j) {
        const BracketMode& mode = modes_[j];
        const double omega = kTwoPi * mode.frequency;
        translation_.col(j) = mode.translation;
        rotation_.col(j) = mode.rotation;
        load_.col(j) = mode.load_translation;
        base_.col(j) = mode.base_participation;
        omega_squared_[j] = omega * omega;
        two_zeta_omega_[j] = 2 * mode.damping_ratio * omega;
    }
}

Bracket::Kinematics Bracket::calcKinematics(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                            const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    Eigen::Vector3d theta = Eigen::Vector3d::Zero(), theta_dot = theta, p = theta, v = theta;
    for (Eigen::Index j = 0; j < eta.size(); ++j) {
        theta += eta[j] * rotation_.col(j);
        theta_dot += eta_dot[j] * rotation_.col(j);
        p += eta[j] * translation_.col(j);
        v += eta_dot[j] * translation_.col(j);
    }
    Kinematics result;
    result.jacobian = leftJacobian(theta);
    // exp(K) = 1 + K B, since B is the series of exp with every term divided by K once.
    result.motion.R_GF = Eigen::Matrix3d::Identity() + crossMatrix(theta) * result.jacobian;
    result.motion.p_GF = p;
    result.motion.w_GF = result.jacobian * theta_dot;
    result.motion.v_GF = v;
    return result;
}

FrameMotion Bracket::calcMotion(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    return calcKinematics(eta, eta_dot).motion;
}

Bracket::FrameAcceleration Bracket::calcAcceleration(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                                     const Eigen::Ref<const Eigen::VectorXd>& eta_dot,
                                                     const Eigen::Ref<const Eigen::VectorXd>& eta_dot_dot) const {
    const Eigen::Vector3d theta = combine(rotation_, eta);
    const Eigen::Vector3d theta_dot = combine(rotation_, eta_dot);
    const Eigen::Vector3d theta_dot_dot = combine(rotation_, eta_dot_dot);
    return {leftJacobian(theta) * theta_dot_dot + leftJacobianRate(theta, theta_dot) * theta_dot,
            combine(translation_, eta_dot_dot)};
}

Eigen::MatrixXd Bracket::calcFrameJacobian(const Eigen::Matrix3d& jacobian) const {
    Eigen::MatrixXd J(6, modeCount());
    J << translation_, jacobian * rotation_;
    return J;
}

void Bracket::calcAccelerations(const Eigen::Ref<const Eigen::VectorXd>& eta,
                                const Eigen::Ref<const Eigen::VectorXd>& eta_dot, const Wrench& at_interface,
                                const Eigen::Vector3d& load, const Eigen::Vector3d& base_acceleration,
                                // A Ref is a view to write through. NOLINTNEXTLINE(performance-unnecessary-value-param)
                                Eigen::Ref<Eigen::VectorXd> eta_dot_dot) const {
    const Eigen::Vector3d theta = combine(rotation_, eta);
    calcAccelerations(leftJacobian(theta), eta, eta_dot, at_interface, load, base_acceleration, eta_dot_dot);
}

void Bracket::calcAccelerations(const Eigen::Matrix3d& jacobian, const Eigen::Ref<const Eigen::VectorXd>& eta,
                                const Eigen::Ref<const Eigen::VectorXd>& eta_dot, const Wrench& at_interface,
                                const Eigen::Vector3d& load, const Eigen::Vector3d& base_acceleration,
                                Eigen::Ref<Eigen::VectorXd> eta_dot_dot) const {
    const Eigen::Vector3d torque = jacobian.transpose() * at_interface.moment;
    for (Eigen::Index j = 0; j < eta.size(); ++j) {
        eta_dot_dot[j] = translation_.col(j).dot(at_interface.force) + rotation_.col(j).dot(torque) +
                         load_.col(j).dot(load) - base_.col(j).dot(base_acceleration) -
                         two_zeta_omega_[j] * eta_dot[j] - omega_squared_[j] * eta[j];
    }
}

double Bracket::calcEnergy(const Eigen::Ref<const Eigen::VectorXd>& eta,
                           const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    return 0.5 * (eta_dot.squaredNorm() + (omega_squared_.array() * eta.array().square()).sum());
}

double Bracket::calcDissipatedPower(const Eigen::Ref<const Eigen::VectorXd>& eta_dot) const {
    return (two_zeta_omega_.array() * eta_dot.array().square()).sum();
}

namespace {

constexpr const char* required_header = "frequency [Hz],damping_ratio,ux,uy,uz,rx,ry,rz,load.ux,load.uy,load.uz";
constexpr const char* base_header = ",base.ux,base.uy,base.uz";

/// The beginning of a text, for a message.
std::string quote(std::string_view text) {
    constexpr std::size_t longest = 60;
    return "\"" + std::string(text.substr(0, longest)) + (text.size() > longest ? "…\"" : "\"");
}

double parseNumber(std::string_view cell, const InputLocation& location) {
    if (cell.empty()) throw InputError(location, "the cell is empty", "a number with a decimal point");
    const bool plus = cell.front() == '+' && cell.substr(0, 2) != "+-";  // from_chars knows no plus sign
    const std::string_view digits = cell.substr(plus ? 1 : 0);
    double value = 0;
    const auto [end, error] = fast_float::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
        throw InputError(location, "is " + quote(cell), "a finite number with a decimal point");
    }
    return value;
}

BracketMode makeMode(const std::vector<double>& values) {
    BracketMode mode;
    mode.frequency = values[0];
    mode.damping_ratio = values[1];
    mode.translation = {values[2], values[3], values[4]};
    mode.rotation = {values[5], values[6], values[7]};
    mode.load_translation = {values[8], values[9], values[10]};
    if (values.size() > 11) mode.base_participation = {values[11], values[12], values[13]};
    return mode;
}

}  // namespace

std::vector<BracketMode> parseBracketModes(std::string_view text, const std::string& file) {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (text.substr(0, byte_order_mark.size()) == byte_order_mark) text.remove_prefix(byte_order_mark.size());

    const std::string accepted_header = std::string(required_header) + ", optionally followed by " + base_header;
    const std::vector<std::string_view> required = splitCells(required_header, ',');
    std::vector<std::string_view> columns = required;
    for (const std::string_view name : splitCells(base_header + 1, ',')) columns.push_back(name);

    std::vector<std::string_view> header;
    std::vector<BracketMode> modes;
    for (long line_number = 1; !text.empty(); ++line_number) {
        const auto end = text.find('\n');
        const std::string_view line = trim(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        if (line.empty() || line.front() == '#') continue;
        const std::vector<std::string_view> cells = splitCells(line, ',');
        if (header.empty()) {
            const bool known = cells == required || cells == columns;
            if (!known) throw InputError({file, line_number, "header"}, "is " + quote(line), accepted_header);
            header = cells;
            continue;
        }
        if (cells.size() != header.size()) {
            throw InputError({file, line_number, {}}, "has " + std::to_string(cells.size()) + " cells",
                             std::to_string(header.size()) + " as in the header");
        }
        std::vector<double> values;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const InputLocation location{file, line_number, std::string(header[i])};
            values.push_back(parseNumber(cells[i], location));
            if (i == 0 && !(values[i] > 0)) throw InputError(location, "is " + std::string(cells[i]), "above 0");
            if (i == 1 && !(values[i] >= 0)) throw InputError(location, "is " + std::string(cells[i]), "from 0 on");
        }
        modes.push_back(makeMode(values));
    }
    if (header.empty()) throw InputError({file, 0, "header"}, "is missing", accepted_header);
    if (modes.empty()) throw InputError({file, 0, {}}, "has no modes", "a row for each mode below the header");
    return modes;
}

std::string formatBracketModes(const std::vector<BracketMode>& modes) {
    const bool with_base = std::any_of(modes.begin(), modes.end(),
                                       [](const BracketMode& mode) { return !mode.base_participation.isZero(0); });
    std::string text = std::string(required_header) + (with_base ? base_header : "") + "\n";
    for (const BracketMode& mode : modes) {
        text += formatNumber(mode.frequency) + "," + formatNumber(mode.damping_ratio);
        const auto append = [&text](const Eigen::Vector3d& shape) {
            for (const double value : shape) text += "," + formatNumber(value);
        };
        append(mode.translation);
        append(mode.rotation);
        append(mode.load_translation);
        if (with_base) append(mode.base_participation);
        text += "\n";
    }
    return text;
}

std::vector<BracketMode> readBracketModes(const std::string& file) {
    return parseBracketModes(TextFile(file).view(), file);
}

}  // namespace wems
