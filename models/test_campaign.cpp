#include "models/test_campaign.hpp"

#include <algorithm>
#include <filesystem>

#include "models/common/error.hpp"
#include "models/common/toml_table.hpp"

namespace wems {
namespace {

class CampaignReader {
public:
    explicit CampaignReader(const std::string& file) : folder_(std::filesystem::path(file).parent_path()) {}

    TestCampaign read(TomlTable& root) {
        campaign_.name = root.findString("name").value_or("");
        campaign_.model = locate(root.findString("model").value_or(""));
        campaign_.columns = locate(root.findString("columns").value_or(""));
        campaign_.geometry = locate(root.findString("geometry").value_or(""));
        root.readTables("run", [this](TomlTable& table) { readRun(table); });
        return std::move(campaign_);
    }

private:
    std::string locate(const std::string& name) const { return name.empty() ? name : (folder_ / name).string(); }

    void readRun(TomlTable& table) {
        CampaignRun run;
        run.file = locate(table.requireString("file", "a recording's name, beside this file"));
        run.level = table.findString("level").value_or("");
        run.direction = table.findString("direction").value_or("");
        const std::string role = table.requireString("role", "identify, validate");
        if (role != "identify" && role != "validate") table.fail("role", "is \"" + role + "\"", "identify, validate");
        run.validates = role == "validate";
        const bool twice = std::any_of(campaign_.runs.begin(), campaign_.runs.end(),
                                       [&](const CampaignRun& other) { return other.file == run.file; });
        if (run.file.empty() || twice)
            table.fail("file", twice ? "\"" + run.file + "\" stands twice" : "is empty", "each recording once");
        campaign_.runs.push_back(std::move(run));
    }

    std::filesystem::path folder_;
    TestCampaign campaign_;
};

}  // namespace

std::vector<std::string> TestCampaign::listFiles(bool validating) const {
    std::vector<std::string> files;
    for (const CampaignRun& run : runs)
        if (run.validates == validating) files.push_back(run.file);
    return files;
}

std::string TestCampaign::describe(const std::string& file) const {
    for (const CampaignRun& run : runs) {
        if (run.file != file || (run.level.empty() && run.direction.empty())) continue;
        const char* comma = run.level.empty() || run.direction.empty() ? "" : ", ";
        return file + " (" + run.level + comma + run.direction + ")";
    }
    return file;
}

TestCampaign readTestCampaign(const std::string& file) {
    TestCampaign campaign;
    readTomlFile(file, [&](TomlTable& root) { campaign = CampaignReader(file).read(root); });
    if (campaign.listFiles(false).empty())
        throw InputError({file, 0, "run"}, "no run has the role identify", "[[run]] with role = \"identify\"");
    return campaign;
}

}  // namespace wems
