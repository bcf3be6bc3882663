#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

#include "identify/exact/catalogue.hpp"
#include "tests/diagnose/hidden_device.hpp"
#include "tests/hidden/random_case.hpp"
#include "tests/seed.hpp"

using namespace wems;
using namespace wems::identify;

TEST_CASE("Every candidate can be tried, is documented, and is met by the hidden cases", "[diagnose]") {
    const auto seed = test::drawSeed();
    CAPTURE(seed);
    std::mt19937_64 random(seed);
    const MountModel model = identify::testing::makeRandomDevice(random);
    std::ifstream stream(WEMS_SOURCE_DIR "/identify/diagnose/README.md");
    const std::string document(std::istreambuf_iterator<char>(stream), {});
    for (const auto& candidate : makeCatalogue(model, true)) {
        CAPTURE(candidate.describe());
        const auto& causes = hidden::listCauses();
        CHECK(std::count(causes.begin(), causes.end(), candidate.cause) == 1);
        CHECK_THAT(document, Catch::Contains("`" + candidate.cause + "`"));
        REQUIRE_FALSE(candidate.starts.empty());
        for (const auto& start : candidate.starts) {
            REQUIRE(start.size() == candidate.knobs.size());
            MountModel changed = model;
            candidate.apply(changed, start);
            for (std::size_t k = 0; k < start.size(); ++k) {
                const Knob& knob = candidate.knobs[k];
                CHECK(knob.get(changed) == Approx(start[k]));
                CHECK((knob.scale(model) > 0 && std::isfinite(knob.scale(model))));
                CHECK(start[k] >= knob.lowest(model));
                CHECK(start[k] <= knob.highest(model));
            }
        }
    }
}
