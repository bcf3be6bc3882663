// The next test, which run would tell what the recordings leave open.
#include "identify/commands/plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identify/commands/recordings.hpp"
#include "identify/component/component_data.hpp"
#include "identify/motion/parallel.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/mount_model.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

namespace {

std::vector<Recording> readRuns(const PlanRequest& request, const MountModel& model, const ColumnMap* map) {
    const std::vector<RecordingSource>& sources = request.runs.recordings;
    const auto size = estimateSize(sources, map);
    if (size && !size->component && exceedsMemory(*size, model, request.plan.fit, request.memory))
        throw InputError({sources.front().file, 0, "time"}, "the recordings need more than the memory of --memory",
                         "more memory, or the part of the recordings that identify convert cuts out");
    std::vector<Recording> recordings = readDeviceRecordings(sources, request.runs.columns, model);
    for (const Recording& recording : recordings)
        if (isComponentTest(recording))
            throw InputError({recording.file, 0, ""}, "a component test, which has no direction to choose",
                             "recordings of a whole device");
    checkFitStart(model, request.runs.model.file);
    checkSampleRate(recordings, model);
    for (Recording& recording : recordings) keepOnly(request.use, recording);
    return recordings;
}

nlohmann::json describeOptions(const PlanRequest& request) {
    const AskedSetup& asked = request.plan.asked;
    nlohmann::json options = {{"proposals", request.plan.most_proposals},
                              {"free", request.plan.fit.free_body},
                              {"use", request.use},
                              {"memory_MB", request.memory.megabytes}};
    const auto add = [&](const char* key, const std::optional<double>& value) {
        if (value) options[key] = *value;
    };
    add("max_force", asked.force);
    add("max_acceleration", asked.acceleration);
    add("max_displacement", asked.displacement);
    add("max_stroke", asked.stroke);
    add("rate", asked.octaves_per_minute);
    if (asked.band) options["sweep"] = {asked.band->first, asked.band->second};
    return options;
}

}  // namespace

PlanAnswer runPlan(PlanRequest request, Watcher& watcher) {
    PlanAnswer answer;
    answer.record = beginRecord("plan");
    resolveRuns(request.runs);
    answer.start = readDeviceModel(request.runs.model, request.runs.geometry);
    answer.model_file = request.model_file.empty() ? request.runs.model.file : request.model_file;
    addInputs(answer.record, request.runs, answer.start);
    answer.record.options = describeOptions(request);
    watcher.onInputs(listFiles(answer.record));
    const std::optional<ColumnMap> map = readDeviceMap(request.runs.columns, answer.start);
    if (map) answer.record.addColumns(*map);
    watcher.onStep({"reading"});
    const std::vector<Recording> recordings = readRuns(request, answer.start, map ? &*map : nullptr);
    watcher.onStep({"motion of both parts"});
    std::vector<RunMotion> runs(recordings.size());
    runParallel(runs.size(), [&](std::size_t r) { runs[r] = estimateMotion(recordings[r], answer.start); });
    constexpr double before = 0.1;  // of the time, for what comes before the rehearsals
    request.plan.progress = [&](const ProgressEvent& step) {
        watcher.onStep({step.what, before + (1 - before) * step.from});
    };
    answer.plan = makePlan(runs, recordings, answer.start, request.plan);
    for (const Recording& recording : recordings)
        for (const auto& warning : recording.warnings) answer.plan.notes.push_back(recording.file + ": " + warning);
    answer.fitted = answer.plan.now.model;
    const auto limited = makeAdmissible(answer.start, answer.fitted);
    if (!request.model_file.empty()) answer.plan.notes.insert(answer.plan.notes.end(), limited.begin(), limited.end());
    return answer;
}

nlohmann::json toJson(const PlanAnswer& answer) {
    nlohmann::json result = makePlanJson(answer.plan, answer.model_file);
    addRecord(result, answer.record);
    return result;
}

std::string formatText(const PlanAnswer& answer, TextStyle style) {
    return formatPlan(answer.plan, answer.model_file, style);
}

