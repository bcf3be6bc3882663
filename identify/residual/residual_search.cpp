#include "identify/residual/residual_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identify/motion/parallel.hpp"
#include "identify/verdict/free_error.hpp"

namespace wems::identify {
namespace {

constexpr std::size_t kMostCauses = 5;  // of one answer: more describe, they do not explain
constexpr std::size_t kTried = 6;       // statements of a round that are fitted
constexpr std::size_t kShown = 8;       // candidates of a round that its record keeps

std::string describe(const Hypothesis& hypothesis) {
    std::string text = hypothesis.cause;
    for (const auto& place : hypothesis.where) text += " " + place;
    return text;
}

class Searcher {
public:
    Searcher(const ResidualProblem& problem, const ProgressListener& progress)
        : problem_(problem), progress_(progress) {}

    ResidualAnswer run() {
        // How many values are independent follows from what a fit leaves, the fit from how many they are.
        best_ = problem_.fit({}, 1, problem_.believedValues());
        for (int pass = 0; pass < 2; ++pass)
            best_ = problem_.fit({}, ResidualProblem::countSamples(best_.residual), best_.values);
        answer_.adjusted = best_;
        for (int round = 0; best_.set.size() < kMostCauses; ++round)
            if (!add(round)) break;
        exchange();
        dropWorthless();
        rankAlternatives();
        answer_.best = best_;
        return std::move(answer_);
    }

private:
    const Hypothesis& at(int h) const { return problem_.hypotheses()[h]; }
    double judge(const ResidualFit& fit) const { return problem_.calcErrors(fit.values).validation; }
    void tell(const std::string& text) const {
        if (progress_) progress_({text});
    }

    /// Numbers beyond their tolerance, mechanisms with the sign that they can have.
    bool isPossible(const ResidualFit& fit, int h) const {
        bool toleranced = false, beyond = false;
        for (const int index : at(h).reported) {
            const Unknown& row = problem_.table()[index];
            const double value = fit.values[index];
            if (row.deviation > 0) {
                toleranced = true;
                beyond = beyond || std::abs(value - row.believed) > 2 * row.deviation;
            } else if (value <= row.least && row.believed == row.least) {
                return false;
            }
        }
        return !toleranced || beyond;
    }

    bool mayJoin(const HypothesisSet& set, int h) const {
        return std::none_of(set.begin(), set.end(), [&](int member) {
            return member == h || describe(at(member)) == describe(at(h)) || sharesRow(at(member), at(h));
        });
    }
    static bool sharesRow(const Hypothesis& a, const Hypothesis& b) {
        return std::any_of(a.reported.begin(), a.reported.end(), [&](int row) {
            return std::find(b.reported.begin(), b.reported.end(), row) != b.reported.end();
        });
    }

