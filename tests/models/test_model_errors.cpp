#include <catch2/catch.hpp>
#include <string>

#include "models/common/error.hpp"
#include "models/mount_model.hpp"

using namespace wems;

namespace {

// Line numbers in the cases below count in this text.
const std::string good = R"(name = "m"
gravity = [0.0, 0.0, -9.81]
[body]
mass = 8.0
inertia = [0.12, 0.12, 0.03]
[[connection]]
name = "1"
position = [0.1, 0.0, 0.0]
[connection.z]
stiffness = 1.0e5
stops = [ { side = "+", clearance = 1.0e-3, stiffness = 1.0e6 },
          { side = "-", clearance = 1.0e-3, stiffness = 1.0e6 } ]
[[connection]]
name = "2"
position = [-0.1, 0.0, 0.0]
[connection.x]
stiffness = 1.0e5
)";

std::string replaced(const std::string& from, const std::string& to) {
    std::string text = good;
    const auto place = text.find(from);
    REQUIRE(place != std::string::npos);
    return text.replace(place, from.size(), to);
}

struct Case {
    std::string from, to;  // empty `from`: appended
    long line;
    std::string key, part;
};

void check(const Case& bad) {
    const std::string text = bad.from.empty() ? good + bad.to : replaced(bad.from, bad.to);
    CAPTURE(bad.from, bad.to);
    try {
        parseMountModel(text, WEMS_SOURCE_DIR "/tests/models/data/m.toml");
        FAIL("was accepted");
    } catch (const InputError& error) {
        CAPTURE(error.what());
        CHECK(error.location().file == WEMS_SOURCE_DIR "/tests/models/data/m.toml");
        CHECK(error.location().line == bad.line);
        CHECK(error.location().key == bad.key);
        CHECK_THAT(error.what(), Catch::Contains(bad.part));
        CHECK_THAT(error.what(), !Catch::Contains("\n"));
    }
}

}  // namespace

TEST_CASE("the text that the errors start from is a model") {
    CHECK(parseMountModel(good, "m.toml").body.mass == 8);
}

TEST_CASE("bad model: syntax, unknown keys, wrong types") {
    check(GENERATE(values<Case>({
        {"mass = 8.0", "mass = = 8.0", 4, "", "not valid TOML"},
        {"mass = 8.0", "mass = 8.0\nmass = 9.0", 5, "", "not valid TOML"},
        {"name = \"m\"", "nmae = \"m\"", 1, "nmae", "accepted: name, gravity, body"},
        {"mass = 8.0", "mas = 8.0", 3, "body.mass", "missing"},
        {"mass = 8.0", "mass = 8.0\ncolour = 1", 5, "body.colour", "center_of_gravity"},
        {"[connection.z]", "[connection.w]", 6, "connection[0]", "no axis"},
        {"[connection.x]", "[connection.y]\nstiffness = 1\n[connection.w]", 18, "connection[1].w", "not known"},
        {"stiffness = 1.0e5\nstops", "stiffness = 1.0e5\ndampings = 1\nstops", 11, "connection[0].z.dampings",
         "damping"},
        {"stiffness = 1.0e6 },", "stiffness = 1.0e6, colour = 1 },", 11, "connection[0].z.stops[0].colour",
         "not known"},
        {"mass = 8.0", "mass = \"8\"", 4, "body.mass", "string"},
        {"mass = 8.0", "mass = [8.0]", 4, "body.mass", "array"},
        {"mass = 8.0", "mass = true", 4, "body.mass", "boolean"},
        {"name = \"m\"", "name = 3", 1, "name", "text in quotes"},
        {"name = \"1\"", "name = 1", 7, "connection[0].name", "text in quotes"},
        {"[0.1, 0.0, 0.0]", "[0.1, 0.0]", 8, "connection[0].position", "2 values"},
        {"[0.1, 0.0, 0.0]", "[0.1, \"a\", 0.0]", 8, "connection[0].position[1]", "string"},
        {"[0.12, 0.12, 0.03]", "[0.12, 0.12, 0.03, 0.0]", 5, "body.inertia", "Ixy"},
        {"[[connection]]", "[connection]", 13, "", "not valid TOML"},
        {"side = \"+\"", "side = \"up\"", 11, "connection[0].z.stops[0].side", "\"-\""},
    })));
}

