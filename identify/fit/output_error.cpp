#include "identify/fit/output_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "identify/fit/open_groups.hpp"
#include "identify/fit/output_error_interval.hpp"
#include "identify/fit/output_error_search.hpp"
#include "identify/fit/trajectory_problem.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify {

namespace {

/// A number that is told, as a combination of the unknowns.
struct ToldNumber {
    Parameter parameter;
    Eigen::VectorXd combination;  // of unknown / scale, SI
    double scale = 1;
};

std::vector<ToldNumber> listNumbers(const TrajectoryProblem& problem, const std::vector<Parameter>& parameters,
                                    const MountModel& model, const std::vector<std::string>& channels) {
    const TrajectoryLayout& layout = problem.layout();
    const Eigen::VectorXd& scale = problem.scale();
    std::vector<ToldNumber> numbers;
    const auto unit = [&](Eigen::Index j) {
        return Eigen::VectorXd(scale[j] * Eigen::VectorXd::Unit(scale.size(), j));
    };
    for (std::size_t j = 0; j < parameters.size(); ++j) {
        const Eigen::Index row = j;
        numbers.push_back({parameters[j], unit(row), scale[row]});
    }
    const auto addZero = [&](const std::string& channel, const Eigen::VectorXd& combination, double size) {
        const std::string name = channel + ".zero";
        numbers.push_back({{ParameterKind::other, name, parameterUnit(name), -1, -1, -1}, combination, size});
    };
    for (std::size_t i = 0; i < model.connections.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            const std::string channel = "mobile." + model.connections[i].name + "." + "xyz"[axis];
            if (std::find(channels.begin(), channels.end(), channel) == channels.end()) continue;
            Eigen::VectorXd combination = Eigen::VectorXd::Zero(scale.size());
            for (std::size_t m = 0; m < layout.rest_motions.size(); ++m) {
                const Eigen::Index at = layout.restAt() + static_cast<Eigen::Index>(m), row = 3 * i + axis;
                combination += problem.rigidPattern()(row, layout.rest_motions[m]) * unit(at);
            }
            if (!combination.isZero(0)) addZero(channel, combination, scale[layout.restAt()]);
        }
    for (std::size_t a = 0; a < layout.load_axes.size(); ++a) {
        const Eigen::Index at = layout.loadAt() + static_cast<Eigen::Index>(a);
        addZero(std::string("load.f") + "xyz"[layout.load_axes[a]], unit(at), scale[at]);
    }
    return numbers;
}

OutputErrorUncertainty makeUncertainty(TrajectoryProblem& problem, const OutputErrorSearch& search) {
    OutputErrorUncertainty uncertainty(problem.layout().size());
    const std::size_t pieces = problem.pieces().size();
    for (std::size_t p = 0; p < pieces; ++p) {
        const std::size_t run = problem.pieces()[p].run;
        uncertainty.add(problem.linearise(p, search.point()), search.weights()[run], pieces);
    }
    uncertainty.solve();
    return uncertainty;
}

/// The pieces of a run, one after the other.
FittedTrajectory makeTrajectory(const TrajectoryProblem& problem, std::size_t run, const TrajectoryPoint& point) {
    const RelativeDisplacement& measured = problem.runs()[run].measured;
    FittedTrajectory trajectory{problem.runs().motion(run).file, {}, measured.names, {}, {}};
    Eigen::Index samples = 0, at = 0;
    for (const TrajectoryPiece& piece : problem.pieces()) samples += piece.run == run ? piece.count : 0;
    trajectory.measured.resize(measured.q.rows(), samples);
    trajectory.simulated.resize(measured.q.rows(), samples);
    for (std::size_t p = 0; p < problem.pieces().size(); ++p) {
        const TrajectoryPiece& piece = problem.pieces()[p];
        if (piece.run != run) continue;
        const auto first = measured.time.begin() + piece.first;
        trajectory.time.insert(trajectory.time.end(), first, first + piece.count);
        trajectory.measured.middleCols(at, piece.count) =
            measured.q.middleCols(piece.first, piece.count).colwise() - problem.calcRestReading(point);
        trajectory.simulated.middleCols(at, piece.count) = problem.simulate(p, point);
        at += piece.count;
    }
    return trajectory;
}

std::string describePieces(const TrajectoryProblem& problem) {
    const TrajectoryPiece& first = problem.pieces().front();
    long used = 0, all = 0;
    for (const TrajectoryPiece& piece : problem.pieces()) used += piece.count;
    for (std::size_t r = 0; r < problem.runs().size(); ++r) all += problem.runs()[r].drive.grid().samples;
    if (first.count == problem.runs()[first.run].drive.grid().samples)
        return "fitted to free simulations of whole runs";
    const double duration = first.count * problem.runs()[first.run].measured.interval();
    return "fitted to " + std::to_string(problem.pieces().size()) + " free simulations of " +
           formatNumber(duration, 3) + " s, which begin where the recording was; they hold " +
           formatNumber(100.0 * static_cast<double>(used) / static_cast<double>(all), 3) + " % of the samples";
}

/// Noise of what drives comes back as motion at the resonances, where runs of few resonance widths show one draw of it.
bool drivesByNoise(const TrajectoryRuns& runs) {
    for (std::size_t r = 0; r < runs.size(); ++r)
        if (runs[r].drive.prescribesMotion() && !runs.motion(r).fixed.p.isZero(0)) return true;
    return false;
}

double calcOverNoise(const std::vector<RunMotion>& runs, double error, const TrajectoryProblem& problem) {
    double noise = 0, moved = 0;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const double mobile = runs[r].mobile.displacement_noise, fixed = runs[r].fixed.displacement_noise;
        if (!(mobile > 0)) return std::numeric_limits<double>::infinity();
        const auto size = static_cast<double>(problem.runs()[r].measured.q.size());
        noise += size * (mobile * mobile + (fixed > 0 ? fixed * fixed : 0));
        moved += size * problem.runs().meanSquare(r);
    }
    return error * std::sqrt(moved / noise);
}

}  // namespace