    /// Of all statements that may join a fit the likeliest by first order, each where it is sought best.
    std::vector<int> chooseLikely(const ResidualFit& from) const {
        std::vector<std::pair<double, int>> gains(problem_.hypotheses().size());
        runParallel(gains.size(), [&](std::size_t i) {
            const int h = static_cast<int>(i);
            gains[i] = {mayJoin(from.set, h) ? problem_.predictGain(from, h) : -1e300, h};
        });
        std::sort(gains.begin(), gains.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        std::vector<int> chosen;
        for (const auto& [gain, h] : gains) {
            if (chosen.size() == kTried || gain <= -1e299) break;
            const bool known = std::any_of(chosen.begin(), chosen.end(),
                                           [&, h = h](int other) { return describe(at(other)) == describe(at(h)); });
            if (!known) chosen.push_back(h);
        }
        return chosen;
    }

    /// The likeliest sets that take one more of the hypotheses, fitted; those that are no answer are left out.
    std::vector<ResidualFit> tryAll(const HypothesisSet& others, const ResidualFit& from, double samples) const {
        Eigen::VectorXd start = from.values;
        // A member that is not there any more leaves no trace in where the others begin.
        for (const int h : from.set)
            if (!std::binary_search(others.begin(), others.end(), h))
                for (const int row : at(h).reported) start[row] = problem_.table()[row].believed;
        const bool same = others == from.set && samples == from.samples;
        const std::vector<int> joining = chooseLikely(same ? from : problem_.fit(others, samples, start));
        std::vector<ResidualFit> fits(joining.size());
        runParallel(joining.size(), [&](std::size_t i) {
            HypothesisSet set = others;
            set.insert(std::lower_bound(set.begin(), set.end(), joining[i]), joining[i]);
            fits[i] = problem_.fit(set, samples, start);
        });
        std::vector<ResidualFit> possible;
        for (std::size_t i = 0; i < fits.size(); ++i)
            if (std::all_of(fits[i].set.begin(), fits[i].set.end(), [&](int h) { return isPossible(fits[i], h); }))
                possible.push_back(std::move(fits[i]));
        std::sort(possible.begin(), possible.end(),
                  [](const ResidualFit& a, const ResidualFit& b) { return a.log_evidence > b.log_evidence; });
        return possible;
    }

    bool add(int round) {
        tell("round " + std::to_string(round + 1));
        std::vector<ResidualFit> fits = tryAll(best_.set, best_, best_.samples);
        // Independent samples are those of what the closest law leaves: the same for all that are compared.
        if (!fits.empty()) {
            const auto closest = std::min_element(fits.begin(), fits.end(), [](const auto& a, const auto& b) {
                return a.sum_of_squares < b.sum_of_squares;
            });
            const double samples = ResidualProblem::countSamples(closest->residual);
            if (closest->sum_of_squares < best_.sum_of_squares && std::abs(samples / best_.samples - 1) > 0.05) {
                best_ = problem_.fit(best_.set, samples, best_.values);
                fits = tryAll(best_.set, best_, samples);
            }
        }
        Decision decision;
        for (std::size_t i = 0; i < std::min(kShown, fits.size()); ++i)
            for (const int h : fits[i].set)
                if (!std::binary_search(best_.set.begin(), best_.set.end(), h))
                    decision.candidates.push_back(
                        {at(h).cause, at(h).where, fits[i].log_evidence - best_.log_evidence});
        const bool better = !fits.empty() && fits.front().log_evidence > best_.log_evidence;
        if (better) best_ = std::move(fits.front());
        decision.action = better ? "causes changed" : "nothing more to add";
        close(decision);
        return better;
    }

    /// Another cause in the place of a member, as long as one is better.
    void exchange() {
        for (bool changed = true; changed;) {
            changed = false;
            for (const int h : best_.set) {
                HypothesisSet others = best_.set;
                others.erase(std::find(others.begin(), others.end(), h));
                std::vector<ResidualFit> fits = tryAll(others, best_, best_.samples);
                ResidualFit without = problem_.fit(others, best_.samples, startWithout(h));
                if (without.log_evidence > best_.log_evidence)
                    best_ = std::move(without);
                else if (!fits.empty() && fits.front().log_evidence > best_.log_evidence + 1e-6)
                    best_ = std::move(fits.front());
                else
                    continue;
                changed = true;
                Decision decision;
                decision.action = "a cause exchanged or taken back";
                close(decision);
                break;
            }
        }
    }

    Eigen::VectorXd startWithout(int h) const {
        Eigen::VectorXd start = best_.values;
        for (const int row : at(h).reported) start[row] = problem_.table()[row].believed;
        return start;
    }

    void dropWorthless() {
        for (bool changed = true; changed;) {
            changed = false;
            const double error = judge(best_);
            for (const int h : best_.set) {
                const ResidualFit without = leaveOut(problem_, best_, h);
                if (judge(without) >= (1 + kWorth) * error) continue;
                HypothesisSet others = best_.set;
                others.erase(std::find(others.begin(), others.end(), h));
                best_ = problem_.fit(others, best_.samples, startWithout(h));
                Decision decision;
                decision.action = "the judging tests do not need " + describe(at(h));
                close(decision);
                changed = true;
                break;
            }
        }
    }

    void rankAlternatives() {
        answer_.ranked = {best_};
        for (const int h : best_.set) {
            HypothesisSet others = best_.set;
            others.erase(std::find(others.begin(), others.end(), h));
            answer_.ranked.push_back(problem_.fit(others, best_.samples, startWithout(h)));
            for (ResidualFit& fit : tryAll(others, best_, best_.samples))
                if (fit.set != best_.set) answer_.ranked.push_back(std::move(fit));
        }
    }

    void close(Decision& decision) {
        for (const int h : best_.set) decision.causes.push_back(describe(at(h)));
        decision.log_evidence = best_.log_evidence - answer_.adjusted.log_evidence;
        decision.error = judge(best_);
        const double error = problem_.calcErrors(best_.values).identification,
                     floor = problem_.calcNoiseFloor().identification;
        decision.misfit = {floor > 0 ? error * error / (floor * floor) : 1};
        answer_.decisions.push_back(std::move(decision));
    }

    const ResidualProblem& problem_;
    const ProgressListener& progress_;
    ResidualFit best_;
    ResidualAnswer answer_;
};

}  // namespace

ResidualFit leaveOut(const ResidualProblem& problem, const ResidualFit& fit, int member) {
    const Hypothesis& hypothesis = problem.hypotheses()[member];
    HypothesisSet others = fit.set;
    others.erase(std::find(others.begin(), others.end(), member));
    Eigen::VectorXd start = fit.values;
    std::vector<std::pair<int, double>> held;
    for (const int index : hypothesis.reported) {
        const Unknown& row = problem.table()[index];
        const double tolerance = 2 * row.deviation;
        start[index] = row.believed + std::clamp(fit.values[index] - row.believed, -tolerance, tolerance);
        if (tolerance > 0) held.emplace_back(index, start[index]);
    }
    return problem.fit(others, fit.samples, start, held);
}

ResidualAnswer searchCauses(const ResidualProblem& problem, const ProgressListener& progress) {
    return Searcher(problem, progress).run();
}

}  // namespace wems::identify
