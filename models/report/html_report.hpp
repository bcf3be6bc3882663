/// @file
/// A self-contained HTML page: text, tables, interactive plots and the device in motion, no network at view time. Plots
/// are drawn by dygraphs, the device by three.js (Debian's libjs-dygraphs and libjs-three), which are embedded in the
/// page once, if it needs them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace wems {

struct MotionScene;

/// A curve or a cloud of points. Values that are not finite leave a gap.
struct Series {
    std::string name;
    std::vector<double> x, y;
};

struct Plot {
    std::string title;
    std::string x_label, y_label;  ///< with units: `swept frequency [Hz]`
    std::vector<Series> series;
    bool points = false;  ///< a cloud of points in place of lines
};

/// Indices of at most 4 · `buckets` samples that keep the shape of y over x: the first, lowest, highest and last sample
/// of each bucket. All indices if there are no more than that. Order is kept.
std::vector<std::size_t> decimateByShape(const std::vector<double>& y, std::size_t buckets);

class HtmlReport {
public:
    explicit HtmlReport(std::string title);

    void addHeading(const std::string& text);
    void addText(const std::string& text);
    void addTable(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
    /// Series of lines are decimated by shape, clouds of points by stride, to some 4000 points each, fewer where there
    /// are more than six series.
    void addPlot(const Plot& plot);
    /// The device moving (motion_scene.hpp).
    void addScene(const MotionScene& scene);

    std::string format() const;
    /// Complete or not at all. @throws InputError if the file cannot be written.
    void write(const std::string& file) const;

private:
    std::string title_, body_, data_;
    int plot_count_ = 0, scene_count_ = 0;
};

}  // namespace wems
