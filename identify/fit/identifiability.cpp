#include "identify/fit/identifiability.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace wems::identify {

namespace {

/// Groups of `members` that are linked by a correlation of at least `least`.
std::vector<std::vector<int>> findGroups(const std::vector<int>& members, const std::vector<Parameter>& parameters,
                                         const Eigen::MatrixXd& covariance) {
    constexpr double least = 0.3;
    std::vector<int> label(members.size());
    for (std::size_t i = 0; i < members.size(); ++i) label[i] = static_cast<int>(i);
    for (std::size_t i = 0; i < members.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const int a = members[i], b = members[j];
            const double scale = std::sqrt(covariance(a, a) * covariance(b, b));
            const bool same_kind = parameters[a].unit == parameters[b].unit;
            if (!same_kind || std::abs(covariance(a, b)) < least * scale) continue;
            const int from = label[i], to = label[j];
            std::replace(label.begin(), label.end(), from, to);
        }
    std::vector<std::vector<int>> groups;
    for (std::size_t i = 0; i < members.size(); ++i) {
        std::vector<int> group;
        for (std::size_t j = 0; j < members.size(); ++j)
            if (label[j] == static_cast<int>(i)) group.push_back(members[j]);
        if (!group.empty()) groups.push_back(group);
    }
    return groups;
}

/// Collects known combinations of one group until no further independent one is known.
class CombinationSearch {
public:
    CombinationSearch(const std::vector<Parameter>& parameters, const std::vector<int>& group,
                      const Eigen::VectorXd& scale, const Eigen::MatrixXd& covariance,
                      const std::function<double(const Eigen::VectorXd&)>& calcHalfWidth)
        : parameters_(parameters),
          group_(group),
          scale_(scale(group)),
          covariance_(covariance(group, group)),
          calcHalfWidth_(calcHalfWidth),
          all_(scale.size()),
          tolerance_(0.5 * calcTolerance(parameters[group.front()])) {
        const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance_);
        for (Eigen::Index j = 0; j < eigen.eigenvalues().size(); ++j)
            if (calcScaledError(eigen.eigenvectors().col(j)) < tolerance_)
                known_directions_.push_back(eigen.eigenvectors().col(j));
    }

    std::vector<KnownCombination> find() {
        const int size = static_cast<int>(group_.size());
        for (int terms = 2; terms <= std::min(size, 8) && !complete(); ++terms) tryTerms(terms);
        for (const auto& direction : known_directions_) {
            if (complete()) break;
            addDecimal(direction);
        }
        return found_;
    }

private:
    bool complete() const { return found_.size() >= known_directions_.size(); }

