#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "models/report/html_report.hpp"
#include "tests/seed.hpp"

using wems::decimateByShape;
using wems::decimateCloud;
using wems::HtmlReport;

TEST_CASE("Decimation keeps every extreme of its buckets") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> y(50000);
    for (auto& value : y) value = normal(random);
    y[12345] = 40;  // a single outlier must survive
    y[44444] = -40;
    const auto kept = decimateByShape(y, 500);
    CHECK(kept.size() <= 4 * 500);
    CHECK(std::is_sorted(kept.begin(), kept.end()));
    CHECK(std::count(kept.begin(), kept.end(), 12345U) == 1);
    CHECK(std::count(kept.begin(), kept.end(), 44444U) == 1);
    CHECK(kept.front() == 0);
    CHECK(kept.back() == y.size() - 1);
}

TEST_CASE("A short series is kept whole") {
    CHECK(decimateByShape({3, 1, 2}, 10) == std::vector<std::size_t>{0, 1, 2});
    CHECK(decimateByShape({}, 10).empty());
}

TEST_CASE("A cloud keeps its shape: every cell that holds a point keeps one, rare points stay") {
    const unsigned seed = wems::test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<double> x(50000), y(50000);
    for (auto& value : x) value = normal(random);
    for (auto& value : y) value = normal(random);
    x[777] = 30;  // alone in its corner
    y[777] = -30;
    x[5] = NAN;
    const auto kept = decimateCloud(x, y, 2000);
    CHECK(kept.size() <= 2000);
    CHECK(kept.size() > 500);  // the grid is as fine as that allows
    CHECK(std::is_sorted(kept.begin(), kept.end()));
    CHECK(std::count(kept.begin(), kept.end(), 777U) == 1);
    CHECK(std::count(kept.begin(), kept.end(), 5U) == 0);
    // Every point has one that was kept in its neighbourhood: within two cells of the coarsest grid that can be taken.
    const double cell = 2 * 60.0 / std::sqrt(500.0);
    for (std::size_t i = 6; i < x.size(); i += 97)
        CHECK(std::any_of(kept.begin(), kept.end(),
                          [&](std::size_t k) { return std::hypot(x[k] - x[i], y[k] - y[i]) < cell; }));
    CHECK(decimateCloud({1, 1, 1}, {2, 2, 2}, 2) == std::vector<std::size_t>{0});
    CHECK(decimateCloud({3, 1, 2}, {0, 0, 0}, 3) == std::vector<std::size_t>{0, 1, 2});
}

TEST_CASE("On a logarithmic axis what is not positive is a gap; series may differ from their plot") {
    HtmlReport report("t");
    report.addPlot({"p", "x", "y", {{"s", {1, 2, 3}, {10, 0, 0.1}}, {"c", {1}, {2}, true, 7}}, false, true});
    const auto page = report.format();
    CHECK(page.find(R"(logY:true,series:[{name:"s",points:false,color:0,x:[1,2,3,],y:[10,NaN,0.1,]})") !=
          std::string::npos);
    CHECK(page.find(R"({name:"c",points:true,color:7,)") != std::string::npos);
}

TEST_CASE("A surface carries its cells row by row and what draws it") {
    HtmlReport report("t");
    wems::ForceSurface surface{"a <s>", "q", "v", "f", Eigen::Vector2d(1, 2), Eigen::Vector3d(3, 4, 5), {}};
    Eigen::MatrixXd force(2, 3);
    force << 1, 2, 3, 4, NAN, 6;
    surface.sheets.push_back({"law", force, false, 1});
    report.addSurface(surface);
    const auto page = report.format();
    CHECK(page.find("a &lt;s&gt;</figcaption>") != std::string::npos);
    CHECK(page.find(R"(x:{label:"q",values:[1,2,]},y:{label:"v",values:[3,4,5,]},z:{label:"f"})") != std::string::npos);
    CHECK(page.find(R"({name:"law",points:false,color:1,values:[1,2,3,4,NaN,6,]})") != std::string::npos);
    CHECK(page.find("WebGLRenderer") != std::string::npos);
}

TEST_CASE("Columns of numbers are aligned at the right with their headers, words at the left") {
    HtmlReport report("t");
    report.addTable({"1", "value", "interval", "what", "at"}, {{"2", "1e-3", "-5 … 5.2", "1.z.stiffness", "4.2 @ 31"},
                                                               {"3", "no stop", "", "2.z", "-"},
                                                               {"4", "12", "+1 … 2", "-", "7 @ 8"}});
    const auto page = report.format();
    for (const char* header : {"1", "what"})
        CHECK(page.find("<th scope=\"col\" class=\"\">" + std::string(header) + "</th>") != std::string::npos);
    for (const char* header : {"value", "interval", "at"})
        CHECK(page.find("<th scope=\"col\" class=\"number\">" + std::string(header) + "</th>") != std::string::npos);
    CHECK(page.find("<td class=\"number short\">no stop</td>") != std::string::npos);
    CHECK(page.find("<td class=\" short\">1.z.stiffness</td>") != std::string::npos);
}

TEST_CASE("Text in a report cannot become markup or script") {
    HtmlReport report("a <b> & c");
    report.addText("<script>alert(1)</script>");
    report.addLead("<script>alert(1)</script>");
    report.addList({"<script>alert(1)</script>"});
    report.addPlot({"p", "x", "y", {{"</script>\"\\", {0, 1}, {0, NAN}}}, false});
    const auto page = report.format();
    CHECK(page.find("a &lt;b&gt; &amp; c") != std::string::npos);
    CHECK(page.find("<script>alert(1)") == std::string::npos);
    CHECK(page.find("\\u003c/script>\\\"\\\\") != std::string::npos);
}

TEST_CASE("A report loads nothing from elsewhere") {
    HtmlReport report("t");
    report.addPlot({"p", "x", "y", {{"s", {0, 1}, {0, 1}}}, false});
    const auto page = report.format();
    CHECK(page.find("<script src") == std::string::npos);
    CHECK(page.find("<link") == std::string::npos);
    CHECK(page.size() < 400000);
}
