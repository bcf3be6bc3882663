// `simulate` as a user calls it: shipped models, results as data, and calls that must be refused.
#pragma once

#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/cli/run_program.hpp"

namespace wems::test {

using Json = nlohmann::json;

inline const std::string smallsat = WEMS_SOURCE_DIR "/models/shipped/smallsat_wems.toml";
inline const std::string single_axis = WEMS_SOURCE_DIR "/models/shipped/single_axis.toml";

inline ProgramResult runSimulate(const TemporaryDirectory& folder, const std::vector<std::string>& arguments) {
    const ProgramResult result = runProgram(SIMULATE_PROGRAM, arguments, folder.path());
    INFO(result.errors);
    REQUIRE(result.exit_status == 0);
    return result;
}

inline Json runJson(const TemporaryDirectory& folder, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--json", "-"});
    return Json::parse(runSimulate(folder, arguments).output);
}

/// One line on standard error, exit status 2, no file.
inline void checkRefused(const TemporaryDirectory& folder, std::vector<std::string> arguments) {
    CAPTURE(arguments);
    arguments.insert(arguments.end(), {"--json", "result.json"});
    const auto before = folder.list();
    const ProgramResult result = runProgram(SIMULATE_PROGRAM, arguments, folder.path());
    CHECK(result.exit_status == 2);
    CHECK(result.output.empty());
    CHECK(std::count(result.errors.begin(), result.errors.end(), '\n') == 1);
    CHECK(folder.list() == before);
}

}  // namespace wems::test
