#include "identify/cli/rigidity_report.hpp"

#include "identify/cli/device_scene.hpp"
#include "models/error.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

void addMotionIfKnown(HtmlReport& report, const Recording& recording, const MountModel& model) {
    try {
        addMotion(report, makeDeviceScene({recording}, model));
    } catch (const InputError& error) {
        report.addText(std::string("The device cannot be shown in motion: ") + error.what());
    }
}

}  // namespace

void writeRigidityReport(const Rigidity& rigidity, const Table& table, const std::vector<std::string>& sentences,
                         const Recording& recording, const MountModel& model, const std::string& file) {
    HtmlReport report("Rigidity: " + recording.file);
    report.addTable(table.header(), table.rows());
    for (const std::string& sentence : sentences) report.addText(sentence);
    const auto& hertz = rigidity.swept.hertz;
    const bool over_frequency = rigidity.swept.is_sine;
    for (const bool frequency : {false, true}) {
        if (frequency && !over_frequency) continue;
        Plot plot;
        plot.title = frequency ? "Error over swept frequency" : "Error over time";
        plot.x_label = frequency ? "swept frequency [Hz]" : "time [s]";
        plot.y_label = "relative error [%]";
        for (const RigidityCheck& check : rigidity.checks) {
            const std::vector<double> y(check.percent.data(), check.percent.data() + check.percent.size());
            plot.series.push_back(
                {check.name, frequency ? std::vector<double>(hertz.data(), hertz.data() + hertz.size()) : rigidity.time,
                 y});
        }
        report.addPlot(plot);
    }
    addMotionIfKnown(report, recording, model);
    report.write(file);
}

}  // namespace wems::identify::cli
