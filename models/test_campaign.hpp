/// @file
/// Several runs as one test. A TOML file:
///
///     name = "SmallSat, axial and oblique"     # optional
///     model = "smallsat_wems.toml"             # optional: --model says it too
///     columns = "columns.toml"                 # optional: column map of every run
///     geometry = "layout.toml"                 # optional: sensors that are not at the connections
///     [[run]]
///     file = "axial_200.csv"
///     level = "200 N"                          # optional, for the reader
///     direction = "z"                          # optional, likewise
///     role = "identify"                        # or "validate": judges, never fitted to
///
/// Files are looked for beside the test file.
#pragma once

#include <string>
#include <vector>

namespace wems {

struct CampaignRun {
    std::string file;  ///< from the working folder
    std::string level, direction;
    bool validates = false;
};

struct TestCampaign {
    std::string name, model, columns, geometry;  ///< empty where absent; files from the working folder
    std::vector<CampaignRun> runs;

    /// Files of the runs of one role.
    std::vector<std::string> listFiles(bool validating) const;
    /// `axial_200.csv (200 N, z)`; the file alone if it is no run of this test.
    std::string describe(const std::string& file) const;
};

/// @throws InputError with file, line and key: unknown key or role, no run to identify from, a file that stands twice.
TestCampaign readTestCampaign(const std::string& file);

}  // namespace wems
