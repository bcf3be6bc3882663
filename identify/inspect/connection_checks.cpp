#include "identify/inspect/connection_checks.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "models/bryant.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems {
namespace {

constexpr std::size_t kMaxSamples = 4000;  // enough for a Gram matrix of a few dozen channels
constexpr double kSwapRatio = 1.0 / 3;     // misfit after over misfit before
constexpr double kMinMisfit = 0.01;        // of the signal; below, second-order terms and noise are all there is
constexpr double kAlmostAsGood = 1.2;      // misfit of a rival over that of the best exchange

const char* partName(Part part) {
    return part == Part::mobile ? "mobile" : "fixed";
}

/// One exchange: the rows of two markers, or of two single channels, of the stacked u.
struct Exchange {
    std::string first, second;
    std::vector<std::pair<Eigen::Index, Eigen::Index>> rows;
    double misfit = 0;  ///< squared
};

/// Complete triaxes of one kind, of both parts.
class Markers {
public:
    Markers(const Recording& recording, const MountModel& model, Derivative derivative) {
        for (const Part part : {Part::mobile, Part::fixed}) {
            for (const auto& connection : model.connections) {
                std::array<const Channel*, 3> channels{};
                for (int axis = 0; axis < 3; ++axis)
                    channels[axis] = recording.find(formatChannelName({part, connection.name, axis, derivative}));
                if (std::count(channels.begin(), channels.end(), nullptr) != 0) continue;
                names_.push_back(std::string(partName(part)) + "." + connection.name);
                parts_.push_back(part);
                positions_.push_back(connection.position);
                channels_.insert(channels_.end(), channels.begin(), channels.end());
            }
        }
    }

    /// The best exchanges, all of about the same misfit; empty if there is none to report.
    std::vector<Exchange> findSwapped() const {
        if (names_.size() < 3) return {};
        const Eigen::MatrixXd gram = calcGram();
        const Eigen::MatrixXd outside = calcProjectorOutside();
        const double before = calcMisfit(outside, gram);
        if (!(before > kMinMisfit * kMinMisfit * gram.trace())) return {};
        auto exchanges = listExchanges();
        for (auto& exchange : exchanges) {
            Eigen::MatrixXd traded = gram;
            for (const auto& [a, b] : exchange.rows) {
                traded.row(a).swap(traded.row(b));
                traded.col(a).swap(traded.col(b));
            }
            exchange.misfit = calcMisfit(outside, traded);
        }
        const auto best = std::min_element(exchanges.begin(), exchanges.end(),
                                           [](const Exchange& a, const Exchange& b) { return a.misfit < b.misfit; });
        const double limit = std::max(best->misfit * kAlmostAsGood * kAlmostAsGood, 1e-24 * gram.trace());
        if (best->misfit > kSwapRatio * kSwapRatio * before) return {};
        exchanges.erase(std::remove_if(exchanges.begin(), exchanges.end(),
                                       [&](const Exchange& exchange) { return exchange.misfit > limit; }),
                        exchanges.end());
        for (auto& exchange : exchanges) exchange.misfit /= before;
        return exchanges;
    }

private:
    /// Σ over samples of u uᵀ, means taken off: sensors of acceleration have a bias.
    Eigen::MatrixXd calcGram() const {
        const std::size_t count = channels_.front()->values.size();
        const std::size_t stride = count / kMaxSamples + 1;
        const Eigen::Index rows = channels_.size();
        Eigen::MatrixXd u(rows, (count + stride - 1) / stride);
        for (Eigen::Index j = 0; j < u.cols(); ++j) {
            for (Eigen::Index i = 0; i < rows; ++i)
                u(i, j) = channels_[i]->values[static_cast<std::size_t>(j) * stride];
        }
        u.colwise() -= u.rowwise().mean().eval();
        return u * u.transpose();
    }

    Eigen::MatrixXd calcProjectorOutside() const {
        const Eigen::Index rows = channels_.size();
        Eigen::MatrixXd rigid = Eigen::MatrixXd::Zero(rows, 12);
        for (std::size_t k = 0; k < positions_.size(); ++k) {
            const Eigen::Index row = 3 * k;
            const Eigen::Index column = parts_[k] == Part::mobile ? 0 : 6;
            rigid.block<3, 3>(row, column).setIdentity();
            rigid.block<3, 3>(row, column + 3) = -crossMatrix(positions_[k]);
        }
        Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(rigid);
        qr.setThreshold(1e-9);
        const Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(rows, qr.rank());
        return Eigen::MatrixXd::Identity(rows, rows) - q * q.transpose();
    }

    static double calcMisfit(const Eigen::MatrixXd& outside, const Eigen::MatrixXd& gram) {
        return std::max(0.0, outside.cwiseProduct(gram).sum());
    }

