#include <catch2/catch.hpp>
#include <limits>

#include "identify/fit/law_verdict.hpp"

using namespace wems::identify;

TEST_CASE("A law is judged by what it leaves of the force", "[law verdict]") {
    const double unknown = std::numeric_limits<double>::infinity();
    CHECK(judgeLaw(0.004, unknown) == LawVerdict::identified);
    CHECK(judgeLaw(0.2, unknown) == LawVerdict::doubtful);
    CHECK(judgeLaw(0.4, unknown) == LawVerdict::unexplained);
    // A weak signal in noise that the law explains down to the noise is identified.
    CHECK(judgeLaw(0.4, 1.1) == LawVerdict::identified);
    CHECK(judgeLaw(std::numeric_limits<double>::quiet_NaN(), unknown) == LawVerdict::unexplained);
    for (const LawVerdict verdict : {LawVerdict::identified, LawVerdict::doubtful, LawVerdict::unexplained})
        CHECK(describeLawVerdict(verdict).find(formatLawVerdict(verdict)) != std::string::npos);
}
