// A round among exact numbers: what asks for a cause, and that the best set is taken where it is settled.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <string>

#include "identify/updating/naming.hpp"
#include "identify/updating/selection.hpp"
#include "identify/updating/settled_search.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

/// A run of 4 s of a device, and the search about what is believed of it.
class Round {
public:
    /// @param force N, along z
    Round(const MountModel& truth, const MountModel& believed, std::mt19937_64& random, double force = 60)
        : problem_({recordIt(truth, random, force)}, {}, believed, Numbers::exact), settler_(problem_) {
        standing_.judged = simulateBadly(problem_.believedPoint(), {});
        SetState& state = standing_.state;
        state.point = problem_.believedPoint();
        state.view = problem_.view(state.point);
        state.scales = settler_.scalesOf(calcMisfits(sumOf(state.view, true), problem_.estimateOf(state.point)));
    }

    bool findsMore() { return makeSearch().findsMore(makeOwnEvidence(), listCandidates(), standing_); }
    bool takeBest(Decision& decision) {
        return makeSearch().takeBest(makeOwnEvidence(), listCandidates(), standing_, decision);
    }
    /// The one cause that is taken.
    const Hypothesis& takeOne() {
        Decision decision;
        REQUIRE(takeBest(decision));
        CAPTURE(decision.action);
        REQUIRE(standing_.state.set.size() == 1);
        checkRecord(decision);
        return problem_.hypotheses()[standing_.state.set.front()];
    }
    double valueOf(const std::string& name) const {
        return standing_.state.point.values[findUnknown(problem_.table(), name)];
    }
    TestProblem& problem() { return problem_; }
    const Standing& standing() const { return standing_; }

private:
    static Recording recordIt(const MountModel& truth, std::mt19937_64& random, double force) {
        identify::testing::RunPlan plan;
        plan.duration = 4;
        plan.force = Eigen::Vector3d(40, 30, force);
        return recordRun(truth, plan, random);
    }
    /// A simulation that is always worth a cause: the equations alone decide.
    static FreeError simulateBadly(const TestPoint& /*point*/, const HypothesisSet& /*set*/) {
        FreeError judged;
        judged.error = 0.5;
        return judged;
    }
    /// The one that was taken is the likeliest of those that can be.
    void checkRecord(const Decision& decision) const {
        int taken = 0;
        double own = 0, most = 0;
        for (const FittedSet& fitted : decision.fitted) {
            if (fitted.outcome != kImpossible && fitted.outcome != kWithin) most = std::max(most, fitted.log_evidence);
            if (fitted.outcome != kTaken) continue;
            ++taken;
            own = fitted.log_evidence;
            CHECK(fitted.causes == describe(problem_, standing_.state.set));
            CHECK(fitted.error == 0.5);
        }
        CHECK(taken == 1);
        CHECK(own > 0);
        CHECK(own == most);
    }
    Evidence makeOwnEvidence() const {
        return makeEvidence(problem_, standing_.state.view, standing_.state.set, standing_.state.scales, true);
    }
    std::vector<RankedSet> listCandidates() const { return makeOwnEvidence().search({HypothesisSet{}}, 6, 1); }
    SettledSearch makeSearch() { return {problem_, settler_, judge_}; }

    TestProblem problem_;
    Settler settler_;
    FreeJudge judge_ = simulateBadly;
    Standing standing_;
};

const char* const kHidden = "1.z.stiffness";

MountModel scaleHidden(MountModel model, double factor) {
    setParameter(model, kHidden, factor * getParameter(model, kHidden));
    return model;
}

}  // namespace

TEST_CASE("A cause is asked for where a number is off, and not where none is", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    CHECK_FALSE(Round(believed, believed, random).findsMore());
    CHECK(Round(scaleHidden(believed, 1.03), believed, random).findsMore());
}

TEST_CASE("The best set is taken where it is settled", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    const MountModel truth = scaleHidden(believed, 1.4);
    Round round(truth, believed, random);
    CHECK(describe(round.takeOne()) == "elastomer_stiffness 1.z");
    CHECK(round.valueOf(kHidden) == Approx(getParameter(truth, kHidden)).epsilon(0.02));
    const SetState& state = round.standing().state;
    CHECK(isSatisfied(calcMisfits(sumOf(state.view, true), round.problem().estimateOf(state.point))));
}

// The recorded motion does not reach the stop where it is believed, so that it has no slope there.
TEST_CASE("A stop is found at a third to six tenths of its clearance", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    const std::string name = "1.z.+.clearance";
    MountModel truth = believed;
    const double clearance = std::uniform_real_distribution<double>(0.33, 0.6)(random) * getParameter(believed, name);
    setParameter(truth, name, clearance);
    Round round(truth, believed, random, 200);
    // The stop on the other side may not be reached at either clearance, so that both together are as likely.
    CHECK(describe(round.takeOne()).rfind("clearance 1.z.+", 0) == 0);
    CHECK(round.valueOf(name) == Approx(clearance).epsilon(0.005));
}

TEST_CASE("Friction is found with the velocity below which it fades", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    MountModel truth = believed;
    // Five times the law's own default, a twelfth of the largest velocity of most of these devices.
    const Friction friction{20, 0.005, {}};
    truth.connections[0].axis[2].friction = friction;
    Round round(truth, believed, random);
    CHECK(describe(round.takeOne()) == "friction 1.z");
    CHECK(round.valueOf("1.z.friction_force") == Approx(friction.force).epsilon(0.05));
    CHECK(round.valueOf("1.z.transition_velocity") == Approx(friction.transition_velocity).epsilon(0.1));
}

}  // namespace wems::identify::updating
