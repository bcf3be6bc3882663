// A recording that comes in blocks: the same levels, and the same things found, as when it comes at once.
#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

#include "identify/inspect/inspection.hpp"
#include "models/recording/recording_checks.hpp"
#include "tests/inspect/planted_run.hpp"
#include "tests/seed.hpp"

namespace wems::identify {
namespace {

/// Rows `first` to `last` of a recording, checked as a reader does.
Recording cut(const Recording& whole, std::size_t first, std::size_t last) {
    const auto take = [&](const std::vector<double>& v) {
        return std::vector<double>(v.begin() + static_cast<std::ptrdiff_t>(first),
                                   v.begin() + static_cast<std::ptrdiff_t>(last));
    };
    Recording block = whole;
    block.first_row = whole.first_row + static_cast<long>(first);
    block.time = take(whole.time);
    for (Channel& channel : block.channels) channel.values = take(channel.values);
    block.findings = repairAndCheck(block);
    return block;
}

Inspection inspectBlocks(const Recording& whole, std::size_t rows) {
    Inspector inspector(nullptr);
    for (std::size_t first = 0; first + 1 < whole.sampleCount(); first += rows - 1)
        inspector.add(cut(whole, first, std::min(first + rows, whole.sampleCount())));
    return inspector.finish();
}

}  // namespace

TEST_CASE("Levels, band and drive of blocks are those of the whole") {
    const unsigned seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937 random(seed);
    Recording run = test::makeSweptRun(random);
    run.findings = repairAndCheck(run);
    const Inspection whole = inspect(run, nullptr);
    const Inspection blocks = inspectBlocks(run, run.sampleCount() / 3);
    CHECK(whole.blocks == 1);
    CHECK(blocks.blocks > 2);
    CHECK(blocks.samples == whole.samples);
    CHECK(blocks.rate == Approx(whole.rate));
    CHECK(blocks.duration == Approx(whole.duration));
    REQUIRE(blocks.channels.size() == whole.channels.size());
    for (std::size_t c = 0; c < whole.channels.size(); ++c) {
        const ChannelStatistics &a = whole.channels[c], &b = blocks.channels[c];
        CAPTURE(a.name);
        CHECK(b.name == a.name);
        CHECK(b.lowest == a.lowest);
        CHECK(b.highest == a.highest);
        CHECK(b.mean == Approx(a.mean).margin(1e-9 * a.rms));
        CHECK(b.rms == Approx(a.rms).epsilon(1e-9));
    }
    CHECK(blocks.swept.source == whole.swept.source);
}

TEST_CASE("What is planted in one block is found once, by kind and channel, with its row") {
    const unsigned seed = 21;
    INFO("seed " << seed);
    std::mt19937 random(seed);
    Recording run = test::makeSweptRun(random);
    run.findings = repairAndCheck(run);
    REQUIRE(inspect(run, nullptr).findings.empty());
    const std::size_t at = run.sampleCount() / 2 + 37;
    auto& time = run.time;
    for (std::size_t k = at; k < time.size(); ++k) time[k] += 0.5;
    const Inspection blocks = inspectBlocks(run, run.sampleCount() / 3);
    const auto gap = std::find_if(blocks.findings.begin(), blocks.findings.end(),
                                  [](const Finding& finding) { return finding.kind == FindingKind::gap; });
    REQUIRE(gap != blocks.findings.end());
    CHECK(gap->row == run.first_row + static_cast<long>(at));
    CHECK(gap->message.find("the first of 1 among " + std::to_string(blocks.blocks) + " blocks") != std::string::npos);
}

TEST_CASE("Orders over blocks show each frequency where the drive was strongest") {
    OrderTracking low;
    low.time = {1, 2};
    low.hertz = {10, 20};
    low.reference = "load.fz";
    low.tracks.push_back(
        {"load.fz", Eigen::MatrixXd::Constant(tracked_orders, 2, 100.0), Eigen::MatrixXd::Zero(tracked_orders, 2)});
    low.tracks.push_back(
        {"mobile.1.z", Eigen::MatrixXd::Constant(tracked_orders, 2, 1e-3), Eigen::MatrixXd::Zero(tracked_orders, 2)});
    OrderTracking high = low;
    high.time = {11, 12};
    high.hertz = {10.01, 30};
    high.tracks[0].amplitude.setConstant(300);
    high.tracks[1].amplitude.setConstant(5e-3);
    OrderEnvelope envelope;
    envelope.add(low);
    envelope.add(high);
    envelope.add(low);
    const OrderTracking orders = envelope.finish();
    CHECK(orders.hertz == std::vector<double>{10.01, 20, 30});
    CHECK(orders.time == std::vector<double>{11, 2, 12});
    REQUIRE(orders.tracks.size() == 2);
    CHECK(orders.tracks[1].amplitude.row(0) == Eigen::RowVector3d(5e-3, 1e-3, 5e-3));
}

}  // namespace wems::identify