TEST_CASE("bad model: missing keys") {
    check(GENERATE(values<Case>({
        {"inertia = [0.12, 0.12, 0.03]", "", 3, "body.inertia", "kg m^2"},
        {"position = [0.1, 0.0, 0.0]", "", 6, "connection[0].position", "missing"},
        {"name = \"2\"", "", 13, "connection[1].name", "missing"},
        {"stiffness = 1.0e5\nstops", "stops", 9, "connection[0].z.stiffness", "N/m"},
        {"clearance = 1.0e-3, ", "", 11, "connection[0].z.stops[0].clearance", "missing"},
        {", stiffness = 1.0e6 } ]", " } ]", 12, "connection[0].z.stops[1].stiffness", "missing"},
        {"side = \"+\", ", "", 11, "connection[0].z.stops[0].side", "missing"},
        {"", "relaxation = { stiffness_ratio = 0.1 }", 18, "connection[1].x.relaxation.time_constant", "missing"},
        {"", "friction = { force = 1.0 }", 18, "connection[1].x.friction.transition_velocity", "missing"},
        {"", "friction = { transition_velocity = 1.0 }", 18, "connection[1].x.friction.force", "missing"},
        {"", "hysteresis = { force = 1.0 }", 18, "connection[1].x.hysteresis.yield_displacement", "missing"},
        {"", "hysteresis = { yield_displacement = 1e-4 }", 18, "connection[1].x.hysteresis.force", "missing"},
        {"", "hysteresis = { force = 1.0, yield_displacement = 1e-4, beta = 0.5 }", 18,
         "connection[1].x.hysteresis.beta", "accepted: force, yield_displacement, exponent, shape"},
        {"", "hysteresis = 40.0", 18, "connection[1].x.hysteresis", "a table"},
        {"", "spectrum = [ { stiffness_ratio = 1.0 } ]", 18, "connection[1].x.spectrum[0].time_constant", "missing"},
        {"", "branches = [ { stiffness = 1.0 } ]", 18, "connection[1].x.branches[0].time_constant", "missing"},
        {"", "sliders = [ { force = 1.0 } ]", 18, "connection[1].x.sliders[0].yield_displacement", "missing"},
        {"", "sliders = [ { force = 1.0, yield_displacement = 1e-4, play = 1e-3 } ]", 18,
         "connection[1].x.sliders[0].play", "accepted: force, yield_displacement, gap, negative_force, exponent"},
        {"", "data_sheet = []", 18, "connection[1].x.data_sheet", "empty"},
        {"", "data_sheet = [[1.0, 1.0e5]]", 18, "connection[1].x.data_sheet[0]", "3 numbers"},
        {"", "data_sheet = [[0.0, 1.0e5, 0.1]]", 18, "connection[1].x.data_sheet[0]", "above 0, Hz"},
        {"", "data_sheet = [[2.0, 1.0e5, 0.1], [1.0, 1.0e5, 0.1]]", 18, "connection[1].x.data_sheet[1]", "ascending"},
        {"", "data_sheet = [[1.0, -1.0e5, 0.1]]", 18, "connection[1].x.data_sheet[0]", "above 0, N/m"},
        {"", "data_sheet = [[1.0, 1.0e5, -0.1]]", 18, "connection[1].x.data_sheet[0]", "from 0 on"},
        {"", "data_sheet = [[1.0, 2.0e5, 0.1], [10.0, 1.0e5, 0.1]]", 18, "connection[1].x.data_sheet", "passive"},
        {"", "data_sheet = [[1.0e-300, 1.0e5, 0.1]]", 18, "connection[1].x.data_sheet", "to compute with"},
        {"", "data_sheet = [[1.0, 1.0e308, 10.0]]", 18, "connection[1].x.data_sheet", "to compute with"},
        {"", "data_sheet = [[1.0e-9, 1.0e5, 0.1], [1.0e5, 2.0e5, 0.1]]", 18, "connection[1].x.data_sheet", "decades"},
        {"", "spring_pot = { stiffness = 1.0e5, exponent = 1.0, frequency = 10.0, band = [1.0, 100.0] }", 18,
         "connection[1].x.spring_pot.exponent", "below 1"},
        {"", "spring_pot = { stiffness = 1.0e5, exponent = 0.2, frequency = 10.0, band = [100.0, 1.0] }", 18,
         "connection[1].x.spring_pot.band", "ascending"},
        {"", "spring_pot = { stiffness = 1.0e5, exponent = 0.2, frequency = 10.0 }", 18,
         "connection[1].x.spring_pot.band", "two frequencies"},
        {"", "[bracket]\n", 18, "bracket.modes", "missing"},
        {"", "[load]\n", 18, "load", "has no gain"},
        {"", "[[sensor]]\ngain = 1.0\n", 18, "sensor[0].channel", "missing"},
    })));
    CHECK_THROWS_WITH(parseMountModel("name = \"m\"", "m.toml"), Catch::Contains("m.toml: body: is missing"));
    CHECK_THROWS_WITH(parseMountModel("[body]\nmass = 1.0\ninertia = [1, 1, 1]\n", "m.toml"),
                      Catch::Contains("m.toml: connection: there is none"));
    CHECK_THROWS_WITH(readMountModel("/nowhere/m.toml"), Catch::Contains("/nowhere/m.toml: there is no such file"));
}