void writeReport(const PlanAnswer& answer, const std::string& file, OutputFiles& outputs) {
    writePlanReport(answer.plan, answer.model_file, file, outputs);
}

namespace {

constexpr std::size_t kMostNames = 6;  // of a cell
constexpr std::size_t kDrawn = 3;      // proposals with pictures

std::string joinFirst(std::vector<std::string> words, const std::string& separator) {
    if (words.empty()) return "-";
    const std::size_t all = words.size();
    if (all > kMostNames) words.resize(kMostNames);
    return joinWords(words, separator) +
           (all > kMostNames ? separator + "and " + std::to_string(all - kMostNames) + " more" : "");
}

std::string formatTie(const std::vector<std::string>& names) {
    return joinFirst(names, " | ");
}

/// Half of the width of an interval over the value; NaN without.
double calcRelativeHalfWidth(const std::optional<std::array<double, 2>>& interval, double value) {
    return interval && value != 0 ? 0.5 * ((*interval)[1] - (*interval)[0]) / std::abs(value) : NAN;
}

std::string formatHalfWidth(const std::optional<std::array<double, 2>>& interval, double value) {
    if (!interval) return "not known";
    const double share = calcRelativeHalfWidth(interval, value);
    return std::isfinite(share) ? "± " + formatPercent(share)
                                : "± " + formatNumber(0.5 * ((*interval)[1] - (*interval)[0]), 3);
}

/// One line for each thing that a proposal tells and the recordings do not.
std::vector<std::string> listGains(const Proposal& proposal) {
    std::vector<std::string> lines;
    for (const auto& tie : proposal.gain.separates) lines.push_back("separates " + formatTie(tie));
    for (const UnidentifiedGroup& known : proposal.gain.combinations) lines.push_back("tells " + known.combination);
    return lines;
}

Table makeProposalTable(const Plan& plan) {
    Table table({"proposal", "groups separated", "parameters", "directions", "widest intervals", "largest stroke", "at",
                 "tried with"});
    for (std::size_t p = 0; p < plan.proposals.size(); ++p) {
        const Proposal& proposal = plan.proposals[p];
        table.addRow({std::to_string(p + 1), std::to_string(proposal.gain.separates.size()),
                      "+" + std::to_string(proposal.gain.becomes_known.size()),
                      "+" + std::to_string(proposal.gain.directions), "x " + formatNumber(proposal.gain.width_ratio, 2),
                      formatNumber(1e3 * proposal.extent.stroke, 3) + " mm", proposal.extent.stroke_at,
                      proposal.confirmed ? "all devices" : "the fitted one"});
    }
    return table;
}

/// Of one proposal, what becomes known first, then what narrows most.
Table makeIntervalTable(const Proposal& proposal, std::size_t most) {
    std::vector<const PlannedInterval*> rows;
    for (const PlannedInterval& interval : proposal.gain.intervals)
        if (interval.then95) rows.push_back(&interval);
    const auto ratio = [](const PlannedInterval& interval) {
        return interval.now95 ? calcRelativeHalfWidth(interval.then95, interval.value) /
                                    calcRelativeHalfWidth(interval.now95, interval.value)
                              : 0.0;
    };
    std::stable_sort(rows.begin(), rows.end(),
                     [&](const PlannedInterval* a, const PlannedInterval* b) { return ratio(*a) < ratio(*b); });
    rows.resize(std::min(rows.size(), most));
    Table table({"parameter", "value", "unit", "now (95 %)", "then (95 %)", "within a factor"});
    for (const PlannedInterval* row : rows)
        table.addRow({row->name, formatNumber(row->value) + (row->assumed ? " assumed" : ""), row->unit,
                      formatHalfWidth(row->now95, row->value), formatHalfWidth(row->then95, row->value),
                      formatNumber(row->spread, 2)});
    return table;
}

std::string describeVerdict(const Plan& plan) {
    return plan.trusted ? ""
                        : "The recordings do something that the model does not have (" +
                              formatNumber(plan.now.residual_over_noise, 3) +
                              " times the noise is left): what is foretold here holds only as far as the model does. "
                              "identify diagnose looks for what is missing.";
}

std::string describeTogether(const Plan& plan) {
    if (plan.together.size() < 2) return "";
    std::vector<std::string> numbers;
    for (const std::size_t p : plan.together) numbers.push_back(std::to_string(p + 1));
    return "Proposals " + joinWords(numbers) + " together separate all groups that any run of the list does.";
}

/// What is to be said in plain sentences beside the tables.
std::vector<std::string> listStatements(const Plan& plan) {
    std::vector<std::string> statements;
    const auto add = [&](std::string text) {
        if (!text.empty()) statements.push_back(std::move(text));
    };
    add(describeVerdict(plan));
    if (listTies(plan.now).empty()) add("The recordings leave no group open.");
    if (plan.proposals.empty())
        add("None of the " + std::to_string(plan.rehearsed) +
            " runs that were rehearsed separates a group or narrows the intervals by a tenth, within these limits.");
    add(describeTogether(plan));
    if (!plan.unreached.empty())
        add("What no run of the list within these limits tells one by one: " + std::to_string(plan.unreached.size()) +
            (plan.unreached.size() == 1 ? " group." : " groups."));
    return statements;
}

Table makeUnreachedTable(const Plan& plan) {
    Table table({"told by no run of the list", "known of it then", "by proposal", "would be told by"});
    for (const UnreachedTie& tie : plan.unreached)
        table.addRow({formatTie(tie.names), tie.combination.empty() ? "-" : tie.combination,
                      tie.combination.empty() ? "-" : std::to_string(tie.proposal + 1), tie.separate_by});
    return table;
}

std::vector<std::string> listCombinations(const Proposal& proposal) {
    std::vector<std::string> combinations;
    for (const UnidentifiedGroup& known : proposal.gain.combinations) combinations.push_back(known.combination);
    return combinations;
}

nlohmann::json intervalOrNull(const std::optional<std::array<double, 2>>& interval) {
    return interval ? nlohmann::json(*interval) : nlohmann::json(nullptr);
}

Plot plotIntervals(const Proposal& proposal, std::size_t number) {
    Plot plot{"Half width of the 95 % intervals, proposal " + std::to_string(number),
              "number of the parameter [-]",
              "half width over value [-]",
              {{"now", {}, {}, true, 0}, {"then", {}, {}, true, 1}},
              true,
              true};
    const auto& intervals = proposal.gain.intervals;
    for (std::size_t i = 0; i < intervals.size(); ++i)
        for (std::size_t s = 0; s < 2; ++s) {
            const double width =
                calcRelativeHalfWidth(s == 0 ? intervals[i].now95 : intervals[i].then95, intervals[i].value);
            if (!std::isfinite(width)) continue;
            plot.series[s].x.push_back(static_cast<double>(i + 1));
            plot.series[s].y.push_back(width);
        }
    plot.series.erase(
        std::remove_if(plot.series.begin(), plot.series.end(), [](const Series& series) { return series.x.empty(); }),
        plot.series.end());
    return plot;
}

Plot plotStrokes(const Proposal& proposal, std::size_t number) {
    std::vector<double> millimetres;
    for (const double stroke : proposal.extent.strokes) millimetres.push_back(1e3 * stroke);
    return {"Largest stroke of all connections, proposal " + std::to_string(number),
            "swept frequency [Hz]",
            "relative displacement [mm]",
            {{"rehearsed", proposal.extent.hertz, millimetres}},
            false};
}

}  // namespace

