#include "identify/commands/restoring_forces.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "identify/commands/component_fit.hpp"
#include "identify/component/surface.hpp"
#include "identify/problem/mount_equation.hpp"
#include "identify/problem/open_loop_run.hpp"
#include "models/common/format_number.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::commands {

namespace {

constexpr int kFewestCells = 12, kMostCells = 32;  // each way …
constexpr double kSamplesPerCell = 12;             // … so that cells are filled

Eigen::VectorXd findMiddles(const Eigen::VectorXd& edges) {
    return 0.5 * (edges.head(edges.size() - 1) + edges.tail(edges.size() - 1));
}

std::vector<double> scale(const Eigen::VectorXd& values, double factor) {
    const Eigen::VectorXd scaled = factor * values;
    return {scaled.begin(), scaled.end()};
}

std::vector<double> scale(const std::vector<double>& values, double factor) {
    return scale(Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(values.data(), values.size())), factor);
}

}  // namespace

ForceSurface makeEmptySurface(const std::string& title) {
    ForceSurface surface;
    surface.title = title;
    surface.displacement_label = "displacement [mm]";
    surface.velocity_label = "velocity [m/s]";
    surface.force_label = "force [N]";
    return surface;
}

void addSheet(ForceSurface& surface, const std::string& name, const ComponentData& data, bool points, int color) {
    const double filled = std::sqrt(static_cast<double>(data.q.size()) / kSamplesPerCell);
    const int cells = std::clamp(static_cast<int>(filled), kFewestCells, kMostCells);
    const SurfaceGrid grid = makeSurfaceGrid(data, cells, cells);
    surface.displacement = 1e3 * findMiddles(grid.q_edges);
    surface.velocity = findMiddles(grid.v_edges);
    surface.sheets.push_back({name, grid.median, points, color});
}

void writeSurfaceReport(const ComponentData& data, const SurfaceKind& kind, const std::string& file,
                        OutputFiles& outputs) {
    constexpr int cells = 60;
    const std::vector<double> force = scale(data.force, 1), displacement = scale(data.q, 1e3);
    HtmlReport report("Restoring force surface: " + data.file);
    std::string lead = "Connection " + data.connection + ", axis " + "xyz"[data.axis] + ": " + kind.name;
    if (!kind.parameters.empty())
        lead += ", " + kind.parameters.front().name + " " + formatNumber(kind.parameters.front().value, 4) + " " +
                kind.parameters.front().unit;
    report.addLead(lead + ".");
    report.addText(kind.statement);
    if (data.qualitative) report.addText("Qualitative: other connections act on the same body.");
    const Table parameters = tabulateParameters(kind.parameters);
    report.addTable(parameters.header(), parameters.rows());
    report.addPlot(
        {"Force over displacement", "displacement [mm]", "force [N]", {{"force", displacement, force}}, true});
    const SurfaceSlice stiffness = sliceStiffness(data, cells), damping = sliceDamping(data, cells);
    report.addPlot({"Stiffness curve: slow samples",
                    "displacement [mm]",
                    "median force [N]",
                    {{"median", scale(stiffness.at, 1e3), stiffness.force}}});
    if (data.has_velocity) {
        report.addPlot(
            {"Force over velocity", "velocity [m/s]", "force [N]", {{"force", scale(data.velocity, 1), force}}, true});
        report.addPlot({"Damping curve: samples near rest position",
                        "velocity [m/s]",
                        "median force [N]",
                        {{"median", damping.at, damping.force}}});
        ForceSurface surface = makeEmptySurface("Restoring force surface: medians over displacement and velocity");
        addSheet(surface, "median force", data, false, 0);
        report.addSurface(surface);
    }
    report.addPlot({"Force over travel since the last reversal",
                    "travel [mm]",
                    "force [N]",
                    {{"force", scale(calcTravel(data.q, 0.05), 1e3), force}},
                    true});
    for (const auto& note : data.notes) report.addText(note);
    report.write(file, outputs);
}