TEST_CASE("a centre of gravity far out is accepted while it leaves six digits of the inertia") {
    CHECK_NOTHROW(
        parseMountModel(replaced("mass = 8.0", "mass = 8.0\ncenter_of_gravity = [0.0, 4000.0, 0.0]"), "m.toml"));
}

TEST_CASE("bad model: values out of range") {
    check(GENERATE(values<Case>({
        {"mass = 8.0", "mass = -8.0", 4, "body.mass", "-8"},
        {"mass = 8.0", "mass = 0", 4, "body.mass", "above 0"},
        {"mass = 8.0", "mass = nan", 4, "body.mass", "nan"},
        {"-9.81]", "inf]", 2, "gravity[2]", "inf"},
        {"[0.12, 0.12, 0.03]", "[0.12, 0.12, 0.25]", 5, "body.inertia", "sum of the other two"},
        // Beside mass x distance squared, round-off leaves fewer than six digits of 0.03 kg m^2: 0.03e-6 / 2^-52.
        {"mass = 8.0", "mass = 8.0\ncenter_of_gravity = [0.0, 4500.0, 0.0]", 5, "body.center_of_gravity",
         "1.35108e+08"},
        {"mass = 8.0", "mass = 8.0\ncenter_of_gravity = [0.0, 0.0, 1e300]", 5, "body.center_of_gravity", "at most"},
        {"mass = 8.0", "mass = 1e300\ncenter_of_gravity = [0.0, 0.0, 0.1]", 5, "body.center_of_gravity", "at most"},
        {"[0.12, 0.12, 0.03]", "[0.12, 0.12, -0.03]", 5, "body.inertia", "above 0"},
        {"[0.12, 0.12, 0.03]", "[0.12, 0.12, 0.03, 0.2, 0.0, 0.0]", 5, "body.inertia", "above 0"},
        {"stiffness = 1.0e5", "stiffness = -1.0e5", 10, "connection[0].z.stiffness", "from 0"},
        {"", "damping = -1.0", 18, "connection[1].x.damping", "from 0"},
        {"clearance = 1.0e-3", "clearance = -1.0e-3", 11, "connection[0].z.stops[0].clearance", "above 0"},
        {"clearance = 1.0e-3", "clearance = 0", 11, "connection[0].z.stops[0].clearance", "above 0"},
        {"stiffness = 1.0e6", "stiffness = nan", 11, "connection[0].z.stops[0].stiffness", "finite"},
        {"1.0e6 } ]", "1.0e6, dissipation = -1.0 } ]", 12, "connection[0].z.stops[1].dissipation", "from 0"},
        {"", "loss_factor = 0.9", 18, "connection[1].x.loss_factor", "below 0.5"},
        {"", "relaxation = { stiffness_ratio = 0.1, time_constant = 0.0 }", 18,
         "connection[1].x.relaxation.time_constant", "above 0"},
        {"", "friction = { force = -1.0, transition_velocity = 1.0 }", 18, "connection[1].x.friction.force", "from 0"},
        {"", "hysteresis = { force = -1.0, yield_displacement = 1e-4 }", 18, "connection[1].x.hysteresis.force",
         "from 0"},
        {"", "hysteresis = { force = 1.0, yield_displacement = 0 }", 18,
         "connection[1].x.hysteresis.yield_displacement", "above 0"},
        {"", "hysteresis = { force = 1.0, yield_displacement = 1e-4, exponent = 0.5 }", 18,
         "connection[1].x.hysteresis.exponent", "1 to 50"},
        {"", "hysteresis = { force = 1.0, yield_displacement = 1e-4, shape = 0.49 }", 18,
         "connection[1].x.hysteresis.shape", "0.5 to 1"},
        {"", "hysteresis = { force = 1.0, yield_displacement = 1e-4, shape = nan }", 18,
         "connection[1].x.hysteresis.shape", "nan"},
        {"name = \"2\"", "name = \"1\"", 14, "connection[1].name", "stands twice"},
        {"name = \"2\"", "name = \"a.b\"", 14, "connection[1].name", "dots"},
        {"name = \"2\"", "name = \"a b\"", 14, "connection[1].name", "blanks"},
        {"name = \"2\"", "name = \"\"", 14, "connection[1].name", "is \"\""},
        {"name = \"2\"", "name = \"a\\nb\"", 14, "connection[1].name", "a?b"},
    })));
}

