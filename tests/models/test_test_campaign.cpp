#include <catch2/catch.hpp>
#include <chrono>
#include <filesystem>
#include <fstream>

#include "models/common/error.hpp"
#include "models/sensor_place.hpp"
#include "models/test_campaign.hpp"

using namespace wems;
using Catch::Contains;

namespace {

/// A file in a folder of its own, which goes with the object.
class Scratch {
public:
    explicit Scratch(const std::string& text)
        : folder_(std::filesystem::temp_directory_path() / ("wems_campaign_" + std::to_string(counter()++))) {
        std::filesystem::create_directories(folder_);
        std::ofstream(folder_ / "test.toml") << text;
    }
    ~Scratch() {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    std::string file() const { return (folder_ / "test.toml").string(); }
    std::string beside(const std::string& name) const { return (folder_ / name).string(); }

private:
    static int& counter() {
        static int count = static_cast<int>(std::chrono::steady_clock::now().time_since_epoch().count() % 1000000000);
        return count;
    }
    std::filesystem::path folder_;
};

const std::string good =
    "name = \"spring\"\nmodel = \"m.toml\"\n"
    "[[run]]\nfile = \"a.csv\"\nlevel = \"200 N\"\ndirection = \"z\"\nrole = \"identify\"\n"
    "[[run]]\nfile = \"b.mat\"\nrole = \"validate\"\n";

}  // namespace

TEST_CASE("A test lists its runs by role, beside its file") {
    const Scratch scratch(good);
    const TestCampaign campaign = readTestCampaign(scratch.file());
    CHECK(campaign.name == "spring");
    CHECK(campaign.model == scratch.beside("m.toml"));
    CHECK(campaign.columns.empty());
    CHECK(campaign.listFiles(false) == std::vector<std::string>{scratch.beside("a.csv")});
    CHECK(campaign.listFiles(true) == std::vector<std::string>{scratch.beside("b.mat")});
    CHECK(campaign.describe(scratch.beside("a.csv")) == scratch.beside("a.csv") + " (200 N, z)");
    CHECK(campaign.describe(scratch.beside("b.mat")) == scratch.beside("b.mat"));
}

TEST_CASE("A test file that cannot be used says where") {
    struct Case {
        std::string text, problem;
    };
    const auto c = GENERATE(values<Case>({
        {"[[run]]\nfile = \"a.csv\"\nrole = \"fit\"\n", ":3: run[0].role: is \"fit\" (accepted: identify, validate)"},
        {"[[run]]\nfile = \"a.csv\"\nrole = \"validate\"\n", "no run has the role identify"},
        {"[[run]]\nrole = \"identify\"\n", "file: is missing"},
        {"[[run]]\nfile = \"a.csv\"\nrole = \"identify\"\n[[run]]\nfile = \"a.csv\"\nrole = \"validate\"\n",
         "stands twice"},
        {"runs = 3\n", "runs: is not known here"},
        {"[[run]\n", "not valid TOML"},
    }));
    const Scratch scratch(c.text);
    CHECK_THROWS_WITH(readTestCampaign(scratch.file()), Contains("test.toml") && Contains(c.problem));
}

TEST_CASE("Sensors are read from a file of their own") {
    const Scratch scratch(
        "[[accelerometer]]\nname = \"A3\"\npart = \"mobile\"\nposition = [0.05, 0.02, 0.3]\n"
        "rotation = [0.0, 0.0, 1.5707963267948966]\nnoise = 0.02\nchannels = { x = \"CH 4\", z = \"CH 5\" }\n"
        "[[marker]]\nname = \"A3\"\npart = \"fixed\"\nposition = [0, 0, 0]\n");
    const auto places = readSensorPlaces(scratch.file());
    REQUIRE(places.size() == 2);
    CHECK(!places[0].accelerometer);
    const SensorPlace& place = places[1];
    CHECK(place.direction(0).isApprox(Eigen::Vector3d::UnitY(), 1e-12));
    CHECK(place.channelName(2) == "mobile.A3.az");
    CHECK(place.noise == 0.02);
    ColumnMap map;
    addColumns(places, map);
    REQUIRE(map.columns.size() == 2);
    CHECK(map.columns[0].column == "CH 4");
    CHECK(map.columns[1].channel == "mobile.A3.az");
    CHECK_THROWS_WITH(addColumns(places, map), Contains("by the column map and by the geometry"));
}

TEST_CASE("Sensors that cannot be are refused with file and line") {
    struct Case {
        std::string text, problem;
    };
    const auto c = GENERATE(values<Case>({
        {"", "there is no [[marker]]"},
        {"[[marker]]\nname = \"a\"\npart = \"side\"\nposition = [0, 0, 0]\n", ":3: marker[0].part: is \"side\""},
        {"[[marker]]\nname = \"a.b\"\npart = \"fixed\"\nposition = [0, 0, 0]\n", "a name without points"},
        {"[[marker]]\nname = \"a\"\npart = \"fixed\"\n", "position: is missing"},
        {"[[marker]]\nname = \"a\"\npart = \"fixed\"\nposition = [0, 0, 0]\nnoise = -1\n", "noise: is negative"},
        {"[[marker]]\nname = \"a\"\npart = \"fixed\"\nposition = [0, 0, 0]\nchannels = { w = \"a\" }\n",
         "w: is not known here"},
    }));
    const Scratch scratch(c.text.empty() ? "# nothing\n" : c.text);
    CHECK_THROWS_WITH(readSensorPlaces(scratch.file()), Contains("test.toml") && Contains(c.problem));
}
