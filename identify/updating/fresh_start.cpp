#include "identify/updating/fresh_start.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "identify/updating/naming.hpp"
#include "identify/updating/standing.hpp"

namespace wems::identify::updating {
namespace {

using Axis = std::pair<int, int>;  // connection and direction

class FreshStart {
public:
    FreshStart(const TestProblem& problem, const Settler& settler, const SetState& present)
        : problem_(problem), settler_(settler), present_(present) {}

    std::vector<Trial> find(const SetState& best) const {
        const std::optional<Stretched> stretched = findStretched(best);
        if (!stretched) return {};
        const std::vector<int> candidates = collectCandidates(*stretched);
        if (candidates.empty()) return {};
        const TestPoint relaxed = relax(stretched->axis);
        double least = settler_.calcCostAt(relaxed);
        std::vector<std::pair<double, Trial>> begun;
        for (const int h : candidates) {
            const auto far = problem_.goToProbes(relaxed, {h});
            if (!far) continue;
            Trial trial{present_.set, *far, 0};
            trial.set.insert(std::lower_bound(trial.set.begin(), trial.set.end(), h), h);
            const double cost = settler_.calcCostAt(trial.point);
            if (cost >= least + 2 * kUnlikely) continue;
            least = std::min(least, cost);
            begun.emplace_back(cost, std::move(trial));
        }
        return pickBest(std::move(begun), least);
    }

private:
    struct Stretched {
        Axis axis;
        double square = 0;  ///< of its numbers in standard deviations, beyond what is expected
    };

    /// The best place of each cause, of those that are as good as the best.
    std::vector<Trial> pickBest(std::vector<std::pair<double, Trial>> begun, double least) const {
        std::sort(begun.begin(), begun.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
        std::set<std::string> causes;
        std::vector<Trial> starts;
        for (auto& [cost, trial] : begun)
            if (cost < least + 2 * kUnlikely && causes.insert(nameOf(trial)).second) starts.push_back(std::move(trial));
        return starts;
    }

    std::string nameOf(const Trial& trial) const {
        for (const int h : trial.set)
            if (!std::binary_search(present_.set.begin(), present_.set.end(), h)) return problem_.hypotheses()[h].cause;
        return {};
    }

    /// A number of an axis that has its tolerance under a set.
    std::optional<Axis> axisOf(std::size_t row, const HypothesisSet& set) const {
        const Unknown& number = problem_.table()[row];
        if (number.kind != UnknownKind::law || !(number.deviation > 0) || isFreed(problem_, set, static_cast<int>(row)))
            return std::nullopt;
        return Axis{number.first, number.second};
    }

    /// A set without what frees several numbers one by one: a cause of one number may do as well.
    HypothesisSet withoutPairs(HypothesisSet set) const {
        const auto isPair = [&](int h) { return problem_.hypotheses()[h].directions.size() > 1; };
        set.erase(std::remove_if(set.begin(), set.end(), isPair), set.end());
        return set;
    }

    /// The axis whose numbers cost most of the prior. A number within its tolerance costs one by expectation.
    std::optional<Stretched> findStretched(const SetState& best) const {
        const Eigen::VectorXd estimate = problem_.estimateOf(best.point);
        const HypothesisSet held = withoutPairs(best.set);
        std::map<Axis, double> squares;
        for (std::size_t i = 0; i < problem_.table().size(); ++i)
            if (const auto axis = axisOf(i, held)) {
                const double ratio = estimate[static_cast<Eigen::Index>(i)] / problem_.table()[i].deviation;
                squares[*axis] += ratio * ratio - 1;
            }
        const auto most = std::max_element(squares.begin(), squares.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        if (most == squares.end()) return std::nullopt;
        return Stretched{most->first, most->second};
    }

    TestPoint relax(Axis axis) const {
        Eigen::VectorXd estimate = problem_.estimateOf(present_.point);
        for (std::size_t i = 0; i < problem_.table().size(); ++i)
            if (axisOf(i, present_.set) == axis) estimate[static_cast<Eigen::Index>(i)] = 0;
        return problem_.pointAt(estimate, present_.set);
    }

    /// Hypotheses of one number of the axis, sought at a step from where it is, whose prior odds are outweighed by what
    /// they may give back.
    std::vector<int> collectCandidates(const Stretched& stretched) const {
        std::vector<int> candidates;
        for (int h = 0; h < static_cast<int>(problem_.hypotheses().size()); ++h) {
            const Hypothesis& own = problem_.hypotheses()[h];
            if (own.moves.empty() || own.reported.size() != 1 ||
                isFreed(problem_, present_.set, own.reported.front()) ||
                stretched.square < 2 * (kUnlikely - own.log_prior))
                continue;
            const Unknown& number = problem_.table()[own.reported.front()];
            if (number.kind == UnknownKind::law && Axis{number.first, number.second} == stretched.axis)
                candidates.push_back(h);
        }
        return candidates;
    }

    const TestProblem& problem_;
    const Settler& settler_;
    const SetState& present_;
};

}  // namespace

std::vector<Trial> startAfresh(const TestProblem& problem, const Settler& settler, const SetState& present,
                               const SetState& best) {
    return FreshStart(problem, settler, present).find(best);
}

}  // namespace wems::identify::updating