std::string formatPlan(const Plan& plan, const std::string& model_file, TextStyle style) {
    constexpr std::size_t rows = 12;
    std::string text;
    if (!plan.proposals.empty()) text += makeProposalTable(plan).format(style) + "\n";
    for (std::size_t p = 0; p < plan.proposals.size(); ++p) {
        const Proposal& proposal = plan.proposals[p];
        text += "Proposal " + std::to_string(p + 1) + ": " + describe(proposal.candidate) + "\n  " +
                formatCommand(proposal.candidate, model_file) + "\n";
        for (const auto& line : listGains(proposal)) text += "  " + line + "\n";
    }
    if (!plan.proposals.empty())
        text += "\nIntervals with proposal 1:\n" + makeIntervalTable(plan.proposals.front(), rows).format(style);
    for (const auto& statement : listStatements(plan)) text += "\n" + statement;
    text += "\n";
    if (!plan.unreached.empty()) text += makeUnreachedTable(plan).format(style) + "\n";
    for (const auto& note : plan.notes) text += "note: " + note + "\n";
    return text;
}

nlohmann::json makePlanJson(const Plan& plan, const std::string& model_file) {
    auto proposals = nlohmann::json::array(), unreached = nlohmann::json::array();
    for (const Proposal& proposal : plan.proposals) {
        auto intervals = nlohmann::json::array();
        for (const PlannedInterval& interval : proposal.gain.intervals)
            intervals.push_back({{"name", interval.name},
                                 {"unit", interval.unit},
                                 {"value", numberOrNull(interval.value)},
                                 {"assumed", interval.assumed},
                                 {"now95", intervalOrNull(interval.now95)},
                                 {"then95", intervalOrNull(interval.then95)},
                                 {"spread", interval.spread}});
        proposals.push_back({{"excitation", describe(proposal.candidate)},
                             {"command", formatCommand(proposal.candidate, model_file)},
                             {"separates", proposal.gain.separates},
                             {"becomes_known", proposal.gain.becomes_known},
                             {"combinations", listCombinations(proposal)},
                             {"directions", proposal.gain.directions},
                             {"confirmed", proposal.confirmed},
                             {"width_ratio", proposal.gain.width_ratio},
                             {"stroke", {{"value", proposal.extent.stroke}, {"at", proposal.extent.stroke_at}}},
                             {"intervals", std::move(intervals)}});
        if (proposal.candidate.excitation == Excitation::base)
            proposals.back()["base_displacement"] = proposal.extent.base_displacement;
    }
    for (const UnreachedTie& tie : plan.unreached)
        unreached.push_back(
            {{"names", tie.names}, {"separate_by", tie.separate_by}, {"known_combination", tie.combination}});
    std::vector<std::size_t> together;
    for (const std::size_t p : plan.together) together.push_back(p + 1);
    const PlanLimits& limits = plan.setup.limits;
    return {{"proposals", std::move(proposals)},
            {"together", together},
            {"unreached", std::move(unreached)},
            {"rehearsed", plan.rehearsed},
            {"trusted", plan.trusted},
            {"residual", {{"fraction", plan.now.residual_fraction}, {"over_noise", plan.now.residual_over_noise}}},
            {"limits",
             {{"force", limits.force},
              {"acceleration", limits.acceleration},
              {"displacement", limits.displacement},
              {"stroke", limits.stroke}}},
            {"notes", plan.notes}};
}