TEST_CASE("bad model: bracket, load, sensors") {
    check(GENERATE(values<Case>({
        {"", "[bracket]\nmodes = \"\"", 19, "bracket.modes", "empty"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\nmode = 3", 20, "bracket.mode", "integer"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nfrequency = 3.0", 20, "bracket.mode[0].index",
         "1 to 2"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 3\nfrequency = 3.0", 21,
         "bracket.mode[0].index", "1 to 2"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 1.5", 21, "bracket.mode[0].index",
         "floating"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 1", 20, "bracket.mode[0]", "nothing"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 1\nfrequency = 0", 22,
         "bracket.mode[0].frequency", "above 0"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 1\ndamping_ratio = -0.1", 22,
         "bracket.mode[0].damping_ratio", "from 0"},
        {"",
         "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 1\nfrequency = 1.0\n[[bracket.mode]]\nindex "
         "= "
         "1\nfrequency = 2.0",
         24, "bracket.mode[1].index", "twice"},
        {"", "[load]\ngain = 1.0\ngain_over_frequency = [[1.0, 1.0]]", 18, "load", "both"},
        {"", "[load]\ngain_over_frequency = []", 19, "load.gain_over_frequency", "empty"},
        {"", "[load]\ngain_over_frequency = [1.0]", 19, "load.gain_over_frequency[0]", "rows of 2 numbers"},
        {"", "[load]\ngain_over_frequency = [[1.0]]", 19, "load.gain_over_frequency[0]", "2 numbers"},
        {"", "[load]\ngain_over_frequency = [[5.0, 1.0], [5.0, 1.0]]", 19, "load.gain_over_frequency[1]", "ascending"},
        {"", "[load]\ngain = \"a\"", 19, "load.gain", "a number"},
        {"", "[load]\npart = \"base\"", 19, "load.part", "mobile, fixed"},
        {"", "[load]\nposition = [1.0]", 19, "load.position", "three numbers"},
        {"mass = 8.0", "mass = 8.0\nmotion = [\"u\"]", 5, "body.motion", "\"rz\""},
        {"mass = 8.0", "mass = 8.0\nmotion = [\"z\", \"z\"]", 5, "body.motion", "twice"},
        {"mass = 8.0", "mass = 8.0\nmotion = []", 5, "body.motion", "at least one"},
        {"mass = 8.0", "mass = 8.0\nmotion = \"z\"", 5, "body.motion", "list of texts"},
        {"mass = 8.0", "mass = 8.0\nmotion = [1]", 5, "body.motion[0]", "list of texts"},
        {"", "[[sensor]]\nchannel = \"mobile.9.az\"", 19, "sensor[0].channel", "mobile.9.az"},
        {"", "[[sensor]]\nchannel = \"mobile.1.aw\"", 19, "sensor[0].channel", "mobile.1.aw"},
        {"", "[[sensor]]\nchannel = \"\"", 19, "sensor[0].channel", "is \"\""},
        {"", "[[sensor]]\nchannel = \"mobile.1\"\ndelay = nan", 20, "sensor[0].delay", "nan"},
        {"", "[[sensor]]\nchannel = \"mobile.1\"\nrotation = [1.0]", 20, "sensor[0].rotation", "three numbers"},
        {"", "[[sensor]]\nchannel = \"mobile.1\"\nzero = 1e-3", 20, "sensor[0].zero",
         "one channel, such as mobile.1.z"},
        {"", "[[sensor]]\nchannel = \"mobile.1.z\"\nzero = inf", 20, "sensor[0].zero", "inf"},
    })));
}