namespace {

constexpr int kCurveCells = 80, kFewestInCell = 3;  // of a curve; samples in a cell
constexpr double kShownPeriods = 1.5;               // to both sides of the largest motion
constexpr double kShownTime = 0.1;                  // s, likewise, where the drive is no sine
constexpr int kCloudBefore = 9, kCloudAfter = 7;

enum Term : std::size_t { displacement, velocity, law_before, law_after, measured_before, measured_after, terms };

/// Histories of all axes over one run (rows 3 i + axis; m, m/s, N), without the ends, where the smoothing says nothing.
struct Histories {
    double interval = 0;
    Eigen::VectorXd swept;  // Hz; empty if not known
    std::array<Eigen::MatrixXd, terms> of;
};

Eigen::Matrix<double, 6, 6> calcWeight(const RunMotion& motion, const MountModel& model) {
    const PartMotion& part = motion.mobile;
    const Eigen::Matrix<double, 6, 6> M = calcMassMatrix(model.body), C = part.displacement_measured
                                                                              ? part.displacement_covariance
                                                                              : part.acceleration_covariance;
    return (M * C * M.transpose()).completeOrthogonalDecomposition().pseudoInverse();
}

/// The forces of a model's laws, and the measured ones.
void calcForces(const OpenLoopRun& run, const MountModel& model, const Eigen::Matrix<double, 6, 6>& weight,
                Eigen::MatrixXd& law, Eigen::MatrixXd& measured) {
    law.resize(run.q.rows(), run.sampleCount());
    measured.resize(run.q.rows(), run.sampleCount());
    const Eigen::MatrixXd residual = calcMountResidual(run, model);
    for (int row = 0; row < run.q.rows(); ++row) {
        const int connection = row / 3, axis = row % 3;
        const Connection& place = model.connections[connection];
        const auto direction = calcAxisDirection(model, connection, axis);
        const Eigen::Matrix<double, 6, 1> weighted = weight * direction;
        const Eigen::RowVectorXd pick = weighted.transpose() / direction.dot(weighted);
        law.row(row) = calcAxisForce(run, place.axis[axis], connection, axis).transpose();
        measured.row(row) = law.row(row) - pick * residual;
    }
}

Histories calcHistories(const MovedRun& run, const MountModel& before, const MountModel& after) {
    const OpenLoopRun open =
        makeOpenLoopRun(*run.motion, after, {run.swept.lowest, run.swept.highest}, run.swept.hertz);
    Histories result;
    result.interval = open.interval;
    result.of[displacement] = open.q;
    result.of[velocity] = open.v;
    calcForces(open, before, calcWeight(*run.motion, before), result.of[law_before], result.of[measured_before]);
    calcForces(open, after, calcWeight(*run.motion, after), result.of[law_after], result.of[measured_after]);
    Eigen::Index first = 0, last = open.taper.size();
    while (first < last && open.taper[first] < 1) ++first;
    while (first < last && open.taper[last - 1] < 1) --last;
    for (Eigen::MatrixXd& rows : result.of) rows = rows.middleCols(first, last - first).eval();
    if (open.swept.size() > 0) result.swept = open.swept.segment(first, last - first);
    return result;
}

std::vector<double> scaled(const Eigen::VectorXd& values, double factor) {
    std::vector<double> result(values.begin(), values.end());
    for (double& value : result) value *= factor;
    return result;
}

/// One axis over all runs.
Eigen::VectorXd joinRows(const std::vector<Histories>& runs, const AxisPlace& place, Term term) {
    Eigen::Index count = 0, at = 0;
    for (const Histories& run : runs) count += run.of[term].cols();
    Eigen::VectorXd all(count);
    for (const Histories& run : runs) {
        const Eigen::Index own = run.of[term].cols();
        all.segment(at, own) = run.of[term].row(place.row()).transpose();
        at += own;
    }
    return all;
}

/// A force over displacement at zero velocity: in each cell of displacement the plane through its samples over
/// displacement and velocity, at the middle of the cell.
Series makeCurve(const std::string& name, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                 const Eigen::VectorXd& force, int color) {
    Series series{name, {}, {}, false, color};
    const double low = q.minCoeff(), width = (q.maxCoeff() - low) / kCurveCells;
    const double fastest = std::max(v.cwiseAbs().maxCoeff(), std::numeric_limits<double>::min());
    std::vector<std::vector<Eigen::Index>> cells(kCurveCells);
    for (Eigen::Index k = 0; k < q.size() && width > 0; ++k)
        cells[std::clamp(static_cast<int>((q[k] - low) / width), 0, kCurveCells - 1)].push_back(k);
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const double middle = low + (static_cast<double>(c) + 0.5) * width;
        const Eigen::Index count = cells[c].size();
        if (count < kFewestInCell) continue;
        Eigen::MatrixX3d design(count, 3);
        Eigen::VectorXd right(count);
        for (Eigen::Index i = 0; i < count; ++i) {
            const Eigen::Index k = cells[c][i];
            design.row(i) << 1, (q[k] - middle) / width, v[k] / fastest;
            right[i] = force[k];
        }
        const Eigen::Matrix3d normal = design.transpose() * design;
        const Eigen::Vector3d plane = normal.completeOrthogonalDecomposition().solve(design.transpose() * right);
        series.x.push_back(1e3 * middle);
        series.y.push_back(plane[0]);
    }
    return series;
}