void writePlanReport(const Plan& plan, const std::string& model_file, const std::string& file, OutputFiles& outputs) {
    HtmlReport page("The next test: " + plan.now.model.name);
    page.addLead(plan.proposals.empty() ? "No run of the list tells more than the recordings do."
                                        : "Best: " + describe(plan.proposals.front().candidate));
    const Table table = makeProposalTable(plan);
    if (!table.empty()) page.addTable(table.header(), table.rows());
    for (const auto& statement : listStatements(plan)) page.addText(statement);
    const Table unreached = makeUnreachedTable(plan);
    if (!unreached.empty()) page.addTable(unreached.header(), unreached.rows());
    for (std::size_t p = 0; p < plan.proposals.size(); ++p) {
        const Proposal& proposal = plan.proposals[p];
        page.addHeading("Proposal " + std::to_string(p + 1));
        page.addText(describe(proposal.candidate));
        page.addText(formatCommand(proposal.candidate, model_file));
        page.addList(listGains(proposal));
        if (p >= kDrawn) continue;
        page.addPlots({plotIntervals(proposal, p + 1), plotStrokes(proposal, p + 1)});
        const Table intervals = makeIntervalTable(proposal, proposal.gain.intervals.size());
        page.addTable(intervals.header(), intervals.rows());
    }
    page.addHeading("What this rests on");
    page.addList(plan.notes);
    page.write(file, outputs);
}

}  // namespace wems::identify::commands
