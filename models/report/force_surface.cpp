#include "models/report/force_surface.hpp"

#include "models/report/html_text.hpp"

namespace wems {
namespace {

std::string formatAxis(const std::string& label, const Eigen::VectorXd& values) {
    std::string text = "{label:" + quoteScript(label) + ",values:[";
    for (const double value : values) text += formatScriptNumber(value) + ",";
    return text + "]}";
}

std::string formatSheet(const ForceSheet& sheet) {
    std::string values;
    for (Eigen::Index i = 0; i < sheet.force.rows(); ++i)
        for (Eigen::Index j = 0; j < sheet.force.cols(); ++j) values += formatScriptNumber(sheet.force(i, j)) + ",";
    return "{name:" + quoteScript(sheet.name) + ",points:" + (sheet.points ? "true" : "false") +
           ",color:" + std::to_string(sheet.color) + ",values:[" + values + "]}";
}

}  // namespace

std::string formatSurface(const ForceSurface& surface) {
    std::string sheets;
    for (const ForceSheet& sheet : surface.sheets) sheets += formatSheet(sheet) + ",";
    return "{title:" + quoteScript(surface.title) +
           ",x:" + formatAxis(surface.displacement_label, surface.displacement) +
           ",y:" + formatAxis(surface.velocity_label, surface.velocity) +
           ",z:{label:" + quoteScript(surface.force_label) + "},sheets:[" + sheets + "]}";
}

}  // namespace wems
