#include "models/report/html_report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "models/atomic_file.hpp"
#include "models/report/assets.hpp"
#include "models/report/html_text.hpp"
#include "models/report/motion_scene.hpp"

namespace wems {
namespace {

constexpr std::size_t most_buckets = 1000, fewest_buckets = 300;  // of a series
constexpr std::size_t buckets_per_plot = 6000;                    // what a browser redraws without delay

std::vector<std::size_t> thinOut(std::size_t count, std::size_t most) {
    const std::size_t stride = std::max<std::size_t>(1, (count + most - 1) / most);
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < count; i += stride) kept.push_back(i);
    return kept;
}

/// What is kept of a series, in order of x.
std::string formatSeries(const Series& series, bool points, std::size_t buckets) {
    const std::size_t count = std::min(series.x.size(), series.y.size());
    std::vector<std::size_t> kept;
    for (const auto i : points ? thinOut(count, 4 * buckets) : decimateByShape(series.y, buckets))
        if (i < count && std::isfinite(series.x[i])) kept.push_back(i);
    std::stable_sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) { return series.x[a] < series.x[b]; });
    std::string x, y;
    for (const auto i : kept) {
        x += formatScriptNumber(series.x[i]) + ",";
        y += formatScriptNumber(series.y[i]) + ",";
    }
    return "{name:" + quoteScript(series.name) + ",x:[" + x + "],y:[" + y + "]}";
}

}  // namespace

std::vector<std::size_t> decimateByShape(const std::vector<double>& y, std::size_t buckets) {
    std::vector<std::size_t> kept;
    if (y.size() <= 4 * buckets) {
        kept.resize(y.size());
        std::iota(kept.begin(), kept.end(), std::size_t{0});
        return kept;
    }
    for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
        const std::size_t from = bucket * y.size() / buckets;
        const std::size_t to = (bucket + 1) * y.size() / buckets;
        const auto extremes = std::minmax_element(y.begin() + static_cast<std::ptrdiff_t>(from),
                                                  y.begin() + static_cast<std::ptrdiff_t>(to));
        std::size_t chosen[] = {from, static_cast<std::size_t>(extremes.first - y.begin()),
                                static_cast<std::size_t>(extremes.second - y.begin()), to - 1};
        std::sort(std::begin(chosen), std::end(chosen));
        kept.insert(kept.end(), std::begin(chosen), std::unique(std::begin(chosen), std::end(chosen)));
    }
    return kept;
}

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {}

void HtmlReport::addHeading(const std::string& text) {
    body_ += "<h2>" + escapeHtml(text) + "</h2>\n";
}

void HtmlReport::addText(const std::string& text) {
    body_ += "<p>" + escapeHtml(text) + "</p>\n";
}

void HtmlReport::addTable(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
    body_ += "<div class=\"table\"><table><thead><tr>";
    for (const auto& cell : header) body_ += "<th scope=\"col\">" + escapeHtml(cell) + "</th>";
    body_ += "</tr></thead><tbody>\n";
    constexpr std::size_t longest_unbroken = 24;  // numbers and names stay on one line, sentences need not
    for (const auto& row : rows) {
        body_ += "<tr>";
        for (const auto& cell : row)
            body_ += (cell.size() <= longest_unbroken ? "<td class=\"short\">" : "<td>") + escapeHtml(cell) + "</td>";
        body_ += "</tr>\n";
    }
    body_ += "</tbody></table></div>\n";
}

void HtmlReport::addPlot(const Plot& plot) {
    const std::string id = "plot" + std::to_string(++plot_count_);
    body_ += "<figure><figcaption>" + escapeHtml(plot.title) + "</figcaption><div class=\"plot\" id=\"" + id +
             "\" role=\"img\" aria-label=\"" + escapeHtml(plot.title) + "\"></div></figure>\n";
    data_ += "wemsPlot({id:" + quoteScript(id) + ",title:" + quoteScript(plot.title) +
             ",x:" + quoteScript(plot.x_label) + ",y:" + quoteScript(plot.y_label) +
             ",points:" + (plot.points ? "true" : "false") + ",series:[";
    const std::size_t buckets =
        std::clamp(buckets_per_plot / std::max<std::size_t>(1, plot.series.size()), fewest_buckets, most_buckets);
    for (const Series& series : plot.series) data_ += formatSeries(series, plot.points, buckets) + ",";
    data_ += "]});\n";
}

void HtmlReport::addScene(const MotionScene& scene) {
    const std::string id = "scene" + std::to_string(++scene_count_);
    body_ +=
        "<figure class=\"scene\" id=\"" + id + "\"><figcaption>" + escapeHtml(scene.title) + "</figcaption></figure>\n";
    data_ += "wemsScene(" + quoteScript(id) + "," + formatScene(scene) + ");\n";
}

std::string HtmlReport::format() const {
    const auto script = [](const std::string& text) { return "<script>" + text + "</script>\n"; };
    std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
    page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" + escapeHtml(title_) +
            "</title>\n";
    page += "<style>" + report_assets::dygraphsStyle() + report_assets::pageStyle() +
            "</style>\n</head><body>\n<main><h1>" + escapeHtml(title_) + "</h1>\n" + body_ + "</main>\n";
    if (plot_count_ > 0) page += script(report_assets::dygraphsScript());
    if (scene_count_ > 0)
        page += script(report_assets::threeScript()) + script(report_assets::orbitControlsScript()) +
                script(report_assets::animationScript());
    if (!data_.empty()) page += script(report_assets::pageScript() + data_);
    return page + "</body></html>\n";
}

void HtmlReport::write(const std::string& file) const {
    AtomicFile::write(file, format());
}

}  // namespace wems
