#include "identify/cli/rigidity_report.hpp"

#include <algorithm>
#include <cmath>

#include "identify/cli/device_scene.hpp"
#include "models/error.hpp"
#include "models/format_number.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {
namespace {

constexpr Eigen::Index kStretches = 200;

/// The noise of ten checks over all samples would be a black band.
Series takeLargest(const RigidityCheck& check, const std::vector<double>& x) {
    Series series{check.name, {}, {}};
    const Eigen::Index count = std::min(check.percent.size(), static_cast<Eigen::Index>(x.size())),
                       stretches = std::min(count, kStretches);
    for (Eigen::Index s = 0; s < stretches; ++s) {
        const Eigen::Index from = s * count / stretches, to = (s + 1) * count / stretches;
        series.x.push_back(x[static_cast<std::size_t>((from + to) / 2)]);
        series.y.push_back(check.percent.segment(from, to - from).cwiseAbs().maxCoeff());
    }
    return series;
}

void addMotionIfKnown(HtmlReport& report, const Recording& recording, const MountModel& model,
                      const std::vector<DrawnShape>& drawing) {
    try {
        addMotion(report, makeDeviceScene({recording}, model, drawing));
    } catch (const InputError& error) {
        report.addText(std::string("The device cannot be shown in motion: ") + error.what());
    }
}

}  // namespace

void writeRigidityReport(const Rigidity& rigidity, const Table& table, const std::vector<std::string>& sentences,
                         const Recording& recording, const MountModel& model, const std::vector<DrawnShape>& drawing,
                         const std::string& file, OutputFiles& outputs) {
    HtmlReport report("Rigidity: " + recording.file);
    const auto worst =
        std::max_element(rigidity.checks.begin(), rigidity.checks.end(),
                         [](const RigidityCheck& a, const RigidityCheck& b) { return a.max_percent < b.max_percent; });
    if (worst != rigidity.checks.end())
        report.addLead("The two parts move as rigid bodies within " + formatNumber(worst->max_percent, 3) +
                       " %; the largest error is that of " + worst->name +
                       (std::isfinite(worst->at_frequency) ? " at " + formatNumber(worst->at_frequency, 4) + " Hz"
                                                           : " at " + formatNumber(worst->at_time, 4) + " s") +
                       ".");
    report.addTable(table.header(), table.rows());
    for (const std::string& sentence : sentences) report.addText(sentence);
    report.addText("Drawn is the largest error of each check, either way, in each of up to " +
                   std::to_string(kStretches) + " stretches of the run.");
    const auto& hertz = rigidity.swept.hertz;
    const std::vector<double> frequencies(hertz.data(), hertz.data() + hertz.size());
    for (const bool fixed : {false, true}) {
        const std::string part = fixed ? "fixed part" : "mobile part";
        Plot time{"Error over time, " + part, "time [s]", "largest error [%]", {}},
            frequency{"Error over swept frequency, " + part, "swept frequency [Hz]", "largest error [%]", {}};
        for (const RigidityCheck& check : rigidity.checks) {
            if ((check.name.rfind("fixed ", 0) == 0) != fixed) continue;
            time.series.push_back(takeLargest(check, rigidity.time));
            if (rigidity.swept.is_sine) frequency.series.push_back(takeLargest(check, frequencies));
        }
        if (!time.series.empty()) report.addPlot(time);
        if (!frequency.series.empty()) report.addPlot(frequency);
    }
    addMotionIfKnown(report, recording, model, drawing);
    report.write(file, outputs);
}

}  // namespace wems::identify::cli