FitResult fitBySimulation(const std::vector<RunMotion>& runs, const MountModel& model, const FitOptions& options,
                          const std::vector<std::string>& channels,
                          const std::function<void(int step, double error)>& report) {
    if (runs.empty()) throw InputError({}, "no run to fit");
    FitResult result;
    result.by_simulation = true;
    Stopwatch watch(result.timing);
    const std::vector<Parameter> parameters = makeAnyParameters(model, options.free_body);
    std::vector<std::string> names;
    for (const Parameter& parameter : parameters) names.push_back(parameter.name);
    OutputErrorSolution solution;
    std::optional<OutputErrorUncertainty> known;
    try {
        solution = solveOutputError(runs, model, names, report);
        watch.lap("simulations");
        known = makeUncertainty(*solution.problem, *solution.search);
        watch.lap("intervals");
    } catch (const SimulationDiverged& why) {
        throw InputError({}, std::string("the model cannot be followed along the runs: ") + why.what(),
                         "a model that is nearer to the device, or a fit to the equations of motion (--method motion)");
    }
    const TrajectoryProblem& problem = *solution.problem;
    const OutputErrorSearch& search = *solution.search;
    const OutputErrorUncertainty& uncertainty = *known;

    const std::vector<ToldNumber> numbers = listNumbers(problem, parameters, model, channels);
    std::vector<Parameter> told;
    Eigen::VectorXd scale(numbers.size());
    Eigen::MatrixXd combinations(problem.layout().size(), numbers.size());  // number / its scale, of unknown / scale
    for (std::size_t j = 0; j < numbers.size(); ++j) {
        const Eigen::Index column = j;
        told.push_back(numbers[j].parameter);
        scale[column] = numbers[j].scale;
        combinations.col(column) = numbers[j].combination / numbers[j].scale;
    }
    MountModel fitted = search.point().model;
    const Eigen::VectorXd change = problem.collectOthers(search.point());
    for (std::size_t j = parameters.size(); j < numbers.size(); ++j) {
        const Eigen::Index column = j;
        const double before = getParameter(model, told[j].name);
        setParameter(fitted, told[j].name, before + scale[column] * combinations.col(column).dot(change));
    }
    const Eigen::MatrixXd covariance = combinations.transpose() * uncertainty.makeCovariance() * combinations;
    const auto calcHalfWidth = [&](const Eigen::VectorXd& a) { return uncertainty.calcHalfWidth(combinations * a); };
    const Identifiability identifiability = findIdentifiable(fitted, told, scale, covariance, calcHalfWidth);
    result.estimate = {{}, Eigen::VectorXd(scale.size()), scale.asDiagonal() * covariance * scale.asDiagonal()};
    result.directions =
        findDirections(told, combinations.transpose() * uncertainty.information() * combinations, covariance);
    result.model = model;
    for (std::size_t j = 0; j < told.size(); ++j) {
        const Eigen::Index column = j;
        const double value = getParameter(fitted, told[j].name);
        result.estimate.names.push_back(told[j].name);
        result.estimate.values[column] = value;
        if (!identifiability.known[j]) continue;
        const Eigen::VectorXd a = scale[column] * Eigen::VectorXd::Unit(scale.size(), column);
        result.parameters.push_back({told[j].name, told[j].unit, getParameter(model, told[j].name), value,
                                     uncertainty.calcStandardError(combinations * a),
                                     makeInterval(value, calcHalfWidth(a))});
        setParameter(result.model, told[j].name, value);
    }
    addOpenGroups({told, scale, model, fitted, 0, calcHalfWidth}, identifiability, result);
    // Zeros that are not known one by one are still known together, with each other or with an asymmetry of the law.
    for (std::size_t j = parameters.size(); j < told.size(); ++j)
        setParameter(result.model, told[j].name, getParameter(fitted, told[j].name));
    result.residual_fraction = search.calcError();
    result.residual_over_noise = calcOverNoise(runs, result.residual_fraction, problem);
    for (std::size_t r = 0; r < runs.size(); ++r)
        result.trajectories.push_back(makeTrajectory(problem, r, search.point()));
    result.notes.push_back(describePieces(problem));
    if (drivesByNoise(problem.runs()))
        result.notes.emplace_back(
            "the recorded displacements of the fixed part drive the simulations, their noise too: where runs are short "
            "the intervals know too little of it");
    if (!search.settled())
        result.notes.emplace_back(
            "the values had not settled when the search ended: the model that it started from may be too far off");
    watch.lap("what is not known");
    return result;
}

}  // namespace wems::identify
