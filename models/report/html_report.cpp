#include "models/report/html_report.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "models/common/atomic_file.hpp"
#include "models/report/html_text.hpp"
#include "models/report/motion_scene.hpp"

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

namespace {

constexpr std::size_t most_buckets = 1000, fewest_buckets = 150;  // of a series
constexpr std::size_t buckets_per_plot = 6000;                    // what a browser redraws without delay

/// What is kept of a series, in order of x.
std::string formatSeries(const Series& series, const Plot& plot, std::size_t place, std::size_t buckets) {
    const bool points = series.points.value_or(plot.points);
    const int color = series.color.value_or(static_cast<int>(place));
    const std::size_t count = std::min(series.x.size(), series.y.size());
    std::vector<std::size_t> kept;
    for (const auto i : points ? decimateCloud(series.x, series.y, 4 * buckets) : decimateByShape(series.y, buckets))
        if (i < count && std::isfinite(series.x[i])) kept.push_back(i);
    std::stable_sort(kept.begin(), kept.end(), [&](std::size_t a, std::size_t b) { return series.x[a] < series.x[b]; });
    std::string x, y;
    for (const auto i : kept) {
        x += formatScriptNumber(series.x[i]) + ",";
        y += formatScriptNumber(plot.log_y && series.y[i] <= 0 ? NAN : series.y[i]) + ",";
    }
    return "{name:" + quoteScript(series.name) + ",points:" + (points ? "true" : "false") +
           ",color:" + std::to_string(color) + ",x:[" + x + "],y:[" + y + "]}";
}

/// Whether a cell holds numbers alone: `-1.5e-3`, `4.2 @ 31` and `5 … 50` do, `1.z` does not.
bool isNumeric(const std::string& cell) {
    const bool begins = !cell.empty() && cell.find_first_of("0123456789.+-") == 0;
    return begins && std::none_of(cell.begin(), cell.end(),
                                  [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 && c != 'e'; });
}

/// Numbers stand under each other at the right, words at the left, and so do the headers above them.
bool isNumericColumn(const std::vector<std::vector<std::string>>& rows, std::size_t column) {
    if (column == 0) return false;
    std::size_t numbers = 0, words = 0;
    for (const auto& row : rows)
        if (column < row.size() && !row[column].empty()) ++(isNumeric(row[column]) ? numbers : words);
    return numbers > words;
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

std::vector<std::size_t> decimateCloud(const std::vector<double>& x, const std::vector<double>& y, std::size_t most) {
    std::vector<std::size_t> finite;
    double low[] = {INFINITY, INFINITY}, high[] = {-INFINITY, -INFINITY};
    for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
        if (!std::isfinite(x[i]) || !std::isfinite(y[i])) continue;
        finite.push_back(i);
        const double at[] = {x[i], y[i]};
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], at[k]);
            high[k] = std::max(high[k], at[k]);
        }
    }
    std::vector<std::size_t> kept = finite;
    // At most all cells are taken, so that the last grid is coarse enough.
    for (double cells = 512; kept.size() > most && cells >= 1; cells *= 0.7) {
        const auto cellOf = [&](double value, int k) {
            return high[k] > low[k] ? std::floor(cells * (value - low[k]) / (high[k] - low[k])) : 0.0;
        };
        std::set<std::pair<double, double>> taken;
        kept.clear();
        for (const auto i : finite)
            if (taken.emplace(cellOf(x[i], 0), cellOf(y[i], 1)).second) kept.push_back(i);
    }
    return kept;
}

HtmlReport::HtmlReport(std::string title) : title_(std::move(title)) {}

void HtmlReport::addHeading(const std::string& text) {
    body_ += "<h2>" + escapeHtml(text) + "</h2>\n";
}

void HtmlReport::addLead(const std::string& text) {
    body_ += "<p class=\"lead\">" + escapeHtml(text) + "</p>\n";
}

void HtmlReport::addText(const std::string& text) {
    body_ += "<p>" + escapeHtml(text) + "</p>\n";
}

void HtmlReport::addList(const std::vector<std::string>& items) {
    if (items.empty()) return;
    body_ += "<ul>\n";
    for (const auto& item : items) body_ += "<li>" + escapeHtml(item) + "</li>\n";
    body_ += "</ul>\n";
}