TEST_CASE("bad model: tolerances") {
    check(GENERATE(values<Case>({
        {"", "[tolerance]\nmass = -0.1", 19, "tolerance.mass", "from 0"},
        {"", "[tolerance]\nstiffness = nan", 19, "tolerance.stiffness", "nan"},
        {"", "[tolerance]\nstifness = 0.1", 19, "tolerance.stifness", "stop_stiffness"},
        {"", "tolerance = { mass = 0.1 }", 18, "connection[1].x.tolerance.mass", "accepted: stiffness, damping"},
        {"", "tolerance = { damping = -1 }", 18, "connection[1].x.tolerance.damping", "from 0"},
        {"mass = 8.0", "mass = 8.0\ntolerance = { stiffness = 0.1 }", 5, "body.tolerance.stiffness", "inertia"},
        {"name = \"2\"", "name = \"2\"\ntolerance = 0.1", 15, "connection[1].tolerance", "a table"},
        {"", "[bracket]\nmodes = \"every_key.csv\"\n[[bracket.mode]]\nindex = 1\ntolerance = {mode_shape = -1}", 22,
         "bracket.mode[0].tolerance.mode_shape", "from 0"},
        {"", "[[sensor]]\nchannel = \"mobile.1\"\ntolerance = { position = 1 }", 20, "sensor[0].tolerance.position",
         "sensor_position"},
    })));
    MountModel model = parseMountModel(good, "m.toml");
    model.connections[1].axis_tolerances[2].set(ToleranceOf::clearance, -1.0);
    CHECK_THROWS_WITH(validate(model), Catch::Contains("connection[1].z.tolerance.clearance"));
}

TEST_CASE("a modes file that is missing is named with its own path") {
    CHECK_THROWS_WITH(parseMountModel(good + "[bracket]\nmodes = \"none.csv\"", "/some/where/m.toml"),
                      Catch::Contains("/some/where/none.csv"));
}
