// Rivals of a set of causes from one round of a search to the next.
#include <algorithm>
#include <catch2/catch.hpp>

#include "identify/updating/rivals.hpp"

namespace wems::identify::updating {
namespace {

/// The first cause was taken; two others were rivals, one of which was settled.
Standing makeStanding() {
    Standing standing;
    standing.state.set = {1};
    standing.ranked = {{{1}, 50.0}, {{2}, 48.5}, {{3}, 47.0}, {{}, 0.0}};
    standing.settled[{2}] = {};
    standing.settled[{2}].values = Eigen::VectorXd::Constant(1, 7.0);
    return standing;
}

double weightOf(const std::vector<RankedSet>& ranked, const HypothesisSet& members) {
    const auto found =
        std::find_if(ranked.begin(), ranked.end(), [&](const RankedSet& own) { return own.members == members; });
    REQUIRE(found != ranked.end());
    return found->log_evidence;
}

}  // namespace

TEST_CASE("A round that takes nothing keeps the rivals of the one before", "[updating]") {
    const Standing standing = makeStanding();
    // Log evidence of a later round counts from elsewhere; what was weighed again stays as it is.
    std::vector<RankedSet> ranked{{{1}, 20.0}, {{3}, 19.0}, {{1, 4}, 18.0}};
    keepRivals(standing, ranked);
    CHECK(ranked.size() == 4);
    CHECK(weightOf(ranked, {2}) == Approx(18.5));
    CHECK(weightOf(ranked, {3}) == 19.0);
}

TEST_CASE("A cause that is added is added to the rivals of the first", "[updating]") {
    Standing standing = makeStanding();
    std::vector<RankedSet> ranked{{{1}, 20.0}, {{0, 1}, 60.0}, {{1, 3}, 30.0}};
    carryRivals(standing, {0, 1}, ranked);
    CHECK(ranked.size() == 5);
    CHECK(weightOf(ranked, {0, 2}) == Approx(58.5));
    CHECK(weightOf(ranked, {0, 3}) == Approx(57.0));
    REQUIRE(standing.settled.count({0, 2}) == 1);
    CHECK(standing.settled[{0, 2}].values[0] == 7.0);
    CHECK(standing.settled.count({0, 3}) == 0);
}

TEST_CASE("A rival that is the added cause is none of the two", "[updating]") {
    Standing standing = makeStanding();
    std::vector<RankedSet> ranked{{{1}, 20.0}, {{1, 2}, 60.0}};
    carryRivals(standing, {1, 2}, ranked);
    CHECK(ranked.size() == 3);
    CHECK(weightOf(ranked, {2, 3}) == Approx(57.0));
}

TEST_CASE("A cause that is exchanged or taken away has no rivals to carry on", "[updating]") {
    Standing standing = makeStanding();
    std::vector<RankedSet> ranked{{{1}, 20.0}, {{4}, 60.0}, {{}, 65.0}};
    carryRivals(standing, {4}, ranked);
    carryRivals(standing, {}, ranked);
    CHECK(ranked.size() == 3);
}

TEST_CASE("A set with one cause less stands beside the present one by what it is less likely", "[updating]") {
    std::vector<RankedSet> ranked{{{1, 2}, 50.0}, {{1}, 40.0}};
    addLessLikely({1, 2}, 20.0, {{{1}, 19.5}, {{2}, 18.8}}, ranked);
    CHECK(ranked.size() == 3);
    CHECK(weightOf(ranked, {1}) == 40.0);
    CHECK(weightOf(ranked, {2}) == Approx(48.8));
    addLessLikely({3}, 20.0, {{{}, 19.5}}, ranked);
    CHECK(ranked.size() == 3);
}

}  // namespace wems::identify::updating