void HtmlReport::addTable(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::string> kind;
    for (std::size_t i = 0; i < header.size(); ++i) kind.push_back(isNumericColumn(rows, i) ? "number" : "");
    body_ += "<div class=\"table\"><table><thead><tr>";
    for (std::size_t i = 0; i < header.size(); ++i)
        body_ += "<th scope=\"col\" class=\"" + kind[i] + "\">" + escapeHtml(header[i]) + "</th>";
    body_ += "</tr></thead><tbody>\n";
    constexpr std::size_t longest_unbroken = 24;  // numbers and names stay on one line, sentences need not
    for (const auto& row : rows) {
        body_ += "<tr>";
        for (std::size_t i = 0; i < row.size(); ++i)
            body_ += "<td class=\"" + (i < kind.size() ? kind[i] : "") +
                     (row[i].size() <= longest_unbroken ? " short" : " long") + "\">" + escapeHtml(row[i]) + "</td>";
        body_ += "</tr>\n";
    }
    body_ += "</tbody></table></div>\n";
}

void HtmlReport::addPlot(const Plot& plot) {
    addPlot(plot, most_buckets);
}

void HtmlReport::addPlots(const std::vector<Plot>& plots) {
    body_ += "<div class=\"plots\">\n";
    for (const Plot& plot : plots) addPlot(plot, most_buckets / 2);
    body_ += "</div>\n";
}

void HtmlReport::addPlot(const Plot& plot, std::size_t buckets) {
    const std::string id = "plot" + std::to_string(++plot_count_);
    body_ += "<figure><figcaption>" + escapeHtml(plot.title) + "</figcaption><div class=\"plot\" id=\"" + id +
             "\" role=\"img\" aria-label=\"" + escapeHtml(plot.title) + "\"></div></figure>\n";
    data_ += "wemsPlot({id:" + quoteScript(id) + ",title:" + quoteScript(plot.title) +
             ",x:" + quoteScript(plot.x_label) + ",y:" + quoteScript(plot.y_label) +
             ",logY:" + (plot.log_y ? "true" : "false") + ",series:[";
    const std::size_t own =
        std::clamp(buckets_per_plot / std::max<std::size_t>(1, plot.series.size()), fewest_buckets, buckets);
    for (std::size_t i = 0; i < plot.series.size(); ++i) data_ += formatSeries(plot.series[i], plot, i, own) + ",";
    data_ += "]});\n";
}

void HtmlReport::addScene(const MotionScene& scene) {
    const std::string id = "scene" + std::to_string(++scene_count_);
    body_ +=
        "<figure class=\"scene\" id=\"" + id + "\"><figcaption>" + escapeHtml(scene.title) + "</figcaption></figure>\n";
    data_ += "wemsScene(" + quoteScript(id) + "," + formatScene(scene) + ");\n";
}

void HtmlReport::addSurface(const ForceSurface& surface) {
    const std::string id = "surface" + std::to_string(++surface_count_);
    body_ += "<figure class=\"surface\" id=\"" + id + "\"><figcaption>" + escapeHtml(surface.title) +
             "</figcaption></figure>\n";
    data_ += "wemsSurface(" + quoteScript(id) + "," + formatSurface(surface) + ");\n";
}

std::string HtmlReport::format() const {
    const auto script = [](const std::string& text) { return "<script>" + text + "</script>\n"; };
    std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n";
    page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" + escapeHtml(title_) +
            "</title>\n";
    page += "<style>" + report_assets::dygraphsStyle() + report_assets::pageStyle() +
            "</style>\n</head><body>\n<main><h1>" + escapeHtml(title_) + "</h1>\n" + body_ + "</main>\n";
    if (plot_count_ > 0) page += script(report_assets::dygraphsScript());
    if (scene_count_ + surface_count_ > 0)
        page += script(report_assets::threeScript()) + script(report_assets::orbitControlsScript()) +
                script(report_assets::stageScript());
    if (scene_count_ > 0) page += script(report_assets::animationScript());
    if (surface_count_ > 0) page += script(report_assets::surfaceScript());
    if (!data_.empty()) page += script(report_assets::exportScript() + report_assets::pageScript() + data_);
    return page + "</body></html>\n";
}

void HtmlReport::write(const std::string& file, OutputFiles& outputs) const {
    outputs.add(file, format());
}

void HtmlReport::write(const std::string& file) const {
    OutputFiles outputs;
    write(file, outputs);
    outputs.commit();
}

}  // namespace wems