Plot plotCurve(const std::vector<Histories>& runs, const AxisPlace& place, const std::string& name) {
    const auto join = [&](Term term) { return joinRows(runs, place, term); };
    const Eigen::VectorXd q = join(displacement), v = join(velocity);
    const std::vector<double> shown = scaled(q, 1e3);
    return {"Restoring force at " + name,
            "relative displacement [mm]",
            "force [N]",
            {{"measured, before", shown, scaled(join(measured_before), 1), true, kCloudBefore},
             {"measured, after", shown, scaled(join(measured_after), 1), true, kCloudAfter},
             makeCurve("law before", q, v, join(law_before), kBeforeColor),
             makeCurve("law after", q, v, join(law_after), kAfterColor)}};
}

/// A few periods around the largest displacement of an axis, in the run that has it.
Plot plotLargestMotion(const std::vector<Histories>& runs, const AxisPlace& place, const std::string& name) {
    const Histories* run = runs.data();
    Eigen::Index middle = 0;
    double largest = -1;
    for (const Histories& candidate : runs) {
        Eigen::Index at = 0;
        const double peak = candidate.of[displacement].row(place.row()).cwiseAbs().maxCoeff(&at);
        if (!(peak > largest)) continue;
        largest = peak;
        run = &candidate;
        middle = at;
    }
    const double hertz = run->swept.size() > 0 ? run->swept[middle] : NAN;
    const double half = hertz > 0 ? kShownPeriods / hertz : kShownTime;
    const auto reach = static_cast<Eigen::Index>(half / run->interval);
    const Eigen::Index first = std::max<Eigen::Index>(0, middle - reach),
                       count = std::min(run->of[displacement].cols(), middle + reach + 1) - first;
    Plot plot{"Force at " + name + " around its largest motion", "time [ms]", "force [N]", {}, false};
    const Eigen::VectorXd time =
        1e3 * run->interval * Eigen::VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1));
    const auto add = [&](const char* series, Term term, int color) {
        const Eigen::VectorXd force = run->of[term].row(place.row()).segment(first, count).transpose();
        plot.series.push_back({series, scaled(time, 1), scaled(force, 1), false, color});
    };
    add("measured", measured_after, kMeasuredColor);
    add("law before", law_before, kBeforeColor);
    add("law after", law_after, kAfterColor);
    return plot;
}

ForceSurface makeSurface(const std::vector<Histories>& runs, const AxisPlace& place, const std::string& name) {
    ForceSurface surface = makeEmptySurface("Restoring force surface at " + name);
    ComponentData data;
    data.q = joinRows(runs, place, displacement);
    data.velocity = joinRows(runs, place, velocity);
    const auto add = [&](const char* sheet, Term term, bool points, int color) {
        data.force = joinRows(runs, place, term);
        addSheet(surface, sheet, data, points, color);
    };
    add("measured", measured_after, true, kMeasuredColor);
    add("law before", law_before, false, kBeforeColor);
    add("law after", law_after, false, kAfterColor);
    return surface;
}

AxisPlace findLargestForce(const std::vector<Histories>& runs) {
    Eigen::VectorXd largest = Eigen::VectorXd::Zero(runs.front().of[law_after].rows());
    for (const Histories& run : runs) largest = largest.cwiseMax(run.of[law_after].cwiseAbs().rowwise().maxCoeff());
    Eigen::Index row = 0;
    largest.maxCoeff(&row);
    return {static_cast<std::size_t>(row / 3), static_cast<std::size_t>(row % 3)};
}

}  // namespace

void addRestoringForces(HtmlReport& page, const std::vector<MovedRun>& runs, const MountModel& before,
                        const MountModel& after, const std::string& after_is, const std::optional<AxisPlace>& named) {
    std::vector<Histories> histories;
    for (const MovedRun& run : runs) {
        histories.push_back(calcHistories(run, before, after));
        if (histories.back().of[displacement].cols() == 0) histories.pop_back();  // shorter than the smoothing reaches
    }
    if (histories.empty()) return;
    page.addHeading("Restoring forces of the connections");
    page.addText(
        "Points, measured: the force that the equations of motion demand of an axis along the measured motion if "
        "everything else follows the model, once with the model as given, once " +
        after_is +
        "; as the mobile part has six equations and its connections have more axes, what one axis lacks shows at the "
        "others too. Lines: the force of the axis' own law along the same motion, where the velocity is zero. Where "
        "the model is right, points lie on the line.");
    std::vector<Plot> plots;
    for (std::size_t i = 0; i < after.connections.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const AxisPlace place{i, axis};
            plots.push_back(plotCurve(histories, place, place.name(after)));
        }
    page.addPlots(plots);
    const AxisPlace shown = named ? *named : findLargestForce(histories);
    const std::string name = shown.name(after);
    page.addText(named ? "The diagnosis names " + name + ": its force in time, and over displacement and velocity."
                       : name + " carries the largest force: its force in time, and over displacement and velocity.");
    page.addPlot(plotLargestMotion(histories, shown, name));
    page.addSurface(makeSurface(histories, shown, name));
}

}  // namespace wems::identify::commands