    /// All sums and differences of that many members, those of one axis first, sums first, best known first.
    void tryTerms(int terms) {
        const int size = static_cast<int>(group_.size());
        if (size > 12) return;
        struct Candidate {
            int preference;  // low first: one axis before several, sums before differences
            double error;
            Eigen::VectorXd factors;
        };
        std::vector<Candidate> candidates;
        for (unsigned chosen = 0; chosen < (1U << size); ++chosen) {
            if (__builtin_popcount(chosen) != terms) continue;
            for (unsigned signs = 0; signs < (1U << (terms - 1)); ++signs) {
                Eigen::VectorXd factors = Eigen::VectorXd::Zero(size);
                unsigned term = 0;
                for (int j = 0; j < size; ++j) {
                    if ((chosen >> j & 1U) == 0) continue;
                    factors(j) = term > 0 && (signs >> (term - 1) & 1U) != 0 ? -1 : 1;
                    ++term;
                }
                const double error = calcRelativeError(factors);
                if (error < tolerance_)
                    candidates.push_back({16 * (countAxes(chosen) - 1) + __builtin_popcount(signs), error, factors});
            }
        }
        std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
            return a.preference != b.preference ? a.preference < b.preference : a.error < b.error;
        });
        for (const Candidate& candidate : candidates)
            if (!complete()) addIfIndependent(candidate.factors);
    }

    int countAxes(unsigned chosen) const {
        unsigned axes = 0;
        for (std::size_t j = 0; j < group_.size(); ++j)
            if ((chosen >> j & 1U) != 0) axes |= 1U << (parameters_[group_[j]].axis + 1);
        return __builtin_popcount(axes);
    }

    double calcRelativeError(const Eigen::VectorXd& factors) const {
        return calcScaledError(factors.cwiseProduct(scale_));
    }

    /// Standard error of Σ a_j x_j, x_j = parameter / scale, over Σ |a_j|: of a sum of equals, relative to the sum.
    double calcScaledError(const Eigen::VectorXd& scaled) const {
        return std::sqrt(std::max(0.0, scaled.dot(covariance_ * scaled))) / scaled.cwiseAbs().sum();
    }

    bool hasNarrowInterval(const Eigen::VectorXd& factors) const {
        const Eigen::VectorXd scaled = factors.cwiseProduct(scale_);
        Eigen::VectorXd combination = Eigen::VectorXd::Zero(all_);
        combination(group_) = scaled;
        return calcHalfWidth_(combination) < 2 * tolerance_ * scaled.cwiseAbs().sum();
    }

    bool addIfIndependent(const Eigen::VectorXd& factors) {
        constexpr double least = 0.2;  // part that the earlier combinations do not span
        Eigen::VectorXd rest = factors.cwiseProduct(scale_).normalized();
        for (const auto& direction : basis_) rest -= direction.dot(rest) * direction;
        if (rest.norm() < least || !hasNarrowInterval(factors)) return false;
        basis_.push_back(rest.normalized());
        found_.push_back({group_, factors, formatCombination(parameters_, group_, factors)});
        return true;
    }

    void addDecimal(const Eigen::VectorXd& direction) {
        Eigen::VectorXd rest = direction;
        for (const auto& earlier : basis_) rest -= earlier.dot(rest) * earlier;
        if (rest.norm() < 0.2) return;
        Eigen::VectorXd factors = rest.cwiseQuotient(scale_);
        Eigen::Index largest = 0;
        factors.cwiseAbs().maxCoeff(&largest);
        factors /= factors(largest);
        for (double& factor : factors) factor = std::abs(factor) < 0.01 ? 0 : std::round(factor * 1000) / 1000;
        if (calcRelativeError(factors) < tolerance_) addIfIndependent(factors);
    }

    const std::vector<Parameter>& parameters_;
    const std::vector<int>& group_;
    Eigen::VectorXd scale_;
    Eigen::MatrixXd covariance_;
    const std::function<double(const Eigen::VectorXd&)>& calcHalfWidth_;
    Eigen::Index all_;  // parameters
    double tolerance_;  // of a standard error
    std::vector<Eigen::VectorXd> known_directions_, basis_;
    std::vector<KnownCombination> found_;
};

}  // namespace

std::string formatCombination(const std::vector<Parameter>& parameters, const std::vector<int>& members,
                              const Eigen::VectorXd& factors) {
    std::string text;
    for (std::size_t j = 0; j < members.size(); ++j) {
        const double factor = factors(j);
        if (factor == 0) continue;
        text += text.empty() ? (factor < 0 ? "-" : "") : (factor < 0 ? " - " : " + ");
        if (std::abs(factor) != 1) {
            std::array<char, 32> number{};
            std::snprintf(number.data(), number.size(), "%.3g ", std::abs(factor));
            text += number.data();
        }
        text += parameters[members[j]].name;
    }
    return text;
}

double calcTolerance(const Parameter& parameter) {
    return parameter.kind == ParameterKind::damping ? 0.2 : 0.1;
}

