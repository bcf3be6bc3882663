// A round among numbers with tolerances: which set is taken, and which one that the prediction does not bear out.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>
#include <string>

#include "identify/updating/naming.hpp"
#include "identify/updating/tolerant_search.hpp"
#include "models/parameter_access.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

constexpr double kError = 0.05;  // of a prediction that asks for a cause

/// A run of 4 s of a device, and the search about what is believed of it. The prediction is what the test prescribes:
/// a factor for each cause of a set.
class Round {
public:
    Round(const MountModel& truth, const MountModel& believed, std::mt19937_64& random, double factor)
        : problem_({recordIt(truth, random)}, {}, believed), settler_(problem_), factor_(factor) {}

    void beginWith(const HypothesisSet& set) {
        problem_.adopt(set);
        SetState& state = standing_.state;
        state.set = set;
        state.point = problem_.pointAt(problem_.estimateOf(problem_.believedPoint()), set);
        state.view = problem_.view(state.point, set);
        settler_.settle(state, kSteps, true);
        standing_.judged = judge_(state.point, set);
        state.view = problem_.view(state.point);
    }

    /// @return whether the set changed
    bool take(const BandJudge& band = {}) {
        const SetState& state = standing_.state;
        const Evidence evidence = makeEvidence(problem_, state.view, state.set, state.scales, true);
        TolerantSearch search(problem_, settler_, judge_, band, silent_);
        return search.takeBest(evidence, evidence.search({state.set}, 6, state.set.size() + 1), standing_, decision_);
    }

    /// @return whether a cause was taken back
    bool takeFewer() {
        TolerantSearch search(problem_, settler_, judge_, {}, silent_);
        const SetState& state = standing_.state;
        return search.takeFewer(makeEvidence(problem_, state.view, state.set, state.scales, true), standing_,
                                decision_);
    }

    int find(const std::string& cause) const {
        const auto& all = problem_.hypotheses();
        const auto found =
            std::find_if(all.begin(), all.end(), [&](const Hypothesis& own) { return describe(own) == cause; });
        REQUIRE(found != all.end());
        return static_cast<int>(found - all.begin());
    }
    std::vector<std::string> causes() const { return describe(problem_, standing_.state.set); }
    const Decision& decision() const { return decision_; }
    double valueOf(const std::string& name) const {
        return standing_.state.point.values[findUnknown(problem_.table(), name)];
    }

private:
    static constexpr int kSteps = 8;

    static Recording recordIt(const MountModel& truth, std::mt19937_64& random) {
        identify::testing::RunPlan plan;
        plan.duration = 4;
        plan.force = Eigen::Vector3d(40, 30, 60);
        return recordRun(truth, plan, random);
    }

    TestProblem problem_;
    Settler settler_;
    double factor_;
    FreeJudge judge_ = [this](const TestPoint& /*point*/, const HypothesisSet& set) {
        FreeError judged;
        judged.error = set.empty() ? kError : factor_ * kError;
        return judged;
    };
    ProgressListener silent_;
    Standing standing_;
    Decision decision_;
};

const char* const kKey = "1.z.stiffness";
const char* const kName = "elastomer_stiffness 1.z";

MountModel scale(MountModel model, double factor) {
    setParameter(model, kKey, factor * getParameter(model, kKey));
    return model;
}

}  // namespace

TEST_CASE("A number beyond its tolerance is taken where the prediction bears it out", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    const MountModel truth = scale(believed, 1.5);
    Round round(truth, believed, random, 0.5);
    round.beginWith({});
    REQUIRE(round.take());
    CHECK(round.causes() == std::vector<std::string>{kName});
    // The other numbers of the axis have their tolerances.
    CHECK(round.valueOf(kKey) == Approx(getParameter(truth, kKey)).epsilon(0.05));
}

TEST_CASE("A set that the equations need may be worse by what its own band allows", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    const double worse = 1.3;
    Round round(scale(believed, 1.5), believed, random, worse);
    round.beginWith({});
    const auto allow = [](double error) {
        return [error](const SetState& /*state*/, const Posterior& /*posterior*/) { return error; };
    };
    CHECK_FALSE(round.take());
    CHECK_FALSE(round.take(allow(0.99 * worse * kError)));
    CHECK(round.causes().empty());
    CHECK(round.take(allow(1.01 * worse * kError)));
    CHECK(round.causes() == std::vector<std::string>{kName});
}

// The one that was taken first moves back to its tolerance when another is there: it is settled without.
TEST_CASE("A cause that another one makes needless is taken back", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    Round round(scale(believed, 1.5), believed, random, 0.5);
    const int needless = round.find("elastomer_stiffness 2.z"), hidden = round.find(kName);
    HypothesisSet both{needless, hidden};
    std::sort(both.begin(), both.end());
    round.beginWith(both);
    REQUIRE(round.take());
    CHECK(round.causes() == std::vector<std::string>{kName});
    const auto& fitted = round.decision().fitted;
    REQUIRE(fitted.size() == 2);  // without either of them
    CHECK(std::count_if(fitted.begin(), fitted.end(), [](const FittedSet& own) { return own.outcome == kTaken; }) == 1);
}

TEST_CASE("Of two numbers one is taken back where the model has it right, none where both are wrong", "[updating]") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel believed = identify::testing::makeRandomDevice(random);
    for (const bool both_wrong : {true, false}) {
        MountModel truth = scale(believed, 1.5);
        const char* const other = "2.z.stiffness";
        if (both_wrong) setParameter(truth, other, 0.6 * getParameter(truth, other));
        Round round(truth, believed, random, 0.5);
        HypothesisSet both{round.find(kName), round.find("elastomer_stiffness 2.z")};
        std::sort(both.begin(), both.end());
        round.beginWith(both);
        CAPTURE(both_wrong);
        CHECK(round.takeFewer() != both_wrong);
        CHECK(round.causes().size() == (both_wrong ? 2 : 1));
        CHECK(round.decision().fitted.size() == 2);  // without either of them
    }
}

}  // namespace wems::identify::updating