    std::vector<Exchange> listExchanges() const {
        std::vector<Exchange> exchanges;
        for (std::size_t a = 0; a < names_.size(); ++a) {
            for (std::size_t b = a + 1; b < names_.size(); ++b) {
                Exchange exchange{names_[a], names_[b], {}, 0};
                for (std::size_t axis = 0; axis < 3; ++axis) exchange.rows.emplace_back(3 * a + axis, 3 * b + axis);
                exchanges.push_back(std::move(exchange));
            }
        }
        for (std::size_t a = 0; a < channels_.size(); ++a) {
            for (std::size_t b = a + 1; b < channels_.size(); ++b)
                exchanges.push_back({channels_[a]->name,
                                     channels_[b]->name,
                                     {{static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)}},
                                     0});
        }
        return exchanges;
    }

    std::vector<std::string> names_;
    std::vector<Part> parts_;
    std::vector<Eigen::Vector3d> positions_;
    std::vector<const Channel*> channels_;  // three for each marker
};

void findMismatchedNames(const Recording& recording, const MountModel& model, std::vector<Finding>& findings) {
    constexpr std::array<std::pair<Part, const char*>, 4> kParts = {
        {{Part::mobile, "mobile"}, {Part::fixed, "fixed"}, {Part::relative, "relative"}, {Part::force, "force"}}};
    for (const auto& [part, part_name] : kParts) {
        const auto recorded = recording.connections(part);
        if (recorded.empty()) continue;
        for (const auto& name : recorded) {
            const auto isNamed = [&wanted = name](const auto& other) { return other.name == wanted; };
            const bool known = std::any_of(model.connections.begin(), model.connections.end(), isNamed) ||
                               std::any_of(model.places.begin(), model.places.end(), isNamed);
            if (known) continue;
            const std::string channel = std::string(part_name) + "." + name;
            findings.push_back(
                {FindingKind::unknown_connection, channel, 0, 0,
                 channel + ": the model has no connection or sensor of this name; its channels are not used"});
        }
        if (part != Part::mobile && part != Part::fixed) continue;  // a test machine holds one connection
        const bool elsewhere = std::any_of(model.places.begin(), model.places.end(),
                                           [&, wanted = part](const SensorPlace& p) { return p.part == wanted; });
        if (elsewhere) continue;  // the laboratory's own layout
        for (const auto& connection : model.connections) {
            if (std::find(recorded.begin(), recorded.end(), connection.name) != recorded.end()) continue;
            const std::string channel = std::string(part_name) + "." + connection.name;
            findings.push_back({FindingKind::missing_connection, channel, 0, 0,
                                channel + ": the model has this connection, the recording no channel of it"});
        }
    }
}

void findSwapped(const Recording& recording, const MountModel& model, std::vector<Finding>& findings) {
    for (const auto derivative : {Derivative::displacement, Derivative::velocity, Derivative::acceleration}) {
        const auto exchanges = Markers(recording, model, derivative).findSwapped();
        if (exchanges.empty()) continue;
        std::string message;
        for (const auto& exchange : exchanges) {
            if (!message.empty()) message += ", or ";
            message += exchange.first + " and " + exchange.second;
        }
        const double percent = 100 * (1 - std::sqrt(exchanges.front().misfit));
        message += " seem exchanged: trading their channels lowers the misfit of rigid motion by " +
                   std::to_string(std::lround(percent)) + " %";
        findings.push_back({FindingKind::swapped, exchanges.front().first, 0, 0, message});
    }
}

/// Largest distance between two connections, m.
double findWidth(const MountModel& model) {
    double width = 0;
    for (const Connection& one : model.connections)
        for (const Connection& other : model.connections)
            width = std::max(width, (one.position - other.position).norm());
    return width;
}

}  // namespace

std::vector<Finding> checkAgainstModel(const Recording& recording, const MountModel& model) {
    std::vector<Finding> findings;
    findMismatchedNames(recording, model, findings);
    if (recording.sampleCount() > 1) findSwapped(recording, model, findings);
    return findings;
}

void checkRigidBound(const Recording& recording, const MountModel& model) {
    const double width = findWidth(model);
    if (!(width > 0)) return;
    for (const Part part : {Part::mobile, Part::fixed}) {
        for (int axis = 0; axis < 3; ++axis) {
            const Channel* first = nullptr;
            for (const Connection& connection : model.connections) {
                const Channel* channel =
                    recording.find(formatChannelName({part, connection.name, axis, Derivative::displacement}));
                if (channel == nullptr) continue;
                if (first == nullptr) first = channel;
                double least = 0, most = 0;
                const double rest = channel->values.front() - first->values.front();
                for (std::size_t k = 0; k < channel->values.size(); ++k) {
                    const double apart = channel->values[k] - first->values[k] - rest;
                    least = std::min(least, apart);
                    most = std::max(most, apart);
                    if (most - least <= 2 * width) continue;
                    const long row = recording.first_row > 0 ? recording.first_row + static_cast<long>(k) : 0;
                    throw InputError({recording.file, row, channel->name},
                                     "has moved " + formatNumber(most - least, 3) + " m against " + first->name +
                                         ", points of a rigid part " + formatNumber(width, 3) + " m wide at most " +
                                         formatNumber(2 * width, 3) + " m",
                                     "displacements in the unit that the header names");
                }
            }
        }
    }
}

}  // namespace wems
