// Text, JSON and CSV of a linear analysis.
#include <cmath>

#include "models/common/format_number.hpp"
#include "models/common/text_table.hpp"
#include "models/common/units.hpp"
#include "models/report/html_report.hpp"
#include "models/report/motion_scene.hpp"
#include "plugin/linear_analysis.hpp"

namespace wems::plugin {

namespace {

constexpr double kNoShare = 1e-9;  // of the largest: rounding

nlohmann::json makeAxes(const Eigen::Vector3d& v) {
    return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

nlohmann::json listParts(const Eigen::Ref<const Eigen::VectorXcd>& values) {
    auto real = nlohmann::json::array(), imaginary = nlohmann::json::array();
    for (const auto& value : values) {
        real.push_back(value.real());
        imaginary.push_back(value.imag());
    }
    return {{"real", real}, {"imaginary", imaginary}};
}

nlohmann::json makeStaticJson(const LinearAnalysis& analysis) {
    const StaticSag& sag = analysis.sag;
    auto connections = nlohmann::json::array(), stops = nlohmann::json::array();
    for (Eigen::Index i = 0; i < sag.relative.cols(); ++i)
        connections.push_back({{"name", analysis.model.connections[i].name},
                               {"displacement", makeAxes(sag.relative.col(i))},
                               {"force", makeAxes(sag.force.col(i))}});
    for (const StopMargin& stop : sag.stops)
        stops.push_back({{"name", nameStop(analysis.model, stop)}, {"clearance", stop.clearance}, {"left", stop.left}});
    return {{"displacement", makeAxes(sag.displacement)},
            {"rotation", makeAxes(sag.rotation)},
            {"connections", connections},
            {"stops", stops}};
}

nlohmann::json makeModeJson(const LinearAnalysis& analysis, const DampedMode& mode) {
    auto shape = nlohmann::json::array();
    for (std::size_t i = 0; i < analysis.system.ends.size(); ++i)
        shape.push_back({{"connection", analysis.model.connections[i].name},
                         {"mobile", listParts(analysis.system.mobile_ends[i] * mode.shape)},
                         {"fixed", listParts(analysis.system.fixed_ends[i] * mode.shape)}});
    return {{"frequency", mode.frequency},
            {"damping_ratio", mode.damping_ratio},
            {"damped_frequency", mode.damped_frequency},
            {"undamped_frequency", mode.undamped_frequency},
            {"effective_mass", makeAxes(mode.effective_mass)},
            {"moves", describeShape(analysis, mode)},
            {"shape", shape}};
}

std::string formatMass(double mass, double largest) {
    return std::abs(mass) < kNoShare * largest ? "0" : formatNumber(mass, 3);
}

std::string formatStatic(const LinearAnalysis& analysis, TextStyle style) {
    const StaticSag& sag = analysis.sag;
    std::string text;
    if (analysis.model.gravity.isZero()) {
        text = "no gravity: the rest position is the unloaded one\n";
    } else {
        const Eigen::Vector3d mm = 1e3 * sag.displacement;
        text = "static sag of the centre of gravity: x " + formatNumber(mm.x(), 4) + ", y " + formatNumber(mm.y(), 4) +
               ", z " + formatNumber(mm.z(), 4) + " mm\n";
    }
    Table table({"stop", "clearance [mm]", "left at rest [mm]"});
    for (const StopMargin& stop : sag.stops)
        table.addRow(
            {nameStop(analysis.model, stop), formatNumber(1e3 * stop.clearance, 4), formatNumber(1e3 * stop.left, 4)});
    return table.empty() ? text : text + table.format(style);
}

std::string formatRandom(const LinearAnalysis& analysis, TextStyle style) {
    const RandomResponse& random = *analysis.random;
    const std::vector<OutputName> names = nameOutputs(analysis.model);
    constexpr double g = 9.80665;
    Table table({"random response", "RMS", "3 x RMS", "unit", "rate [Hz]"});
    for (std::size_t i = 0; i < names.size(); ++i) {
        const double rms = random.rms[i];
        // Across the input there is often nothing.
        Eigen::Index group = i - i % 3;
        if (rms <= 1e-6 * random.rms.segment<3>(group).maxCoeff()) continue;
        const bool length = names[i].unit == "m", acceleration = names[i].unit == "m/s^2";
        const double factor = length ? 1e3 : acceleration ? 1 / g : 1;
        table.addRow({names[i].name, formatNumber(factor * rms, 4), formatNumber(3 * factor * rms, 4),
                      length         ? "mm"
                      : acceleration ? "g"
                                     : "N",
                      formatNumber(random.rate[i], 4)});
    }
    std::string text = "\n" + analysis.random_input + "\n" + table.format(style);
    Table stops({"stop", "left at rest [mm]", "in RMS"});
    bool close = false;
    for (const StopMargin& stop : analysis.sag.stops) {
        const double rms = random.rms[kOutputsPerConnection * stop.connection + stop.axis];
        if (!(rms > 0)) continue;
        close = close || stop.left < 3 * rms;
        stops.addRow(
            {nameStop(analysis.model, stop), formatNumber(1e3 * stop.left, 4), formatNumber(stop.left / rms, 3)});
    }
    if (!stops.empty()) text += "\n" + stops.format(style);
    if (close)
        text +=
            "note: a stop lies within 3 RMS: it is touched, which the linear model does not know; --psd without "
            "--modes simulates it\n";
    return text;
}

}  // namespace

std::string formatAnalysis(const LinearAnalysis& analysis, TextStyle style) {
    double largest = 0;
    for (const DampedMode& mode : analysis.modes) largest = std::max(largest, mode.effective_mass.maxCoeff());
    Table table({"mode", "frequency [Hz]", "damping [%]", "rings at [Hz]", "mass x [kg]", "y", "z", "moves most"});
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
        const DampedMode& mode = analysis.modes[i];
        sum += mode.effective_mass;
        std::vector<std::string> row{std::to_string(i + 1), formatNumber(mode.frequency, 5),
                                     formatNumber(100 * mode.damping_ratio, 4),
                                     mode.damped_frequency > 0 ? formatNumber(mode.damped_frequency, 5) : "-"};
        for (const double mass : mode.effective_mass) row.push_back(formatMass(mass, largest));
        row.push_back(describeShape(analysis, mode));
        table.addRow(row);
    }
    std::vector<std::string> row{"all", "", "", ""};
    for (const double mass : sum) row.push_back(formatMass(mass, largest));
    row.emplace_back();
    table.addRow(row);
    std::string text = table.format(style) + "\n" + formatStatic(analysis, style);
    if (analysis.random) text += formatRandom(analysis, style);
    return text;
}

nlohmann::json makeAnalysisJson(const LinearAnalysis& analysis) {
    auto modes = nlohmann::json::array();
    for (const DampedMode& mode : analysis.modes) modes.push_back(makeModeJson(analysis, mode));
    nlohmann::json result = {{"modes", modes},
                             {"static", makeStaticJson(analysis)},
                             {"units",
                              {{"frequency", "Hz"},
                               {"effective_mass", "kg"},
                               {"displacement", "m"},
                               {"rotation", "rad"},
                               {"force", "N"},
                               {"clearance", "m"}}}};
    const std::vector<OutputName> names = nameOutputs(analysis.model);
    if (analysis.transfer) {
        const TransferFunctions& transfer = *analysis.transfer;
        auto outputs = nlohmann::json::array();
        for (std::size_t i = 0; i < names.size(); ++i) {
            nlohmann::json entry = listParts(transfer.response.row(i).transpose());
            entry["name"] = names[i].name;
            entry["unit"] = "(" + names[i].unit + ")/(" + transfer.input_unit + ")";
            outputs.push_back(entry);
        }
        result["transfer"] = {{"input", transfer.input}, {"frequency", transfer.frequency}, {"outputs", outputs}};
    }
    if (analysis.random) {
        const RandomResponse& random = *analysis.random;
        auto outputs = nlohmann::json::array();
        for (std::size_t i = 0; i < names.size(); ++i) {
            const Eigen::Index row = i;
            const Eigen::VectorXd density = random.density.row(row).transpose();
            outputs.push_back({{"name", names[i].name},
                               {"unit", names[i].unit},
                               {"rms", random.rms[row]},
                               {"rate", random.rate[row]},
                               {"density", std::vector<double>(density.begin(), density.end())}});
        }
        result["random"] = {{"input", analysis.random_input}, {"frequency", random.frequency}, {"outputs", outputs}};
    }
    return result;
}

std::string formatAnalysisCsv(const LinearAnalysis& analysis) {
    const std::vector<OutputName> names = nameOutputs(analysis.model);
    const bool transfer = analysis.transfer.has_value();
    std::string text = "# model: " + analysis.model.name +
                       "\n# input: " + (transfer ? analysis.transfer->input : analysis.random_input) +
                       "\nfrequency [Hz]";
    for (const OutputName& name : names) {
        if (transfer) {
            const std::string unit = " [(" + name.unit + ")/(" + analysis.transfer->input_unit + ")]";
            text += "," + name.name + ".real" + unit + "," + name.name + ".imaginary" + unit;
        } else {
            text += "," + name.name + " [(" + name.unit + ")^2/Hz]";
        }
    }
    text += "\n";
    const std::vector<double>& frequency = transfer ? analysis.transfer->frequency : analysis.random->frequency;
    for (std::size_t k = 0; k < frequency.size(); ++k) {
        const Eigen::Index column = k;
        text += formatNumber(frequency[k]);
        for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(names.size()); ++i) {
            if (transfer) {
                const std::complex<double> value = analysis.transfer->response(i, column);
                text += "," + formatNumber(value.real()) + "," + formatNumber(value.imag());
            } else {
                text += "," + formatNumber(analysis.random->density(i, column));
            }
        }
        text += "\n";
    }
    return text;
}

