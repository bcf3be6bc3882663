#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "models/report/html_report.hpp"

using wems::decimateByShape;
using wems::HtmlReport;

TEST_CASE("Decimation keeps every extreme of its buckets") {
    const unsigned seed = std::random_device{}();
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

TEST_CASE("Text in a report cannot become markup or script") {
    HtmlReport report("a <b> & c");
    report.addText("<script>alert(1)</script>");
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
