#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "identify/updating/other_form.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

namespace wems::identify::updating {
namespace {

int findCubic(const TestProblem& problem, const std::string& where) {
    const auto& all = problem.hypotheses();
    for (std::size_t h = 0; h < all.size(); ++h)
        if (all[h].cause == "cubic_stiffness" && all[h].where == std::vector<std::string>{where})
            return static_cast<int>(h);
    return -1;
}

/// Pushes away from rest within a few lengths, and does nothing beyond.
std::vector<CurveRow> makeBuckling(double stiffness, double length) {
    std::vector<CurveRow> rows;
    for (int i = -60; i <= 60; ++i) {
        const double x = 0.1 * i, bell = std::exp(-0.5 * x * x);
        rows.push_back({x * length, -stiffness * length * x * bell, -stiffness * (1 - x * x) * bell});
    }
    return rows;
}

/// A device without contacts, of which one axis has another elastic law than is believed.
class Device {
public:
    explicit Device(unsigned seed) : random_(seed), seed_(seed) {
        hidden_ = hidden::drawCase("none", random_, hidden::Sensors::both);
        for (MountModel* model : {&hidden_.base, &hidden_.truth, &hidden_.believed})
            for (Connection& connection : model->connections)
                for (AxisLaw& each : connection.axis) each.stops.clear();
        connection_ = hidden::drawInteger(random_, 0, static_cast<int>(hidden_.truth.connections.size()) - 1);
        reach_ = hidden::simulateRelative(hidden_, hidden_.truth, 0).row(3 * connection_ + 2).cwiseAbs().maxCoeff();
    }

    AxisLaw& law() { return hidden_.truth.connections.at(static_cast<std::size_t>(connection_)).axis[2]; }
    double reach() const { return reach_; }  ///< m, of that axis without what is hidden
    hidden::Random& random() { return random_; }
    std::string place() const {
        return hidden_.believed.connections[static_cast<std::size_t>(connection_)].name + ".z";
    }
    /// At another connection, across: as much as a quarter of the largest force of that elastomer.
    void addFriction() {
        const std::size_t other = connection_ == 0 ? 1 : 0;
        const Eigen::MatrixXd q = hidden::simulateRelative(hidden_, hidden_.truth, 0);
        AxisLaw& across = hidden_.truth.connections.at(other).axis[0];
        const auto row = static_cast<Eigen::Index>(3 * other);
        const double largest = q.row(row).cwiseAbs().maxCoeff();
        across.friction = Friction{0.25 * across.stiffness * largest, 1e-3, {}};
    }
    Recording record() const { return hidden::recordForward(hidden_, 0, seed_); }
    const MountModel& believed() const { return hidden_.believed; }

private:
    hidden::Random random_;
    unsigned seed_;
    hidden::HiddenCase hidden_;
    int connection_ = 0;
    double reach_ = 0;
};

/// The believed device with a cubic stiffness at a place.
SetState settleCubic(const TestProblem& problem, const Settler& settler, const std::string& where) {
    SetState state;
    state.set = {findCubic(problem, where)};
    REQUIRE(state.set.front() >= 0);
    state.point = problem.believedPoint();
    state.view = problem.view(state.point, state.set);
    settler.settle(state, 16, true);
    return state;
}

/// What a static test of the true law shows, within four standard deviations and what sixteen cubics cannot follow: a
/// fiftieth of the hidden force. @param size of that, N
void checkLaw(const std::vector<ElasticLaw>& found, const std::string& place, const AxisLaw& truth, double size) {
    REQUIRE(found.size() == 1);
    const ElasticLaw& law = found.front();
    CHECK(law.where == place);
    double surest = size;
    for (std::size_t i = 0; i < law.displacement.size(); ++i) {
        const double error = law.force[i] - AxisForce(truth).calcStaticForce(law.displacement[i]);
        CAPTURE(i, law.displacement[i], law.force[i], error, law.deviation[i]);
        CHECK(std::abs(error) < 4 * law.deviation[i] + 0.02 * size);
        if (law.displacement[i] != 0) surest = std::min(surest, law.deviation[i]);
    }
    CHECK(surest < 0.05 * size);
}

}  // namespace

TEST_CASE("A cubic law stands where it is one, and falls where another elastic law was taken for it") {
    const unsigned seed = test::drawSeed();
    // The third: a cubic law, and friction of another axis that nothing was said of.
    for (const std::string hidden : {"cubic", "curve", "cubic and friction"}) {
        Device device(seed);
        AxisLaw& law = device.law();
        const double share = hidden::drawUniform(device.random(), 0.3, 0.7);
        const double length = device.reach() * hidden::drawUniform(device.random(), 0.15, 0.4);
        const bool is_cubic = hidden != "curve", is_all = hidden == "cubic";
        if (is_cubic)
            law.cubic = share * law.stiffness / (device.reach() * device.reach());
        else
            law.curve = makeBuckling(share * law.stiffness, length);
        if (hidden == "cubic and friction") device.addFriction();
        const TestProblem problem({device.record()}, {}, device.believed(), Numbers::exact);
        const Settler settler(problem);
        const SetState state = settleCubic(problem, settler, device.place());
        const std::vector<double> misfits = calcMisfits(sumOf(state.view, true), problem.estimateOf(state.point));
        const auto other = findOtherForm(problem, settler, state, state.set.front());
        const bool falls = other && other->log_odds > 0;
        CAPTURE(seed, hidden, share, length / device.reach(), misfits);
        CHECK(isSatisfied(misfits) == is_all);
        CHECK(falls != is_cubic);
        if (falls) checkLaw(other->laws, device.place(), law, share * law.stiffness * length);
    }
}

}  // namespace wems::identify::updating