// The report of a linear analysis.

namespace {

constexpr Eigen::Index kFrames = 48;  // of one period

/// So large that the stop that a mode reaches first is just touched; 1 mm without stops.
double findAmplitude(const LinearAnalysis& analysis, const DampedMode& mode) {
    double amplitude = 1e300;
    for (const StopMargin& stop : analysis.sag.stops) {
        const double share = std::abs((analysis.system.ends[stop.connection].row(stop.axis) * mode.shape).value());
        if (share > 1e-3 && stop.left > 0) amplitude = std::min(amplitude, stop.left / share);
    }
    return amplitude < 1e300 ? amplitude : 1e-3;
}

SceneRun makeModeRun(const LinearAnalysis& analysis, std::size_t number) {
    const DampedMode& mode = analysis.modes[number];
    SceneRun run;
    run.name = "mode " + std::to_string(number + 1) + ", " + formatNumber(mode.frequency, 4) + " Hz";
    run.stations = {{mode.frequency, 0, 1 / (mode.frequency * kFrames), 0, kFrames}};
    run.mobile.resize(6, kFrames);
    run.fixed = Eigen::MatrixXd::Zero(6, kFrames);
    const Eigen::Index connections = analysis.model.connections.size();
    run.force = Eigen::MatrixXd::Zero(3 * connections, kFrames);
    run.closed = Eigen::MatrixXi::Zero(analysis.sag.stops.size(), kFrames);
    const double amplitude = findAmplitude(analysis, mode);
    for (Eigen::Index frame = 0; frame < kFrames; ++frame) {
        const double angle = kTwoPi * static_cast<double>(frame) / kFrames;
        const Eigen::VectorXd x = amplitude * (mode.shape * std::polar(1.0, angle)).real();
        run.mobile.col(frame) = analysis.system.mobile_frame * x;
        run.fixed.col(frame) = analysis.system.fixed_frame * x;
    }
    return run;
}

/// One picture for each group of three outputs of all connections along one axis.
template <class Value>
std::vector<Plot> plotOutputs(const LinearAnalysis& analysis, const std::vector<double>& frequency,
                              const std::string& what, const std::string& per, const Value& value) {
    struct Group {
        const char* title;
        const char* unit;
        double factor;
        Eigen::Index row;
    };
    const Group groups[] = {{"relative displacement", "mm", 1e3, 0},
                            {"connection force", "N", 1, 3},
                            {"acceleration of the mobile part", "m/s^2", 1, 6},
                            {"acceleration of the fixed part", "m/s^2", 1, 9}};
    std::vector<Plot> plots;
    for (const Group& group : groups)
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            Plot plot;
            plot.title = what + ", " + group.title + " " + "xyz"[axis];
            plot.x_label = "frequency [Hz]";
            plot.y_label =
                std::string("[") + (per == "^2/Hz" ? "(" + std::string(group.unit) + ")" : group.unit) + per + "]";
            plot.log_y = true;
            double largest = 0;
            for (std::size_t i = 0; i < analysis.model.connections.size(); ++i) {
                Series series{analysis.model.connections[i].name, frequency, {}};
                const Eigen::Index row = kOutputsPerConnection * static_cast<Eigen::Index>(i) + group.row + axis;
                for (std::size_t k = 0; k < frequency.size(); ++k) {
                    series.y.push_back(value(row, k, group.factor));
                    largest = std::max(largest, series.y.back());
                }
                plot.series.push_back(std::move(series));
            }
            constexpr double nothing = 1e-12;  // where symmetry leaves rounding alone
            if (largest > nothing) plots.push_back(std::move(plot));
        }
    return plots;
}

}  // namespace

