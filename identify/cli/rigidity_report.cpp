#include "identify/cli/rigidity_report.hpp"

#include "models/report/html_report.hpp"

namespace wems::identify::cli {

void writeRigidityReport(const Rigidity& rigidity, const Table& table, const std::vector<std::string>& sentences,
                         const std::string& recording, const std::string& file) {
    HtmlReport report("Rigidity: " + recording);
    report.addListing(table.format());
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
    report.write(file);
}

}  // namespace wems::identify::cli
