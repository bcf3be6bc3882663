#include "plugin/response_command.hpp"

#include <unistd.h>

#include <optional>
#include <tuple>
#include <utility>

#include "models/common/format_number.hpp"
#include "models/common/progress.hpp"
#include "plugin/linear_analysis.hpp"
#include "plugin/run_settings.hpp"

namespace wems::plugin {
namespace {

std::string describeLevel(const SimulateOptions& options, const Eigen::Vector3d& value) {
    const bool force = !options.force.isZero();
    std::string text;
    for (int i = 0; i < 3; ++i)
        if (value[i] != 0)
            text += (text.empty() ? "" : ",") + std::string(1, "xyz"[i]) + "=" + formatNumber(value[i], 6);
    return (force ? "force " : "base acceleration ") + text + (force ? " N" : " m/s^2");
}

}  // namespace

const char* nameInstability(Instability instability) {
    switch (instability) {
        case Instability::real:
            return "fold or pitchfork";
        case Instability::period_doubling:
            return "period doubling";
        case Instability::neimark_sacker:
            return "Neimark-Sacker";
        case Instability::none:
            break;
    }
    return "";
}

std::vector<std::string> nameStops(const MountModel& model) {
    std::vector<std::string> names;
    for (const Connection& connection : model.connections)
        for (std::size_t k = 0; k < 3; ++k)
            for (const Stop& stop : connection.axis[k].stops)
                names.push_back(connection.name + "." + "xyz"[k] + (stop.side == Side::positive ? ".+" : ".-"));
    return names;
}

std::vector<std::string> nameAxes(const MountModel& model) {
    std::vector<std::string> names;
    for (const Connection& connection : model.connections)
        for (const char axis : {'x', 'y', 'z'}) names.push_back(connection.name + "." + axis);
    return names;
}

std::vector<LevelResponse> calcResponses(const MountModel& model, const SimulateOptions& options,
                                         const ResponseProgress& progress) {
    validate(model);
    ResponseSettings settings;
    std::tie(settings.from, settings.to) = parseBand(options.response, "--response");
    settings.harmonics = options.harmonics;
    std::vector<LevelResponse> levels;
    for (const Level& level : options.levels) {
        const std::string name = describeLevel(options, level.value);
        settings.progress = [&](double frequency, int points) {
            const double share = (frequency - settings.from) / (settings.to - settings.from);
            progress((static_cast<double>(levels.size()) + share) / static_cast<double>(options.levels.size()), name,
                     frequency, points);
        };
        const bool force = !options.force.isZero();
        const Eigen::Vector3d none = Eigen::Vector3d::Zero();
        levels.push_back(
            {name, calcResponseCurve(model, {force ? level.value : none, force ? none : level.value}, settings)});
    }
    return levels;
}

void runResponseCurves(const SimulateOptions& options) {
    const MountModel model = readMountModel(options.model_file);
    OutputFiles outputs = beginOutputs(options, model);
    std::optional<Progress> progress(std::in_place, !options.quiet);
    const auto levels =
        calcResponses(model, options, [&](double done, const std::string& level, double frequency, int points) {
            if (progress->due())
                progress->show(
                    done, level + ", " + formatNumber(frequency, 4) + " Hz, " + std::to_string(points) + " points");
        });
    progress.reset();
    if (!options.output_file.empty()) outputs.add(options.output_file, formatResponseCsv(model, levels));
    if (!options.report_file.empty()) writeResponseReport(model, levels, options.report_file, outputs);
    nlohmann::json result = makeResponseJson(model, levels);
    addRecord(result, makeRecord(options, "response", model));
    finishOutputs(options, result, formatResponses(model, levels, styleOf(STDOUT_FILENO)), outputs);
}

}  // namespace wems::plugin
