#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "models/axis_numbers.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/common/text_file.hpp"
#include "models/common/toml_table.hpp"
#include "models/device_drawing.hpp"
#include "models/mount_model.hpp"
#include "models/sensor_place_toml.hpp"
#include "models/viscoelastic.hpp"

namespace wems {
namespace {

/// The keys that belong to `where`, or all of them in the table [tolerance] of the model.
Tolerances readTolerances(TomlTable& table, std::string_view where = {}) {
    Tolerances tolerances;
    table.readTable("tolerance", [&](TomlTable& values) {
        for (std::size_t k = 0; k < kToleranceKeys.size(); ++k) {
            const ToleranceKey& key = kToleranceKeys[k];
            if (!where.empty() && where != key.table) continue;
            const auto value = values.findNumber(key.key);
            if (value && *value < 0) values.fail(key.key, "is negative", "a number from 0 on, 0 if exactly known");
            tolerances.set(static_cast<ToleranceOf>(k), value);
        }
    });
    return tolerances;
}

Stop readStop(TomlTable& table) {
    Stop stop;
    const std::string side = table.requireString("side", "\"+\" or \"-\"");
    if (side != "+" && side != "-") table.fail("side", "is \"" + side + "\"", "\"+\" or \"-\"");
    stop.side = side == "+" ? Side::positive : Side::negative;
    stop.clearance = table.requireNumber("clearance", "m");
    stop.stiffness = table.requireNumber("stiffness", "N/m");
    stop.dissipation = table.findNumber("dissipation").value_or(0);
    return stop;
}

Friction readFriction(TomlTable& table) {
    Friction friction;
    friction.force = table.requireNumber("force", "N");
    friction.presliding_stiffness = table.findNumber("presliding_stiffness");
    // The law with presliding has no use for the transition velocity.
    friction.transition_velocity =
        friction.presliding_stiffness ? table.findNumber("transition_velocity").value_or(Friction{}.transition_velocity)
                                      : table.requireNumber("transition_velocity", "m/s");
    return friction;
}

Hysteresis readHysteresis(TomlTable& table) {
    Hysteresis hysteresis;
    hysteresis.force = table.requireNumber("force", "N");
    hysteresis.yield_displacement = table.requireNumber("yield_displacement", "m");
    hysteresis.exponent = table.findNumber("exponent").value_or(hysteresis.exponent);
    hysteresis.shape = table.findNumber("shape").value_or(hysteresis.shape);
    return hysteresis;
}

MaxwellBranch readBranch(TomlTable& table) {
    return {table.requireNumber("stiffness", "N/m"), table.requireNumber("time_constant", "s")};
}

Relaxation readRelaxation(TomlTable& table) {
    return {table.requireNumber("stiffness_ratio", ""), table.requireNumber("time_constant", "s")};
}

Slider readSlider(TomlTable& table) {
    Slider slider;
    slider.force = table.requireNumber("force", "N");
    slider.yield_displacement = table.requireNumber("yield_displacement", "m");
    slider.gap = table.findNumber("gap").value_or(0);
    slider.negative_force = table.findNumber("negative_force");
    slider.exponent = table.findNumber("exponent");
    return slider;
}

void checkBand(const TomlTable& table, const std::string& key, double lower, double upper) {
    if (std::log10(upper / lower) > mostDecades())
        table.fail(key, "spans " + formatNumber(std::log10(upper / lower), 3) + " decades of frequency",
                   formatNumber(mostDecades(), 2) + " at most");
}

void checkFinite(const TomlTable& table, const std::string& key, const ViscoelasticSeries& series) {
    if (!std::isfinite(series.largest_error))
        table.fail(key, "holds numbers too large or too small to compute with", "frequencies in Hz, stiffness in N/m");
}

/// data_sheet = [[10.0, 1.0e5, 0.12], …]: Hz, N/m, loss factor.
ViscoelasticSeries readDataSheet(const TomlTable& table, const std::vector<std::vector<double>>& cells) {
    if (cells.empty()) table.fail("data_sheet", "is empty", "rows of frequency (Hz), stiffness (N/m), loss factor");
    std::vector<StiffnessRow> rows;
    for (const std::vector<double>& cell : cells) {
        const std::string key = "data_sheet[" + std::to_string(rows.size()) + "]";
        const auto refuse = [&](const std::string& what, double value, const char* accepted) {
            table.fail(key, "has " + what + " " + formatNumber(value), accepted);
        };
        if (!(cell[0] > 0)) refuse("the frequency", cell[0], "a number above 0, Hz");
        if (!rows.empty() && cell[0] <= rows.back().frequency)
            refuse("the frequency", cell[0], "ascending frequencies");
        if (!(cell[1] > 0)) refuse("the stiffness", cell[1], "a number above 0, N/m");
        if (!(cell[2] >= 0)) refuse("the loss factor", cell[2], "a number from 0 on");
        rows.push_back({cell[0], cell[1], cell[2]});
    }
    checkBand(table, "data_sheet", rows.front().frequency, rows.back().frequency);
    ViscoelasticSeries series = fitSeries(rows);
    checkFinite(table, "data_sheet", series);
    if (series.largest_error > kLargestSheetError)
        table.fail("data_sheet",
                   "is " + formatNumber(100 * series.largest_error, 2) + " % off the nearest passive material",
                   "a stiffness that rises with the frequency as its loss factor demands");
    return series;
}

ViscoelasticSeries readSpringPot(TomlTable& table) {
    SpringPot pot;
    pot.stiffness = table.requireNumber("stiffness", "N/m");
    pot.exponent = table.requireNumber("exponent", "");
    pot.frequency = table.requireNumber("frequency", "Hz");
    const std::vector<double> band = table.requireNumbers("band", {2}, "two frequencies, Hz");
    pot.band = {band[0], band[1]};
    if (!(pot.stiffness > 0)) table.fail("stiffness", "is " + formatNumber(pot.stiffness), "a number above 0, N/m");
    if (!(pot.exponent > 0 && pot.exponent < 1))
        table.fail("exponent", "is " + formatNumber(pot.exponent), "above 0, below 1");
    if (!(pot.frequency > 0)) table.fail("frequency", "is " + formatNumber(pot.frequency), "a number above 0, Hz");
    if (!(band[0] > 0 && band[1] > band[0])) table.fail("band", "is empty", "two ascending frequencies above 0, Hz");
    checkBand(table, "band", band[0], band[1]);
    ViscoelasticSeries series = makeSeries(pot);
    checkFinite(table, "", series);
    return series;
}

/// What an elastomer is by its data sheet or as a spring-pot adds to its other numbers.
void readSeries(TomlTable& table, AxisLaw& law) {
    std::optional<ViscoelasticSeries> series;
    const auto sheet = table.findRows("data_sheet", 3);
    if (sheet) series = readDataSheet(table, *sheet);
    table.readTable("spring_pot", [&](TomlTable& pot) {
        if (sheet) table.fail("", "has both data_sheet and spring_pot", "one of them");
        series = readSpringPot(pot);
    });
    if (!series) return;
    law.stiffness += series->stiffness;
    law.damping += series->damping;
    // They follow the stiffness, which a fit moves; without any they stand by themselves.
    for (const MaxwellBranch& branch : series->branches)
        if (law.stiffness > 0)
            law.spectrum.push_back({branch.stiffness / law.stiffness, branch.time_constant});
        else
            law.branches.push_back(branch);
}

/// curve = [[-1.0e-3, -90.0], [0.0, 0.0], …]: m, N, and perhaps the slope there, N/m.
std::vector<CurveRow> readCurve(TomlTable& table) {
    std::vector<CurveRow> rows;
    const auto cells = table.findRows("curve", 2, 3);
    if (!cells) return rows;
    for (const std::vector<double>& cell : *cells)
        rows.push_back({cell[0], cell[1], cell.size() > 2 ? std::optional<double>(cell[2]) : std::nullopt});
    if (const auto problem = findProblem(rows))
        table.fail(problem->row < 0 ? "curve" : "curve[" + std::to_string(problem->row) + "]", problem->problem,
                   problem->accepted);
    return rows;
}

AxisLaw readAxis(TomlTable& table) {
    AxisLaw law;
    const bool has_series = table.has("data_sheet") || table.has("spring_pot"), has_curve = table.has("curve");
    for (const AxisNumber& number : kAxisNumbers)
        law.*number.member = number.presence == AxisNumber::Presence::required && !has_series && !has_curve
                                 ? table.requireNumber(number.key, number.unit)
                                 : table.findNumber(number.key).value_or(0);
    table.readTables("stops", [&law](TomlTable& stop) { law.stops.push_back(readStop(stop)); });
    table.readTable("relaxation", [&law](TomlTable& relaxation) { law.relaxation = readRelaxation(relaxation); });
    table.readTable("friction", [&law](TomlTable& friction) { law.friction = readFriction(friction); });
    table.readTable("hysteresis", [&law](TomlTable& hysteresis) { law.hysteresis = readHysteresis(hysteresis); });
    table.readTables("branches", [&law](TomlTable& branch) { law.branches.push_back(readBranch(branch)); });
    table.readTables("spectrum", [&law](TomlTable& part) { law.spectrum.push_back(readRelaxation(part)); });
    table.readTables("sliders", [&law](TomlTable& slider) { law.sliders.push_back(readSlider(slider)); });
    law.curve = readCurve(table);
    if (!table.has("stiffness") && !has_series) moveSlopeToStiffness(law);
    readSeries(table, law);
    return law;
}

Connection readConnection(TomlTable& table) {
    Connection connection;
    connection.name = table.requireString("name", "text in quotes");
    connection.position = table.requireVector("position", "m");
    bool any_axis = false;
    for (std::size_t k = 0; k < 3; ++k) {
        any_axis |= table.readTable(std::string(1, "xyz"[k]), [&](TomlTable& axis) {
            connection.axis[k] = readAxis(axis);
            connection.axis_tolerances[k] = readTolerances(axis, "axis");
        });
    }
    connection.tolerances = readTolerances(table, "connection");
    if (!any_axis) table.fail("", "has no axis", "at least one of the tables x, y, z");
    return connection;
}

MobileBody readBody(TomlTable& table) {
    MobileBody body;
    body.mass = table.requireNumber("mass", "kg");
    body.center_of_gravity = table.findVector("center_of_gravity").value_or(Eigen::Vector3d::Zero());
    const auto I =
        table.requireNumbers("inertia", {3, 6}, "Ixx, Iyy, Izz, or Ixx, Iyy, Izz, Ixy, Ixz, Iyz about the CoG, kg m^2");
    body.inertia = Eigen::Vector3d(I[0], I[1], I[2]).asDiagonal();
    if (I.size() == 6) {
        body.inertia(0, 1) = body.inertia(1, 0) = I[3];
        body.inertia(0, 2) = body.inertia(2, 0) = I[4];
        body.inertia(1, 2) = body.inertia(2, 1) = I[5];
    }
    body.spin = table.findVector("spin").value_or(Eigen::Vector3d::Zero());
    if (const auto motions = table.findStrings("motion")) {
        body.free.fill(false);
        for (const std::string& motion : *motions) {
            const auto found = std::find(kMotionNames.begin(), kMotionNames.end(), motion);
            if (found == kMotionNames.end())
                table.fail("motion", "holds \"" + motion + "\"", "some of \"x\", \"y\", \"z\", \"rx\", \"ry\", \"rz\"");
            bool& free = body.free[found - kMotionNames.begin()];
            if (free) table.fail("motion", "holds \"" + motion + "\" twice", "each motion once");
            free = true;
        }
    }
    body.tolerances = readTolerances(table, "body");
    return body;
}

/// [[bracket.mode]]: new frequency, damping or tolerances of one row of the modes file.
void replaceMode(TomlTable& table, MountModel& model, std::set<long>& seen) {
    const auto count = static_cast<long>(model.bracket.size());
    const std::string rows = "a row of the modes file, 1 to " + std::to_string(count);
    const long index = table.requireInteger("index", rows);
    const Tolerances tolerances = readTolerances(table, "mode");
    if (index < 1 || index > count) table.fail("index", "is " + std::to_string(index), rows);
    if (!seen.insert(index).second) table.fail("index", std::to_string(index) + " stands twice", "each row once");
    const auto frequency = table.findNumber("frequency");
    const auto damping_ratio = table.findNumber("damping_ratio");
    if (!frequency && !damping_ratio && tolerances.empty())
        table.fail("", "replaces nothing", "frequency, damping_ratio or both, or a tolerance");
    if (frequency && !(*frequency > 0)) table.fail("frequency", "is not above 0", "a number above 0, Hz");
    if (damping_ratio && !(*damping_ratio >= 0)) table.fail("damping_ratio", "is negative", "a number from 0 on");
    BracketMode& mode = model.bracket[index - 1];
    mode.frequency = frequency.value_or(mode.frequency);
    mode.damping_ratio = damping_ratio.value_or(mode.damping_ratio);
    mode.tolerances = tolerances;
    if (frequency || damping_ratio) model.replaced_modes.push_back(static_cast<int>(index));
}

void readBracket(TomlTable& table, const std::string& file, MountModel& model) {
    model.bracket_file = table.requireString("modes", "the name of the modes file, beside this one");
    if (model.bracket_file.empty()) table.fail("modes", "is empty", "the name of the modes file, beside this one");
    model.bracket_path = (std::filesystem::path(file).parent_path() / model.bracket_file).string();
    model.bracket = readBracketModes(model.bracket_path);
    std::set<long> seen;
    table.readTables("mode", [&](TomlTable& mode) { replaceMode(mode, model, seen); });
}

void readLoad(TomlTable& table, MountModel& model) {
    const auto gain = table.findNumber("gain");
    const auto rows = table.findRows("gain_over_frequency", 2);
    const auto axis_gain = table.findVector("axis_gain");
    const auto part = table.findString("part");
    const auto position = table.findVector("position");
    if (gain && rows) table.fail("", "has both gain and gain_over_frequency", "gain or gain_over_frequency");
    if (!gain && !rows && !axis_gain && !part && !position)
        table.fail("", "has no gain", "gain or gain_over_frequency, axis_gain, part, position");
    if (part && *part != "mobile" && *part != "fixed") table.fail("part", "is \"" + *part + "\"", "mobile, fixed");
    if (gain) model.load = LoadCorrection{{{0.0, *gain}}};
    if (rows) {
        model.load.emplace();
        for (const std::vector<double>& row : *rows) model.load->gain_over_frequency.emplace_back(row[0], row[1]);
    }
    if (axis_gain) {
        if (!model.load) model.load = LoadCorrection{{{0.0, 1.0}}};
        model.load->axis_gain = *axis_gain;
    }
    const bool mobile = part == "mobile";
    if (mobile || position)
        model.load_point = LoadPoint{mobile ? Part::mobile : Part::fixed, position.value_or(Eigen::Vector3d::Zero())};
}

SensorFault readSensor(TomlTable& table) {
    SensorFault sensor;
    sensor.channel = table.requireString("channel", "a channel such as \"mobile.1.az\", or \"mobile.1\"");
    sensor.gain = table.findNumber("gain").value_or(1);
    sensor.delay = table.findNumber("delay").value_or(0);
    sensor.rotation = table.findVector("rotation").value_or(Eigen::Vector3d::Zero());
    sensor.zero = table.findNumber("zero").value_or(0);
    sensor.tolerances = readTolerances(table, "sensor");
    return sensor;
}

void readRoot(TomlTable& root, const std::string& file, MountModel& model) {
    model.name = root.findString("name").value_or("");
    model.gravity = root.findVector("gravity").value_or(Eigen::Vector3d::Zero());
    if (!root.readTable("body", [&model](TomlTable& body) { model.body = readBody(body); })) {
        root.fail("body", "is missing", "a table [body] with mass and inertia");
    }
    root.readTables("connection",
                    [&model](TomlTable& connection) { model.connections.push_back(readConnection(connection)); });
    root.readTable("bracket", [&](TomlTable& bracket) { readBracket(bracket, file, model); });
    root.readTable("load", [&model](TomlTable& load) { readLoad(load, model); });
    root.readTables("sensor", [&model](TomlTable& sensor) { model.sensors.push_back(readSensor(sensor)); });
    readSensorTables(root, model.places);
    root.readTables("drawing", [&](TomlTable& shape) { readShape(shape, file); });  // checked; reports read it
    model.tolerances = readTolerances(root);
    root.rejectUnknownKeys();
}

}  // namespace

MountModel parseMountModel(std::string_view text, const std::string& file) {
    const toml::table parsed = parseToml(text, file);
    TomlPlaces places{file, {}};
    TomlTable root(parsed, "", places);
    MountModel model;
    readRoot(root, file, model);
    try {
        validate(model);
    } catch (const InputError& error) {
        // The checks of ranges know the key; the file and the line come from here.
        const std::string& key = error.location().key;
        throw InputError({file, places.find(key), key}, error.problem(), error.accepted());
    }
    return model;
}

MountModel readMountModel(const std::string& file) {
    return parseMountModel(TextFile(file).view(), file);
}

}  // namespace wems
