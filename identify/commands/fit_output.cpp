#include "identify/commands/fit_output.hpp"

#include <algorithm>
#include <cmath>

#include "identify/commands/device_scene.hpp"
#include "identify/commands/format.hpp"
#include "identify/commands/restoring_forces.hpp"
#include "identify/commands/run_pictures.hpp"
#include "identify/fit/law_verdict.hpp"
#include "identify/motion/swept_frequency.hpp"
#include "identify/problem/slow_motion.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

nlohmann::json makeFitJson(const FitResult& fit, const std::vector<std::string>& notes, const Timing& timing) {
    auto parameters = nlohmann::json::array(), unknown = nlohmann::json::array();
    for (const auto& p : fit.parameters)
        parameters.push_back({{"name", p.name},
                              {"value", p.value},
                              {"unit", p.unit},
                              {"interval95", p.interval95},
                              {"standard_error", p.standard_error},
                              {"model_value", p.model_value}});
    for (const auto& group : fit.not_identifiable) {
        nlohmann::json entry = {{"names", group.names},
                                {"known_combination", group.combination},
                                {"unit", group.unit},
                                {"separate_by", group.separate_by}};
        if (!group.combination.empty()) {
            entry["value"] = group.value;
            entry["interval95"] = group.interval95;
        }
        if (!group.reason.empty()) entry["reason"] = group.reason;
        unknown.push_back(std::move(entry));
    }
    nlohmann::json result = {
        {"parameters", parameters},
        {"not_identifiable", unknown},
        {"method", fit.by_simulation ? "simulation" : "motion"},
        {"residual", {{"fraction", fit.residual_fraction}, {"over_noise", numberOrNull(fit.residual_over_noise)}}},
        {"verdict", formatLawVerdict(judgeLaw(fit.residual_fraction, fit.residual_over_noise))},
        {"notes", notes}};
    for (const auto& [step, seconds] : timing) result["timing"][step] = seconds;
    return result;
}

Table makeParameterTable(const FitResult& fit) {
    Table table({"parameter", "model", "identified", "95 % from", "to", "unit"});
    for (const auto& p : fit.parameters)
        table.addRow({p.name, formatNumber(p.model_value), formatNumber(p.value, 6), formatNumber(p.interval95[0], 6),
                      formatNumber(p.interval95[1], 6), p.unit});
    return table;
}

Table makeOpenTable(const FitResult& fit) {
    Table table(
        {"not identifiable one by one", "what is known", "value", "95 % from", "to", "unit", "would be told by"});
    for (const auto& group : fit.not_identifiable) {
        const bool known = !group.combination.empty();
        table.addRow({joinWords(group.names),
                      known                  ? group.combination
                      : group.reason.empty() ? "nothing"
                                             : group.reason,
                      known ? formatNumber(group.value, 6) : "-", known ? formatNumber(group.interval95[0], 6) : "-",
                      known ? formatNumber(group.interval95[1], 6) : "-", known ? group.unit : "", group.separate_by});
    }
    return table;
}

std::string describeResidual(const FitResult& fit) {
    return "unexplained: " + formatNumber(100 * fit.residual_fraction, 3) +
           (fit.by_simulation ? " % of the measured relative displacement, by free simulation; "
                              : " % of the wrench that the motion demands; ") +
           describeLawVerdict(judgeLaw(fit.residual_fraction, fit.residual_over_noise));
}

void addFittedModel(const MountModel& fitted, const std::string& file, OutputFiles& outputs) {
    try {
        writeMountModel(fitted, file, outputs);
    } catch (const InputError& error) {
        if (!error.location().file.empty()) throw;
        throw InputError({file, 0, error.location().key},
                         "the fitted value makes no model that could be read again: it " + error.problem(),
                         error.accepted());
    }
}

