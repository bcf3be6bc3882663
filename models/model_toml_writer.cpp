#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

#include "models/axis_numbers.hpp"
#include "models/bracket.hpp"
#include "models/common/atomic_file.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/law_equality.hpp"
#include "models/mount_model.hpp"

namespace wems {
namespace {

/// A TOML float: shortest digits that read back the same, never an integer.
std::string number(double value) {
    std::string text = formatNumber(value);
    if (text.find_first_of(".en") == std::string::npos) text += ".0";
    return text;
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (byte < 0x20 || byte == 0x7f) {
            constexpr const char* digits = "0123456789abcdef";
            result += std::string("\\u00") + digits[byte >> 4U] + digits[byte & 15U];
        } else {
            result += c;
        }
    }
    return result + "\"";
}

std::string vector(const Eigen::Vector3d& v) {
    return "[" + number(v.x()) + ", " + number(v.y()) + ", " + number(v.z()) + "]";
}

/// `mass = 0.01` for each that is given, with what separates them.
std::string formatTolerances(const Tolerances& tolerances, const std::string& separator) {
    std::string text;
    for (std::size_t k = 0; k < kToleranceKeys.size(); ++k) {
        const auto given = tolerances.find(static_cast<ToleranceOf>(k));
        if (given) text += (text.empty() ? "" : separator) + kToleranceKeys[k].key + " = " + number(*given);
    }
    return text;
}

class Writer {
public:
    void line(const std::string& text) { text_ += text + "\n"; }
    void key(const std::string& name, const std::string& value) { line(name + " = " + value); }
    void number(const std::string& name, double value) { key(name, wems::number(value)); }
    /// Only where it differs from what an absent key means.
    void optionalNumber(const std::string& name, double value, double absent = 0) {
        if (value != absent) number(name, value);
    }
    void optionalVector(const std::string& name, const Eigen::Vector3d& value) {
        if (!value.isZero(0)) key(name, vector(value));
    }
    /// Those of one item.
    void tolerances(const Tolerances& given) {
        if (!given.empty()) key("tolerance", "{ " + formatTolerances(given, ", ") + " }");
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
};

void writeBody(const MobileBody& body, Writer& out) {
    out.line("\n[body]");
    out.number("mass", body.mass);
    out.optionalVector("center_of_gravity", body.center_of_gravity);
    const Eigen::Matrix3d& I = body.inertia;
    std::string inertia = "[" + number(I(0, 0)) + ", " + number(I(1, 1)) + ", " + number(I(2, 2));
    if (I(0, 1) != 0 || I(0, 2) != 0 || I(1, 2) != 0) {
        inertia += ", " + number(I(0, 1)) + ", " + number(I(0, 2)) + ", " + number(I(1, 2));
    }
    out.key("inertia", inertia + "]");
    out.optionalVector("spin", body.spin);
    std::string free;
    for (std::size_t i = 0; i < body.free.size(); ++i)
        if (body.free[i]) free += (free.empty() ? "\"" : ", \"") + std::string(kMotionNames[i]) + "\"";
    if (body.free != MobileBody().free) out.key("motion", "[" + free + "]");
    out.tolerances(body.tolerances);
}

bool exertsNothing(const AxisLaw& law) {
    return law == AxisLaw{};
}

std::string formatStop(const Stop& stop) {
    std::string text = std::string("{ side = \"") + (stop.side == Side::positive ? "+" : "-") +
                       "\", clearance = " + number(stop.clearance) + ", stiffness = " + number(stop.stiffness);
    if (stop.dissipation != 0) text += ", dissipation = " + number(stop.dissipation);
    return text + " }";
}

std::string formatBranch(const MaxwellBranch& branch) {
    return "{ stiffness = " + number(branch.stiffness) + ", time_constant = " + number(branch.time_constant) + " }";
}

std::string formatRelaxation(const Relaxation& relaxation) {
    return "{ stiffness_ratio = " + number(relaxation.stiffness_ratio) +
           ", time_constant = " + number(relaxation.time_constant) + " }";
}

std::string formatSlider(const Slider& slider) {
    std::string text =
        "{ force = " + number(slider.force) + ", yield_displacement = " + number(slider.yield_displacement);
    if (slider.gap != 0) text += ", gap = " + number(slider.gap);
    if (slider.negative_force) text += ", negative_force = " + number(*slider.negative_force);
    if (slider.exponent) text += ", exponent = " + number(*slider.exponent);
    return text + " }";
}

std::string formatCurveRow(const CurveRow& row) {
    return "[" + number(row.displacement) + ", " + number(row.force) +
           (row.stiffness ? ", " + number(*row.stiffness) : "") + "]";
}

/// A list of tables, one in each line; nothing if it is empty.
template <class Item>
void writeList(const std::string& key, const std::vector<Item>& items, std::string (*format)(const Item&),
               Writer& out) {
    std::string list;
    const std::string separator = ",\n" + std::string(key.size() + 5, ' ');
    for (const Item& item : items) list += (list.empty() ? "[ " : separator) + format(item);
    if (!list.empty()) out.key(key, list + " ]");
}

void writeAxis(const AxisLaw& law, const Tolerances& tolerances, char axis, Writer& out) {
    out.line(std::string("[connection.") + axis + "]");
    for (const AxisNumber& number : kAxisNumbers) {
        if (number.presence == AxisNumber::Presence::required || law.*number.member != 0)
            out.number(number.key, law.*number.member);
    }
    if (law.relaxation) {
        out.key("relaxation", formatRelaxation(*law.relaxation));
    }
    if (law.friction) {
        std::string friction = "{ force = " + number(law.friction->force) +
                               ", transition_velocity = " + number(law.friction->transition_velocity);
        if (law.friction->presliding_stiffness) {
            friction += ", presliding_stiffness = " + number(*law.friction->presliding_stiffness);
        }
        out.key("friction", friction + " }");
    }
    if (law.hysteresis) {
        out.key("hysteresis", "{ force = " + number(law.hysteresis->force) +
                                  ", yield_displacement = " + number(law.hysteresis->yield_displacement) +
                                  ", exponent = " + number(law.hysteresis->exponent) +
                                  ", shape = " + number(law.hysteresis->shape) + " }");
    }
    writeList("branches", law.branches, formatBranch, out);
    writeList("spectrum", law.spectrum, formatRelaxation, out);
    writeList("sliders", law.sliders, formatSlider, out);
    writeList("curve", law.curve, formatCurveRow, out);
    writeList("stops", law.stops, formatStop, out);
    out.tolerances(tolerances);
}

void writeConnection(const Connection& connection, Writer& out) {
    out.line("\n[[connection]]");
    out.key("name", quoted(connection.name));
    out.key("position", vector(connection.position));
    out.tolerances(connection.tolerances);
    bool any = false;
    for (std::size_t k = 0; k < 3; ++k) {
        // An axis without a table exerts nothing; a connection needs one table all the same.
        const bool last_chance = k == 2 && !any;
        const Tolerances& tolerances = connection.axis_tolerances[k];
        if (exertsNothing(connection.axis[k]) && tolerances.empty() && !last_chance) continue;
        writeAxis(connection.axis[k], tolerances, "xyz"[k], out);
        any = true;
    }
}

void writeBracket(const MountModel& model, const std::string& bracket_file, Writer& out) {
    out.line("\n[bracket]");
    out.key("modes", quoted(bracket_file));
    const auto writeMode = [&](std::size_t row, bool replaced) {
        const BracketMode& mode = model.bracket.at(row);
        out.line("[[bracket.mode]]");
        out.key("index", std::to_string(row + 1));
        if (replaced) {
            out.number("frequency", mode.frequency);
            out.number("damping_ratio", mode.damping_ratio);
        }
        out.tolerances(mode.tolerances);
    };
    const std::vector<int>& replaced = model.replaced_modes;
    for (const int index : replaced) writeMode(index - 1, true);
    for (std::size_t j = 0; j < model.bracket.size(); ++j) {
        const bool written = std::find(replaced.begin(), replaced.end(), static_cast<int>(j + 1)) != replaced.end();
        if (!written && !model.bracket[j].tolerances.empty()) writeMode(j, false);
    }
}

void writeLoadPoint(const LoadPoint& point, Writer& out) {
    out.key("part", point.part == Part::mobile ? "\"mobile\"" : "\"fixed\"");
    out.key("position", vector(point.position));
}

void writeLoad(const LoadCorrection& load, Writer& out) {
    const auto& rows = load.gain_over_frequency;
    if (load.axis_gain != Eigen::Vector3d::Ones()) out.key("axis_gain", vector(load.axis_gain));
    if (rows.size() == 1 && rows[0].first == 0) {
        out.number("gain", rows[0].second);
        return;
    }
    std::string table;
    for (const auto& [frequency, gain] : rows) {
        table += (table.empty() ? "[" : ", ") + ("[" + number(frequency) + ", " + number(gain) + "]");
    }
    out.key("gain_over_frequency", table + "]");
}

void writePlace(const SensorPlace& place, Writer& out) {
    out.line(place.accelerometer ? "\n[[accelerometer]]" : "\n[[marker]]");
    out.key("name", quoted(place.name));
    out.key("part", place.part == Part::mobile ? "\"mobile\"" : "\"fixed\"");
    out.key("position", vector(place.position));
    out.optionalVector("rotation", place.rotation);
    out.optionalNumber("noise", place.noise);
    std::string channels;
    for (std::size_t k = 0; k < 3; ++k) {
        if (place.columns.at(k).empty()) continue;
        channels += (channels.empty() ? "" : ", ") + std::string(1, "xyz"[k]) + " = " + quoted(place.columns.at(k));
    }
    if (!channels.empty()) out.key("channels", "{ " + channels + " }");
}

/// What a model's modes have that those of its modes file do not.
struct ModeChanges {
    std::vector<int> numbers;  ///< rows, from 1, of another frequency or damping ratio
    bool shapes = false;       ///< other shapes or more rows, which a model file has no keys for
};
ModeChanges findModeChanges(const MountModel& model) {
    ModeChanges changes;
    if (model.bracket_path.empty() || !std::filesystem::exists(model.bracket_path)) return changes;
    const std::vector<BracketMode> rows = readBracketModes(model.bracket_path);
    changes.shapes = rows.size() != model.bracket.size();
    for (std::size_t j = 0; j < std::min(rows.size(), model.bracket.size()); ++j) {
        const BracketMode &own = model.bracket[j], &row = rows[j];
        if (own.frequency != row.frequency || own.damping_ratio != row.damping_ratio)
            changes.numbers.push_back(static_cast<int>(j + 1));
        if (own.translation != row.translation || own.rotation != row.rotation ||
            own.load_translation != row.load_translation || own.base_participation != row.base_participation)
            changes.shapes = true;
    }
    return changes;
}

/// Writes all modes to a file beside `file` and returns its name; never the file that the model was read from.
std::string writeOwnModes(const MountModel& model, const std::filesystem::path& file, OutputFiles& outputs) {
    const std::string stem = file.stem().string();
    std::error_code missing;
    std::filesystem::path own = file.parent_path() / (stem + "_bracket.csv");
    if (std::filesystem::equivalent(own, model.bracket_path, missing))
        own = file.parent_path() / (stem + "_bracket_extended.csv");
    outputs.add(own.string(), formatBracketModes(model.bracket));
    return own.filename().string();
}

}  // namespace

std::string formatMountModel(const MountModel& model, const std::string& bracket_file) {
    Writer out;
    out.key("name", quoted(model.name));
    out.optionalVector("gravity", model.gravity);
    writeBody(model.body, out);
    for (const Connection& connection : model.connections) writeConnection(connection, out);
    if (!model.bracket.empty()) writeBracket(model, bracket_file, out);
    if (model.load || model.load_point) out.line("\n[load]");
    if (model.load) writeLoad(*model.load, out);
    if (model.load_point) writeLoadPoint(*model.load_point, out);
    for (const SensorFault& sensor : model.sensors) {
        out.line("\n[[sensor]]");
        out.key("channel", quoted(sensor.channel));
        out.optionalNumber("gain", sensor.gain, 1);
        out.optionalNumber("delay", sensor.delay);
        out.optionalVector("rotation", sensor.rotation);
        out.optionalNumber("zero", sensor.zero);
        out.tolerances(sensor.tolerances);
    }
    for (const SensorPlace& place : model.places) writePlace(place, out);
    if (!model.tolerances.empty()) out.line("\n[tolerance]\n" + formatTolerances(model.tolerances, "\n"));
    return out.text();
}

void writeMountModel(const MountModel& model, const std::string& file, OutputFiles& outputs) {
    namespace fs = std::filesystem;
    validate(model);
    std::string bracket_file = model.bracket_file;
    if (!model.bracket.empty() && bracket_file.empty()) {
        throw InputError({file, 0, "bracket.modes"},
                         "the model's bracket modes are in no file that could be named here");
    }
    if (!model.bracket_path.empty()) {
        std::error_code failed;
        const fs::path folder = fs::weakly_canonical(fs::absolute(file).parent_path(), failed);
        const fs::path modes = fs::weakly_canonical(fs::absolute(model.bracket_path), failed);
        if (!failed) bracket_file = modes.lexically_proximate(folder).generic_string();
    }
    const ModeChanges changes = findModeChanges(model);
    MountModel written = model;
    for (const int index : changes.numbers)
        if (std::find(written.replaced_modes.begin(), written.replaced_modes.end(), index) ==
            written.replaced_modes.end())
            written.replaced_modes.push_back(index);
    // The modes first: no model is left that names a file that is not there.
    if (changes.shapes) bracket_file = writeOwnModes(model, file, outputs);
    outputs.add(file, formatMountModel(written, bracket_file));
}

void writeMountModel(const MountModel& model, const std::string& file) {
    OutputFiles outputs;
    writeMountModel(model, file, outputs);
    outputs.commit();
}

}  // namespace wems
