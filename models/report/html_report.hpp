/// @file
/// A self-contained HTML page: text, tables, interactive plots, surfaces and the device in motion, no network at view
/// time. Plots are drawn by dygraphs, what has three dimensions by three.js (Debian's libjs-dygraphs and libjs-three),
/// which are embedded in the page once, if it needs them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace wems {

// A restoring force over relative displacement and velocity, as a report shows it in three dimensions.

/// One force over the common cells, in the unit of the picture's label.
struct ForceSheet {
    std::string name;
    Eigen::MatrixXd force;  ///< displacements x velocities; NaN leaves a hole
    bool points = false;    ///< a point for each cell in place of a sheet
    int color = 0;          ///< place in the palette of the plots
};

struct ForceSurface {
    std::string title;
    std::string displacement_label, velocity_label, force_label;  ///< with units
    Eigen::VectorXd displacement, velocity;                       ///< middles of the cells, ascending
    std::vector<ForceSheet> sheets;
};

/// The surface as a JavaScript object.
std::string formatSurface(const ForceSurface& surface);

class OutputFiles;
struct ForceSurface;
struct MotionScene;

/// A curve or a cloud of points. Values that are not finite leave a gap.
struct Series {
    std::string name;
    std::vector<double> x, y;
    std::optional<bool> points = std::nullopt;  ///< in place of the plot's
    std::optional<int> color = std::nullopt;    ///< place in the palette; absent: the series' place in the plot
};

struct Plot {
    std::string title;
    std::string x_label, y_label;  ///< with units: `swept frequency [Hz]`
    std::vector<Series> series;
    bool points = false;  ///< a cloud of points in place of lines
    bool log_y = false;   ///< logarithmic axis; values that are not positive leave a gap
};

/// Indices of at most 4 · `buckets` samples that keep the shape of y over x: the first, lowest, highest and last sample
/// of each bucket. All indices if there are no more than that. Order is kept.
std::vector<std::size_t> decimateByShape(const std::vector<double>& y, std::size_t buckets);

/// Indices of at most `most` points that keep the shape of a cloud: of a grid as fine as that allows the first point in
/// each cell. All indices if there are no more than that. Order is kept; points that are not finite are left out.
std::vector<std::size_t> decimateCloud(const std::vector<double>& x, const std::vector<double>& y, std::size_t most);

class HtmlReport {
public:
    explicit HtmlReport(std::string title);

    void addHeading(const std::string& text);
    /// What the page says above all.
    void addLead(const std::string& text);
    void addText(const std::string& text);
    void addList(const std::vector<std::string>& items);
    /// Columns that hold mostly numbers are aligned at the right.
    void addTable(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows);
    /// Lines and clouds are decimated by shape, to some 4000 points each, fewer where there are more than six series.
    void addPlot(const Plot& plot);
    /// Small ones beside each other, as far as the page is wide enough; with half the points.
    void addPlots(const std::vector<Plot>& plots);
    /// The device moving (motion_scene.hpp).
    void addScene(const MotionScene& scene);
    /// A restoring force in three dimensions (below).
    void addSurface(const ForceSurface& surface);

    std::string format() const;
    /// Complete or not at all. @throws InputError if the file cannot be written.
    void write(const std::string& file) const;
    /// The same as one of the files that a command writes.
    void write(const std::string& file, OutputFiles& outputs) const;

private:
    void addPlot(const Plot& plot, std::size_t buckets);

    std::string title_, body_, data_;
    int plot_count_ = 0, scene_count_ = 0, surface_count_ = 0;
};

}  // namespace wems
