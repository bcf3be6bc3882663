#include "identify/fit/output_error_search.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "models/common/error.hpp"

namespace wems::identify {

namespace {

/// The step of H x = −g whose members do not fall further than they may: those that would stay where their room ends,
/// and the others follow.
Eigen::VectorXd solveWithin(const Eigen::MatrixXd& H, const Eigen::VectorXd& g, const Eigen::VectorXd& room) {
    std::vector<Eigen::Index> free(g.size()), held;
    std::iota(free.begin(), free.end(), 0);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(g.size());
    while (!free.empty()) {
        Eigen::VectorXd right = -g(free);
        if (!held.empty()) right -= H(free, held) * x(held);
        const Eigen::MatrixXd part = H(free, free);
        const Eigen::VectorXd solved = part.ldlt().solve(right);
        x(free) = solved;
        const auto stays = [&](Eigen::Index j) { return x[j] >= -room[j]; };
        const auto first = std::stable_partition(free.begin(), free.end(), stays);
        if (first == free.end()) break;
        for (auto j = first; j != free.end(); ++j) {
            x[*j] = -room[*j];
            held.push_back(*j);
        }
        free.erase(first, free.end());
    }
    return x;
}

}  // namespace

OutputErrorSearch::OutputErrorSearch(TrajectoryProblem& problem, TrajectoryPoint start, std::vector<double> weights,
                                     std::function<void(double error)> report)
    : problem_(problem), report_(std::move(report)), point_(std::move(start)), weights_(std::move(weights)) {
    for (std::size_t p = 0; p < problem.pieces().size(); ++p) residuals_.push_back(calcSquares(p, point_));
}

void OutputErrorSearch::run(int most) {
    settled_ = false;
    for (int step = 0; step < most && !settled_; ++step) {
        if (report_) report_(calcError());
        if (!advance(linearise())) return;
    }
}

OutputErrorSearch::Normal OutputErrorSearch::linearise() {
    const Eigen::Index size = problem_.layout().size();
    Normal normal{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
    for (std::size_t p = 0; p < problem_.pieces().size(); ++p) {
        const TrajectoryTangent tangent = problem_.linearise(p, point_);
        normal.information(tangent.unknowns, tangent.unknowns) +=
            weightOf(p) * tangent.jacobian.transpose() * tangent.jacobian;
        normal.gradient(tangent.unknowns) += weightOf(p) * tangent.jacobian.transpose() * tangent.residual;
    }
    return normal;
}

double OutputErrorSearch::countValues() const {
    double values = 0;
    for (std::size_t p = 0; p < residuals_.size(); ++p) values += static_cast<double>(problem_.residualCount(p));
    return values;
}

double OutputErrorSearch::calcError() const {
    double left = 0, moved = 0;
    for (std::size_t p = 0; p < residuals_.size(); ++p) {
        left += residuals_[p];
        moved += problem_.measuredSquares(p);
    }
    return moved > 0 ? std::sqrt(left / moved) : 0;
}

std::vector<double> OutputErrorSearch::weighByResidual() const {
    std::vector<double> left(weights_.size(), 0.0), values = left, weights = weights_;
    for (std::size_t p = 0; p < residuals_.size(); ++p) {
        left[problem_.pieces()[p].run] += residuals_[p];
        values[problem_.pieces()[p].run] += static_cast<double>(problem_.residualCount(p));
    }
    for (std::size_t r = 0; r < weights.size(); ++r)
        if (values[r] > 0) weights[r] = 1 / std::max(left[r] / values[r], 1e-12 * problem_.runs().meanSquare(r));
    return weights;
}

double OutputErrorSearch::calcSquares(std::size_t piece, const TrajectoryPoint& point) const {
    return problem_.calcResidual(piece, point).squaredNorm();
}

double OutputErrorSearch::calcCost(const std::vector<double>& residuals) const {
    double cost = 0;
    for (std::size_t p = 0; p < residuals.size(); ++p) cost += weightOf(p) * residuals[p];
    return cost;
}

bool OutputErrorSearch::advance(const Normal& normal) {
    constexpr double least_damping = 1e-9, most_damping = 1e6, fewer = 0.1, more = 4;
    constexpr double small_step = 1e-4;  // squared, in standard errors: the values are settled
    const double cost = calcCost();
    // Nothing moves along an unknown without effect.
    const Eigen::VectorXd diagonal =
        normal.information.diagonal().cwiseMax(1e-12 * std::max(normal.information.diagonal().maxCoeff(), 1e-300));
    const Eigen::VectorXd room = problem_.calcRoom(point_);
    for (; damping_ < most_damping; damping_ *= more) {
        Eigen::MatrixXd damped = normal.information;
        damped.diagonal() += damping_ * diagonal;
        const Eigen::VectorXd change = solveWithin(damped, normal.gradient, room);
        const double size = change.dot(normal.information * change) * countValues() / std::max(cost, 1e-300);
        auto candidate = tryStep(change);
        if (!candidate || !(calcCost(candidate->residuals) < cost)) {
            if (size < small_step) {
                settled_ = true;
                return false;
            }
            continue;
        }
        point_ = std::move(candidate->point);
        residuals_ = std::move(candidate->residuals);
        settled_ = size < small_step;
        damping_ = std::max(least_damping, fewer * damping_);
        return true;
    }
    return false;
}

std::optional<OutputErrorSearch::Candidate> OutputErrorSearch::tryStep(const Eigen::VectorXd& change) const {
    try {
        Candidate candidate{problem_.move(point_, change), {}};
        for (std::size_t p = 0; p < problem_.pieces().size(); ++p)
            candidate.residuals.push_back(calcSquares(p, candidate.point));
        return candidate;
    } catch (const InputError&) {  // no such model
    } catch (const SimulationDiverged&) {
    }
    return std::nullopt;
}

namespace {

constexpr int kMostSteps = 60;    // of a search
constexpr double kPeriods = 20;   // of a piece
constexpr int kMostStarts = 600;  // unknowns of pieces' starts, so that a step's equations are solved within a second
constexpr double kMostRefinement = 16;  // of fourth order: what the usual steps leave is 65 000 times less

class OutputErrorSolver {
public:
    OutputErrorSolver(const std::vector<RunMotion>& motions, const MountModel& model,
                      const std::vector<std::string>& names, const std::function<void(int, double)>& report)
        : motions_(motions), believed_(model), names_(names), report_(report) {}

    OutputErrorSolution solve() {
        auto runs = std::make_unique<TrajectoryRuns>(motions_, believed_, 1);
        for (std::size_t r = 0; r < motions_.size(); ++r) weights_.push_back(1 / std::max(runs->meanSquare(r), 1e-300));
        OutputErrorSolution solution = approach(std::move(runs));
        solution.search->run(kMostSteps);
        if (motions_.size() > 1) {
            weights_ = solution.search->weighByResidual();
            solution.search = makeSearch(*solution.problem, solution.search->point());
            solution.search->run(kMostSteps);
        }
        for (const std::size_t run : solution.runs->listQuietStarts()) tryRest(run, solution);
        const int refinement = chooseRefinement(solution);
        if (refinement > solution.runs->refinement()) {
            OutputErrorSolution finer;
            finer.runs = makeRuns(refinement, *solution.runs);
            finer.problem = makeProblem(*finer.runs, solution.problem->pieces());
            finer.search =
                makeSearch(*finer.problem, finer.problem->adopt(*solution.problem, solution.search->point()));
            solution = std::move(finer);
            solution.search->run(kMostSteps);
        }
        return solution;
    }

private:
    std::unique_ptr<TrajectoryProblem> makeProblem(const TrajectoryRuns& runs,
                                                   std::vector<TrajectoryPiece> pieces) const {
        return std::make_unique<TrajectoryProblem>(runs, std::move(pieces), believed_, names_);
    }
    std::unique_ptr<TrajectoryRuns> makeRuns(int refinement, const TrajectoryRuns& like) const {
        auto runs = std::make_unique<TrajectoryRuns>(motions_, believed_, refinement);
        for (std::size_t r = 0; r < runs->size(); ++r) runs->setAtRest(r, like.beginsAtRest(r));
        return runs;
    }
    std::unique_ptr<OutputErrorSearch> makeSearch(TrajectoryProblem& problem, TrajectoryPoint point) {
        return std::make_unique<OutputErrorSearch>(problem, std::move(point), weights_, [this](double error) {
            if (report_) report_(++steps_, error);
        });
    }

    /// From short pieces to those of the fit.
    OutputErrorSolution approach(std::unique_ptr<TrajectoryRuns> runs) {
        constexpr double first_periods[] = {2, 6};
        constexpr int few_steps = 15;
        OutputErrorSolution solution;
        solution.runs = std::move(runs);
        const auto coordinates =
            static_cast<int>(2 * std::count(believed_.body.free.begin(), believed_.body.free.end(), true));
        std::vector<TrajectoryPiece> pieces = solution.runs->cut(kPeriods, kMostStarts / coordinates);
        const bool whole = pieces.empty();
        if (whole) pieces = solution.runs->keepWhole();
        solution.problem = makeProblem(*solution.runs, std::move(pieces));
        TrajectoryPoint point = solution.problem->start();
        if (!whole)
            for (const double periods : first_periods) {
                const auto begun =
                    makeProblem(*solution.runs, solution.runs->shorten(solution.problem->pieces(), periods));
                const auto search = makeSearch(*begun, begun->adopt(*solution.problem, point));
                search->run(few_steps);
                point = solution.problem->adopt(*begun, search->point());
            }
        solution.search = makeSearch(*solution.problem, std::move(point));
        return solution;
    }

    /// A start at rest instead of one that is sought, if the criterion of Schwarz (1978, doi:10.1214/aos/1176344136)
    /// has it so: rest tells zeros from each other, where the run does begin at rest.
    void tryRest(std::size_t run, OutputErrorSolution& solution) {
        const double free_cost = solution.search->calcCost();
        const Eigen::Index free_size = solution.problem->layout().size();
        OutputErrorSolution rest;
        rest.runs = makeRuns(solution.runs->refinement(), *solution.runs);
        rest.runs->setAtRest(run, true);
        rest.problem = makeProblem(*rest.runs, solution.problem->pieces());
        rest.search = makeSearch(*rest.problem, rest.problem->adopt(*solution.problem, solution.search->point()));
        rest.search->run(kMostSteps);
        const double values = solution.search->countValues();
        const auto unknowns = static_cast<double>(free_size - rest.problem->layout().size());
        // Of noise of unknown size: n log(cost) has the place of chi-squared.
        if (values * std::log(rest.search->calcCost() / free_cost) < unknowns * std::log(values))
            solution = std::move(rest);
    }

    /// Steps with which what they leave moves the values by less than a tenth of their standard errors, as half the
    /// steps' length tells: of what the steps now leave, that leaves a sixteenth.
    int chooseRefinement(const OutputErrorSolution& solution) const {
        constexpr double small_shift = 0.1, order = 4;
        const auto finer = makeRuns(2 * solution.runs->refinement(), *solution.runs);
        const auto other = makeProblem(*finer, solution.problem->pieces());
        const TrajectoryPoint point = other->adopt(*solution.problem, solution.search->point());
        const Eigen::Index size = solution.problem->layout().size();
        Eigen::VectorXd push = Eigen::VectorXd::Zero(size);
        Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
        for (std::size_t p = 0; p < solution.problem->pieces().size(); ++p) {
            const TrajectoryTangent tangent = solution.problem->linearise(p, solution.search->point());
            const double weight = weights_[solution.problem->pieces()[p].run];
            push(tangent.unknowns) +=
                weight * tangent.jacobian.transpose() * (other->calcResidual(p, point) - tangent.residual);
            information(tangent.unknowns, tangent.unknowns) += weight * tangent.jacobian.transpose() * tangent.jacobian;
        }
        // An unknown without effect is not moved either.
        information.diagonal().array() += 1e-12 * information.diagonal().maxCoeff();
        const double variance = std::max(solution.search->calcCost() / solution.search->countValues(), 1e-300);
        const double shift = std::sqrt(std::max(0.0, push.dot(information.ldlt().solve(push))) / variance);
        const double factor = std::ceil(std::pow(shift * 16 / 15 / small_shift, 1 / order));
        return solution.runs->refinement() * static_cast<int>(std::clamp(factor, 1.0, kMostRefinement));
    }

    const std::vector<RunMotion>& motions_;
    const MountModel& believed_;
    const std::vector<std::string>& names_;
    const std::function<void(int, double)>& report_;
    std::vector<double> weights_;
    int steps_ = 0;
};

}  // namespace

OutputErrorSolution solveOutputError(const std::vector<RunMotion>& motions, const MountModel& model,
                                     const std::vector<std::string>& names,
                                     const std::function<void(int step, double error)>& report) {
    return OutputErrorSolver(motions, model, names, report).solve();
}

}  // namespace wems::identify
