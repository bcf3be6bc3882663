#include <catch2/catch.hpp>
#include <random>
#include <sstream>

#include "models/report/html_report.hpp"
#include "models/report/motion_scene.hpp"
#include "tests/seed.hpp"

using namespace wems;

namespace {

MotionScene makeScene(std::mt19937& random) {
    MotionScene scene;
    scene.title = "moving";
    scene.model.connections.resize(2);
    scene.model.connections[0].name = "</script>";
    scene.model.connections[1].name = "b";
    scene.model.connections[1].axis[2].stops = {{Side::positive, 2e-3, 1e6, 0}, {Side::negative, 2e-3, 1e6, 0}};
    scene.model.connections[1].axis[2].offset = 5e-4;
    SceneRun run;
    run.name = "run";
    run.stations = {{12.5, 3.25, 1e-3, 0, 7}};
    std::normal_distribution<double> normal(0, 1e-3);
    const auto draw = [&](Eigen::Index rows) {
        return Eigen::MatrixXd::NullaryExpr(rows, 7, [&] { return normal(random); });
    };
    run.mobile = draw(6);
    run.fixed = draw(6);
    run.force = 1e6 * draw(6);
    run.closed = Eigen::MatrixXi::Zero(2, 7);
    run.closed(1, 4) = 1;
    scene.runs.push_back(run);
    return scene;
}

/// The values of `{unit:…,rows:…,values:[…]}` that follows `key`.
Eigen::MatrixXd readRows(const std::string& text, const std::string& key) {
    const auto at = text.find(key);
    REQUIRE(at != std::string::npos);
    const double unit = std::stod(text.substr(text.find("unit:", at) + 5));
    const int rows = std::stoi(text.substr(text.find("rows:", at) + 5));
    std::istringstream list(text.substr(text.find("values:[", at) + 8));
    std::vector<double> values;
    for (double value = 0; list >> value; list.ignore(1)) values.push_back(unit * value);
    return Eigen::Map<Eigen::MatrixXd>(values.data(), rows, static_cast<Eigen::Index>(values.size()) / rows);
}

}  // namespace

TEST_CASE("A scene keeps four digits of poses and forces") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    const MotionScene scene = makeScene(random);
    const std::string text = formatScene(scene);
    const SceneRun& run = scene.runs.front();
    const auto check = [&](const Eigen::MatrixXd& read, const Eigen::MatrixXd& value) {
        REQUIRE(read.cols() == value.cols());
        // Half a step, and up to 9999 times the six digits of the unit.
        CHECK((read - value).cwiseAbs().maxCoeff() <= (0.5 + 0.06) * value.cwiseAbs().maxCoeff() / 9999);
    };
    const auto fixed = text.find("fixed:{");
    check(readRows(text, "mobile:{p:"), run.mobile.topRows(3));
    check(readRows(text.substr(fixed), "theta:"), run.fixed.bottomRows(3));
    check(readRows(text, "force:"), run.force);
    CHECK(text.find("{hertz:12.5,time:3.25,period:0.001,from:0,count:7}") != std::string::npos);
    CHECK(text.find(R"(closed:["00","00","00","00","01","00","00",])") != std::string::npos);
}

TEST_CASE("Stops stand where they close: the clearance less the offset") {
    std::mt19937 random(1);
    const std::string text = formatScene(makeScene(random));
    CHECK(text.find(R"({name:"b.z.+",connection:1,axis:2,side:1,gap:0.0015})") != std::string::npos);
    CHECK(text.find(R"({name:"b.z.-",connection:1,axis:2,side:-1,gap:0.0025})") != std::string::npos);
}

TEST_CASE("Only a page with a moving device carries what draws it, and names cannot end its script") {
    std::mt19937 random(1);
    HtmlReport with("t"), without("t");
    with.addScene(makeScene(random));
    without.addPlot({"p", "x", "y", {{"s", {0, 1}, {0, 1}}}, false});
    CHECK(with.format().find("WebGLRenderer") != std::string::npos);
    CHECK(with.format().find("\\u003c/script>") != std::string::npos);
    CHECK(without.format().find("WebGLRenderer") == std::string::npos);
}