std::string describeSeparatingMotion(const MountModel& model, const std::vector<Parameter>& parameters,
                                     const Eigen::MatrixXd& covariance) {
    static const std::array<const char*, 6> motions{"moves the mobile part along x", "moves the mobile part along y",
                                                    "moves the mobile part along z", "turns the mobile part about x",
                                                    "turns the mobile part about y", "turns the mobile part about z"};
    double arm = 0;
    for (const auto& connection : model.connections) arm = std::max(arm, connection.position.norm());
    if (arm <= 0) arm = 1;
    for (const Parameter& parameter : parameters)
        if (parameter.kind == ParameterKind::other) return "a run at another level, or over another band";
    for (const Parameter& parameter : parameters)
        if (parameter.connection < 0) return "a run that turns the mobile part about other axes";
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
    Eigen::Matrix<double, 6, 1> response = Eigen::Matrix<double, 6, 1>::Zero();
    for (Eigen::Index d = 0; d < covariance.rows(); ++d) {
        Eigen::Matrix<double, 6, 6> change = Eigen::Matrix<double, 6, 6>::Zero();
        for (std::size_t j = 0; j < parameters.size(); ++j) {
            const Eigen::Vector3d unit = Eigen::Vector3d::Unit(parameters[j].axis);
            const auto& position = model.connections[parameters[j].connection].position;
            Eigen::Matrix<double, 6, 1> pattern;
            pattern << unit, position.cross(unit) / arm;
            change += eigen.eigenvectors()(j, d) * pattern * pattern.transpose();
        }
        response += eigen.eigenvalues()(d) * change.colwise().squaredNorm().transpose();
    }
    Eigen::Index best = 0;
    if (response.maxCoeff(&best) < 0.01 * covariance.trace())
        return "no motion of this mount as a rigid body: a test of one connection alone";
    return std::string("a run that ") + motions.at(best);
}

Identifiability findIdentifiable(const MountModel& model, const std::vector<Parameter>& parameters,
                                 const Eigen::VectorXd& scale, const Eigen::MatrixXd& covariance,
                                 const std::function<double(const Eigen::VectorXd&)>& calcHalfWidth) {
    Identifiability result;
    std::vector<int> open;
    for (std::size_t j = 0; j < parameters.size(); ++j) {
        const Eigen::Index k = j;
        result.known.push_back(std::sqrt(covariance(k, k)) < calcTolerance(parameters[j]));
        if (!result.known.back()) open.push_back(static_cast<int>(j));
    }
    for (const auto& group : findGroups(open, parameters, covariance)) {
        OpenGroup described;
        described.members = group;
        if (group.size() > 1)
            described.known = CombinationSearch(parameters, group, scale, covariance, calcHalfWidth).find();
        std::vector<Parameter> members;
        for (const int j : group) members.push_back(parameters[j]);
        if (members.front().kind == ParameterKind::stop_stiffness || members.front().kind == ParameterKind::clearance)
            described.separate_by = "a run in which " +
                                    members.front().name.substr(0, members.front().name.rfind('.')) +
                                    " is pushed further into its stop";
        else
            described.separate_by = describeSeparatingMotion(model, members, covariance(group, group));
        result.groups.push_back(std::move(described));
    }
    return result;
}

namespace {

constexpr double kLeastMember = 0.3;  // of the largest member, to be written
constexpr std::size_t kMostMembers = 4;

std::string describe(const std::vector<Parameter>& parameters, const Eigen::VectorXd& direction) {
    const double largest = direction.cwiseAbs().maxCoeff();
    std::vector<int> members;
    for (Eigen::Index j = 0; j < direction.size(); ++j)
        if (std::abs(direction[j]) >= kLeastMember * largest) members.push_back(static_cast<int>(j));
    std::stable_sort(members.begin(), members.end(),
                     [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
    const bool cut = members.size() > kMostMembers;
    if (cut) members.resize(kMostMembers);
    const Eigen::VectorXd factors = direction(members);
    return formatCombination(parameters, members, factors) + (cut ? " + …" : "");
}

}  // namespace

std::vector<ParameterDirection> findDirections(const std::vector<Parameter>& parameters,
                                               const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
    std::vector<ParameterDirection> directions;
    for (Eigen::Index d = information.rows() - 1; d >= 0; --d) {
        const Eigen::VectorXd direction = eigen.eigenvectors().col(d);
        Eigen::Index largest = 0;
        direction.cwiseAbs().maxCoeff(&largest);
        ParameterDirection entry;
        entry.singular_value = std::sqrt(std::max(0.0, eigen.eigenvalues()[d]));
        entry.relative_error = std::sqrt(std::max(0.0, direction.dot(covariance * direction)));
        entry.known = entry.relative_error < calcTolerance(parameters[largest]);
        entry.text = describe(parameters, direction[largest] < 0 ? Eigen::VectorXd(-direction) : direction);
        directions.push_back(std::move(entry));
    }
    return directions;
}

}  // namespace wems::identify
