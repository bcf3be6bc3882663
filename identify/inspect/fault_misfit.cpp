#include "identify/inspect/fault_misfit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace wems::identify {
namespace {

constexpr double kCellRidge = 1e-9;      // of the trace: channels that leave motions open are no error
constexpr double kLeastLeverage = 0.02;  // 1 − h_cc: below, the others say nothing about the channel in a cell

/// Corrected channels over their floors in one cell, and the projection on rigid motions.
struct WeighedCell {
    Eigen::MatrixXd B;   // design over floor, channels x 6
    Eigen::MatrixXcd S;  // corrected S over both floors
    Eigen::LLT<Eigen::Matrix<double, 6, 6>> normal;

    double calcLeft() const {
        const Eigen::MatrixXd power = S.real();
        const Eigen::Matrix<double, 6, 6> seen = B.transpose() * power * B;
        return power.trace() - normal.solve(seen).trace();
    }
    /// Projection on rigid motions, as `telling` tells of them.
    Eigen::MatrixXd project(const Eigen::MatrixXd& telling) const { return B * normal.solve(telling.transpose()); }
    static Eigen::MatrixXd mute(Eigen::MatrixXd rows, const std::vector<std::size_t>& muted) {
        for (const std::size_t c : muted) rows.row(c).setZero();
        return rows;
    }
};

std::size_t kindOf(const PartCells& part, std::size_t channel) {
    return part.channels[channel].derivative == Derivative::acceleration ? 1 : 0;
}

/// Power of a typical corrected channel of each kind: the median.
std::array<double, 2> findLevels(const PartCells& part, const PartState& state, const Cell& cell) {
    std::array<std::vector<double>, 2> powers;
    for (std::size_t c = 0; c < state.size(); ++c) {
        const Eigen::Index i = c;
        powers[kindOf(part, c)].push_back(cell.S(i, i).real() / std::pow(state[c].factor, 2));
    }
    std::array<double, 2> levels{0, 0};
    for (std::size_t kind = 0; kind < 2; ++kind) {
        if (powers[kind].empty()) continue;
        const auto middle = powers[kind].begin() + static_cast<std::ptrdiff_t>(powers[kind].size() / 2);
        std::nth_element(powers[kind].begin(), middle, powers[kind].end());
        levels[kind] = *middle;
    }
    return levels;
}

/// @param muted channels that must not tell of the motion; may be empty
WeighedCell weighCell(const PartCells& part, const PartState& state, const Cell& cell,
                      const std::vector<std::size_t>& muted = {}) {
    const Eigen::Index n = part.channels.size();
    WeighedCell weighed;
    weighed.B.resize(n, 6);
    Eigen::VectorXcd scale(n);
    const std::array<double, 2> levels = findLevels(part, state, cell);
    for (Eigen::Index c = 0; c < n; ++c) {
        const ChannelState& channel = state[c];
        const double own = (cell.noise[c] + kOwnFloor * kOwnFloor * cell.S(c, c).real()) / std::pow(channel.factor, 2);
        const double others = kOthersFloor * kOthersFloor * levels[kindOf(part, c)];
        const double sum = own + others, weight = sum > 0 ? 1 / std::sqrt(sum) : 0;
        weighed.B.row(c) = weight * part.channels[channel.row].row;
        scale[c] = std::polar(weight / channel.factor, cell.omega * (channel.delay + channel.drift * cell.time));
    }
    weighed.S = scale.asDiagonal() * cell.S * scale.conjugate().asDiagonal();
    const Eigen::MatrixXd telling = WeighedCell::mute(weighed.B, muted);
    Eigen::Matrix<double, 6, 6> normal = telling.transpose() * telling;
    normal.diagonal().array() += kCellRidge * normal.trace();
    weighed.normal.compute(normal);
    return weighed;
}

}  // namespace

PartState makeFaultless(std::size_t channels) {
    PartState state(channels);
    for (std::size_t c = 0; c < channels; ++c) state[c].row = c;
    return state;
}

double calcMisfit(const PartCells& part, const PartState& state) {
    double sum = 0;
    for (const Cell& cell : part.cells)
        sum += std::sqrt(std::max(0.0, weighCell(part, state, cell).calcLeft()) / part.redundancy);
    return sum / static_cast<double>(part.cells.size());
}

std::vector<ChannelOutlook> lookAhead(const PartCells& part, const PartState& state) {
    const std::size_t n = part.channels.size();
    std::vector<ChannelOutlook> outlooks(n);
    for (const Cell& cell : part.cells) {
        const WeighedCell weighed = weighCell(part, state, cell);
        const Eigen::MatrixXd outside =
            Eigen::MatrixXd::Identity(weighed.B.rows(), weighed.B.rows()) - weighed.project(weighed.B);
        const Eigen::MatrixXcd left = outside * weighed.S;                             // ⟨e y*⟩
        const Eigen::VectorXd power = (left * outside.transpose()).diagonal().real();  // ⟨e e*⟩
        const double all = left.real().trace();
        for (std::size_t i = 0; i < n; ++i) {
            const Eigen::Index c = i;
            const double leverage = outside(c, c), own = weighed.S(c, c).real();
            // The forecast is y − e / (1 − h).
            const double without = std::max(0.0, all - (leverage > 0 ? power[c] / leverage : 0));
            outlooks[i].misfit_without += std::sqrt(without / std::max(1, part.redundancy - 1));
            if (leverage < kLeastLeverage) continue;
            const std::complex<double> common = own - std::conj(left(c, c)) / leverage;
            const double forecast = own - 2 * left(c, c).real() / leverage + power[c] / (leverage * leverage);
            if (forecast > 0) outlooks[i].forecasts.push_back({cell.omega, cell.time, common / forecast});
        }
    }
    for (ChannelOutlook& outlook : outlooks) outlook.misfit_without /= static_cast<double>(part.cells.size());
    return outlooks;
}

std::vector<Forecast> forecastGroup(const PartCells& part, const PartState& state,
                                    const std::vector<std::size_t>& members) {
    std::vector<Forecast> forecasts;
    for (const Cell& cell : part.cells) {
        const WeighedCell weighed = weighCell(part, state, cell, members);
        const Eigen::MatrixXd H = weighed.project(WeighedCell::mute(weighed.B, members));
        std::complex<double> common = 0;
        double power = 0;
        for (const std::size_t i : members) {
            const Eigen::Index c = i;
            const Eigen::RowVectorXd h = H.row(c);
            const Eigen::VectorXcd crossed = weighed.S * h.transpose().cast<std::complex<double>>();  // ⟨y T̂*⟩
            common += crossed[c];
            power += (h * weighed.S.real() * h.transpose()).value();
        }
        if (power > 0) forecasts.push_back({cell.omega, cell.time, common / power});
    }
    return forecasts;
}

}  // namespace wems::identify