namespace {

constexpr std::size_t kMostDirections = 15;  // in the table, the weakest

void addDirections(HtmlReport& page, const std::vector<ParameterDirection>& directions) {
    if (directions.empty()) return;
    page.addHeading("How well the equations determine the parameters");
    page.addText(
        "Singular values of the weighted equations, each parameter in units of its own size: by how many standard "
        "deviations of what is left the equations change, all of them together, when the parameters change by their "
        "whole size along a direction. A direction is known if its standard error, errors of gains and positions "
        "included, is below 10 % (dashpots 20 %).");
    Plot plot{"Singular values", "number [-]", "standard deviations [-]", {}, true, true};
    for (const bool known : {true, false}) {
        Series series{known ? "known" : "not known", {}, {}, true, known ? 0 : 1};
        for (std::size_t d = 0; d < directions.size(); ++d) {
            if (directions[d].known != known) continue;
            series.x.push_back(static_cast<double>(d + 1));
            series.y.push_back(directions[d].singular_value);
        }
        if (!series.x.empty()) plot.series.push_back(std::move(series));
    }
    page.addPlot(plot);
    const std::size_t first = directions.size() - std::min(directions.size(), kMostDirections);
    if (first > 0)
        page.addText("The " + std::to_string(directions.size() - first) + " smallest of " +
                     std::to_string(directions.size()) + ":");
    std::vector<std::vector<std::string>> rows;
    for (std::size_t d = first; d < directions.size(); ++d)
        rows.push_back({std::to_string(d + 1), formatNumber(directions[d].singular_value, 3),
                        formatPercent(directions[d].relative_error), directions[d].known ? "known" : "not known",
                        directions[d].text});
    page.addTable({"number", "singular value", "standard error", "", "direction, parameters in units of their size"},
                  rows);
}

/// The mobile part's acceleration as channels, which tell the excited band of a run that is not kept whole.
Recording recordAcceleration(const RunMotion& run) {
    Recording recording;
    recording.file = run.file;
    recording.time = run.time;
    for (int a = 0; a < 3; ++a) {
        Channel channel;
        channel.name = std::string("base.a") + "xyz"[a];
        channel.values.assign(run.mobile.a.cols(), 0.0);
        for (std::size_t k = 0; k < channel.values.size(); ++k) channel.values[k] = run.mobile.a(a, k);
        recording.channels.push_back(std::move(channel));
    }
    return recording;
}

/// The first runs, their slow motion as the fitted model has it.
void addCurves(HtmlReport& page, const ReportedFit& reported) {
    std::vector<RunMotion> motions;
    std::vector<MovedRun> moved;
    motions.reserve(kMostDrawn);
    for (std::size_t r = 0; r < std::min(kMostDrawn, reported.runs.size()); ++r) {
        motions.push_back(reported.runs[r]);
        restoreSlowMotion(motions.back(), reported.fit.model);
        moved.push_back(
            {&motions.back(), findSweptFrequency(reported.recordings.empty() ? recordAcceleration(reported.runs[r])
                                                                             : reported.recordings[r])});
    }
    addRestoringForces(page, moved, reported.start, reported.fit.model, "as fitted", std::nullopt);
}

/// Measured and simulated displacement of the axis that moves most, and what is between them.
void addTrajectory(HtmlReport& page, const FittedTrajectory& trajectory) {
    Eigen::Index most = 0;
    trajectory.measured.rowwise().squaredNorm().maxCoeff(&most);
    page.addHeading("Free simulation: " + trajectory.file);
    Plot plot{"Relative displacement at " + trajectory.names[most], "time [s]", "displacement [mm]", {}, false};
    const auto add = [&](const char* name, const Eigen::VectorXd& metres) {
        const Eigen::VectorXd values = 1e3 * metres;
        plot.series.push_back({name, trajectory.time, {values.begin(), values.end()}});
    };
    add("measured", trajectory.measured.row(most));
    add("simulated", trajectory.simulated.row(most));
    add("simulated - measured", trajectory.simulated.row(most) - trajectory.measured.row(most));
    page.addPlot(plot);
}

void addDisplacementPlots(HtmlReport& page, const std::vector<RunMotion>& runs) {
    for (std::size_t r = 0; r < std::min(kMostDrawn, runs.size()); ++r) {
        const RunMotion& run = runs[r];
        page.addHeading("Motion of the mobile part: " + run.file);
        Plot translation{"Translation of the mobile frame's origin", "time [s]", "displacement [mm]", {}, false};
        Plot rotation{"Rotation of the mobile part", "time [s]", "rotation [mrad]", {}, false};
        for (int axis = 0; axis < 3; ++axis) {
            const std::string name(1, "xyz"[axis]);
            const Eigen::VectorXd p = 1e3 * run.mobile.p.row(axis).transpose(),
                                  angle = 1e3 * run.mobile.theta.row(axis).transpose();
            translation.series.push_back({name, run.time, {p.begin(), p.end()}});
            rotation.series.push_back({name, run.time, {angle.begin(), angle.end()}});
        }
        page.addPlot(translation);
        page.addPlot(rotation);
    }
}

}  // namespace

void writeFitReport(const ReportedFit& reported, const std::string& file, OutputFiles& outputs) {
    const FitResult& fit = reported.fit;
    HtmlReport page("Identified mount: " + fit.model.name);
    page.addLead(describeResidual(fit));
    const Table parameters = makeParameterTable(fit), open = makeOpenTable(fit);
    page.addTable(parameters.header(), parameters.rows());
    if (!open.rows().empty()) {
        page.addHeading("What these data cannot tell");
        page.addTable(open.header(), open.rows());
    }
    addDirections(page, fit.directions);
    if (reported.runs.size() > kMostDrawn)
        page.addText("Of " + std::to_string(reported.runs.size()) + " runs the first " + std::to_string(kMostDrawn) +
                     " are drawn below.");
    addCurves(page, reported);
    for (std::size_t r = 0; r < std::min(kMostDrawn, fit.remainders.size()); ++r)
        addRemainder(page, fit.remainders[r], reported.runs[r].file);
    for (std::size_t r = 0; r < std::min(kMostDrawn, fit.trajectories.size()); ++r)
        addTrajectory(page, fit.trajectories[r]);
    if (!reported.recordings.empty()) addMotion(page, makeDeviceScene(reported.runs, reported.recordings, fit.model));
    addDisplacementPlots(page, reported.runs);
    if (!reported.notes.empty()) page.addHeading("How the motion was obtained");
    page.addList(reported.notes);
    page.write(file, outputs);
}

}  // namespace wems::identify::commands
