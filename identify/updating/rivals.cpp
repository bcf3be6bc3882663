#include "identify/updating/rivals.hpp"

#include <algorithm>
#include <iterator>

namespace wems::identify::updating {
namespace {

auto find(const std::vector<RankedSet>& sets, const HypothesisSet& members) {
    return std::find_if(sets.begin(), sets.end(), [&](const RankedSet& own) { return own.members == members; });
}

/// Sets of as many causes as the present one, over which `ranked` has the present set by as much as its own round had.
std::vector<RankedSet> collectRivals(const Standing& standing) {
    std::vector<RankedSet> rivals;
    for (const RankedSet& own : standing.ranked)
        if (own.members.size() == standing.state.set.size() && own.members != standing.state.set) rivals.push_back(own);
    return rivals;
}

}  // namespace

void keepRivals(const Standing& standing, std::vector<RankedSet>& ranked) {
    const HypothesisSet& present = standing.state.set;
    const auto taken = find(standing.ranked, present), now = find(ranked, present);
    if (taken == standing.ranked.end() || now == ranked.end()) return;
    const double shift = now->log_evidence - taken->log_evidence;
    for (const RankedSet& rival : collectRivals(standing))
        if (find(ranked, rival.members) == ranked.end()) ranked.push_back({rival.members, rival.log_evidence + shift});
}

void carryRivals(Standing& standing, const HypothesisSet& next, std::vector<RankedSet>& ranked) {
    const HypothesisSet& present = standing.state.set;
    const auto taken = find(standing.ranked, present), now = find(ranked, next);
    if (taken == standing.ranked.end() || now == ranked.end()) return;
    if (!std::includes(next.begin(), next.end(), present.begin(), present.end())) return;
    HypothesisSet added;
    std::set_difference(next.begin(), next.end(), present.begin(), present.end(), std::back_inserter(added));
    const double shift = now->log_evidence - taken->log_evidence;
    for (const RankedSet& rival : collectRivals(standing)) {
        HypothesisSet with;
        std::set_union(rival.members.begin(), rival.members.end(), added.begin(), added.end(),
                       std::back_inserter(with));
        if (with.size() != next.size() || find(ranked, with) != ranked.end()) continue;
        ranked.push_back({with, rival.log_evidence + shift});
        const auto settled = standing.settled.find(rival.members);
        if (settled != standing.settled.end()) standing.settled.emplace(with, settled->second);
    }
}

void addLessLikely(const HypothesisSet& present, double weight, const std::vector<RankedSet>& others,
                   std::vector<RankedSet>& ranked) {
    const auto now = find(ranked, present);
    if (now == ranked.end()) return;
    const double shift = now->log_evidence - weight;
    for (const RankedSet& own : others)
        if (find(ranked, own.members) == ranked.end()) ranked.push_back({own.members, own.log_evidence + shift});
}

}  // namespace wems::identify::updating
