#include <catch2/catch.hpp>

#include "identify/commands/diagnosis_output.hpp"

using namespace wems;
using namespace wems::identify;
using Catch::Matchers::Contains;

namespace {

Diagnosis makeUnexplained() {
    Diagnosis diagnosis;
    diagnosis.verdict = Diagnosis::Verdict::unexplained;
    diagnosis.validated = true;
    diagnosis.error_before.validation = 0.25;
    return diagnosis;
}

}  // namespace

TEST_CASE("The headline of what no cause explains says how much it is") {
    const std::string text = commands::makeHeadline(makeUnexplained(), MountModel());
    CHECK_THAT(text, Contains("25 %") && Contains("no cause of the catalogue explains it."));
}

TEST_CASE("The headline names the axis of an elastic law that no cause has") {
    Diagnosis diagnosis = makeUnexplained();
    diagnosis.elastic_laws.resize(1);
    diagnosis.elastic_laws.front().where = "4.z";
    const std::string alone = commands::makeHeadline(diagnosis, MountModel());
    CHECK_THAT(alone, Contains("25 %") && Contains("the elastic force of 4.z has another form"));

    Cause cause;
    cause.cause = "cubic_stiffness";
    cause.parameters.resize(1);
    cause.parameters.front().name = "2.x.cubic";
    diagnosis.causes.push_back(cause);
    const std::string beside = commands::makeHeadline(diagnosis, MountModel());
    CHECK_THAT(beside, Contains("cubic_stiffness") && Contains("the elastic force of 4.z has another form"));
}