void writeAnalysisReport(const LinearAnalysis& analysis, const std::vector<DrawnShape>& drawing,
                         const std::string& file, OutputFiles& outputs) {
    HtmlReport page("Linear model of " + analysis.model.name);
    const DampedMode* first = nullptr;
    for (const DampedMode& mode : analysis.modes)
        if (first == nullptr && mode.frequency > 0) first = &mode;
    if (first != nullptr)
        page.addLead("The lowest mode lies at " + formatNumber(first->frequency, 4) + " Hz with " +
                     formatNumber(100 * first->damping_ratio, 3) + " % damping.");
    page.addText(
        "Small motions about the rest position under gravity: stops that are not touched there do not act. Effective "
        "mass: "
        "the part of the mass that a motion of the base along an axis sets moving in this mode.");
    Table modes({"mode", "frequency [Hz]", "damping [%]", "rings at [Hz]", "mass x [kg]", "mass y [kg]", "mass z [kg]",
                 "moves most"});
    for (std::size_t i = 0; i < analysis.modes.size(); ++i) {
        const DampedMode& mode = analysis.modes[i];
        std::vector<std::string> row{std::to_string(i + 1), formatNumber(mode.frequency, 5),
                                     formatNumber(100 * mode.damping_ratio, 4),
                                     mode.damped_frequency > 0 ? formatNumber(mode.damped_frequency, 5) : "-"};
        for (const double mass : mode.effective_mass) row.push_back(mass < 1e-6 ? "0" : formatNumber(mass, 3));
        row.push_back(describeShape(analysis, mode));
        modes.addRow(row);
    }
    page.addTable(modes.header(), modes.rows());
    page.addHeading("Rest position");
    if (analysis.model.gravity.isZero()) page.addText("Without gravity: the unloaded position.");
    Table stops({"stop", "clearance [mm]", "left at rest [mm]"});
    for (const StopMargin& stop : analysis.sag.stops)
        stops.addRow(
            {nameStop(analysis.model, stop), formatNumber(1e3 * stop.clearance, 4), formatNumber(1e3 * stop.left, 4)});
    if (!stops.empty()) page.addTable(stops.header(), stops.rows());

    MotionScene scene;
    scene.title = "Mode shapes";
    scene.model = analysis.model;
    scene.drawing = drawing;
    for (std::size_t i = 0; i < analysis.modes.size(); ++i)
        if (analysis.modes[i].frequency > 0) scene.runs.push_back(makeModeRun(analysis, i));
    page.addHeading("Mode shapes");
    page.addText("Each mode as large as just touches a stop, exaggerated about the rest position.");
    if (!scene.runs.empty()) page.addScene(scene);
    if (analysis.transfer) {
        page.addHeading("Transfer functions");
        const TransferFunctions& transfer = *analysis.transfer;
        page.addText("For each " + transfer.input_unit + " of " + transfer.input + ", relative to rest.");
        for (const Plot& plot :
             plotOutputs(analysis, transfer.frequency, "Amplitude for each " + transfer.input_unit,
                         "/(" + transfer.input_unit + ")", [&](Eigen::Index row, Eigen::Index k, double factor) {
                             return factor * std::abs(transfer.response(row, k));
                         }))
            page.addPlot(plot);
    }
    if (analysis.random) {
        page.addHeading("Random response");
        page.addText(analysis.random_input);
        const RandomResponse& random = *analysis.random;
        for (const Plot& plot : plotOutputs(analysis, random.frequency, "Density", "^2/Hz",
                                            [&](Eigen::Index row, Eigen::Index k, double factor) {
                                                return factor * factor * random.density(row, k);
                                            }))
            page.addPlot(plot);
    }
    page.write(file, outputs);
}

}  // namespace wems::plugin
