#include "identify/plan/plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>

#include "identify/forward/forward_model.hpp"
#include "identify/motion/parallel.hpp"
#include "identify/plan/possible_devices.hpp"
#include "models/common/error.hpp"
#include "models/common/format_number.hpp"
#include "models/mount_model.hpp"

namespace wems::identify {
namespace {

constexpr int kLevelDigits = 3;             // of a level
constexpr double kLadder = 0.70710678;      // from one level to the next lower one
constexpr int kMostSteps = 10;              // down the ladder: to 1/32
constexpr std::size_t kRefined = 2;         // candidates that variants are made of
constexpr std::size_t kVariantsOfEach = 3;  // level, direction and rate of the sweep
/// Devices that a promise is tried with, beside the fitted one. What holds with n of n holds with the next one with a
/// probability of (n + 1) / (n + 2) (Laplace's rule of succession): 91 %.
constexpr int kDevices = 8;
constexpr unsigned kDeviceSeed = 3;
constexpr int kMostConfirmed = 8;        // proposals that are tried so
constexpr double kNotable = 2;           // residual over noise from which on the model lacks something
constexpr double kLeastFraction = 5e-3;  // of the wrench that is unexplained: below, a residual does not matter

/// Directions in which the device can be driven: each axis, each pair of axes alike, all three.
std::vector<Eigen::Vector3d> listDirections(const MountModel& model) {
    const auto& free = model.body.free;
    const bool turns = free[3] || free[4] || free[5];
    std::vector<Eigen::Vector3d> directions;
    for (const unsigned axes : {1U, 2U, 4U, 3U, 5U, 6U, 7U}) {
        Eigen::Vector3d direction = Eigen::Vector3d::Zero();
        bool moves = true;
        for (unsigned axis = 0; axis < 3; ++axis) {
            if ((axes >> axis & 1U) == 0) continue;
            direction[axis] = 1;
            moves = moves && (free[axis] || turns);
        }
        if (moves) directions.push_back(direction.normalized());
    }
    return directions;
}

class Planner {
public:
    Planner(const std::vector<RunMotion>& runs, const MountModel& model, const PlanOptions& options, Plan& plan)
        : runs_(runs), model_(model), options_(options), plan_(plan), rehearsal_(plan.setup, makeDevice()) {
        const PossibleDevices devices(plan.now, model);
        std::mt19937_64 random(kDeviceSeed);
        for (int k = 0; k < kDevices; ++k) possible_.emplace_back(plan.setup, devices.draw(random));
    }

    void run() {
        const std::vector<PlannedRun> candidates = listCandidates();
        const std::size_t first = candidates.size(), all = first + kRefined * kVariantsOfEach + 1 + kMostConfirmed;
        for (const PlannedRun& candidate : candidates) {
            tell(all);
            rehearse(limit(candidate));
        }
        order();
        const std::vector<Proposal> best(
            plan_.proposals.begin(),
            plan_.proposals.begin() + std::min<std::ptrdiff_t>(kRefined, plan_.proposals.size()));
        for (std::size_t b = 0; b < best.size(); ++b)
            for (const PlannedRun& variant : listVariants(best[b].candidate, b == 0)) {
                tell(all);
                rehearse(limit(variant));
            }
        confirmBest(all);
        finish();
    }

private:
    MountModel makeDevice() const {
        MountModel device = plan_.now.model;
        for (std::string& note : makeAdmissible(model_, device)) plan_.notes.push_back("for the simulation, " + note);
        return device;
    }

    std::vector<PlannedRun> listCandidates() const {
        const TestSetup& setup = plan_.setup;
        std::vector<PlannedRun> candidates;
        for (const Excitation excitation : {Excitation::load, Excitation::base}) {
            const double level = excitation == Excitation::load ? setup.limits.force : setup.limits.acceleration;
            if (!(level > 0)) continue;
            for (const Eigen::Vector3d& direction : listDirections(model_)) {
                PlannedRun candidate;
                candidate.excitation = excitation;
                candidate.level = level * direction;
                candidate.from = setup.from;
                candidate.to = setup.to;
                candidate.octaves_per_minute = setup.octaves_per_minute;
                candidate.sample_rate = setup.sample_rate;
                candidate.sensors = setup.kinds();
                candidates.push_back(candidate);
            }
        }
        return candidates;
    }

    /// The same at half the level, downwards, and at half the rate; the best one also with the kind of sensors that it
    /// lacks.
    std::vector<PlannedRun> listVariants(const PlannedRun& candidate, bool with_sensors) const {
        std::vector<PlannedRun> variants(kVariantsOfEach, candidate);
        variants[0].level *= 0.5;
        std::swap(variants[1].from, variants[1].to);
        variants[2].octaves_per_minute *= 0.5;
        if (options_.asked.octaves_per_minute) variants.pop_back();
        if (with_sensors && !(candidate.sensors.displacement && candidate.sensors.acceleration)) {
            variants.push_back(candidate);
            variants.back().sensors = {true, true};
        }
        return variants;
    }

    /// The candidate at the largest level that keeps the limits, with its extent; nothing if none does.
    std::optional<Proposal> limit(PlannedRun candidate) const {
        const PlanLimits& limits = plan_.setup.limits;
        const Eigen::Vector3d direction = candidate.level.normalized();
        const double asked = candidate.level.norm();
        for (int step = 0; step < kMostSteps; ++step) {
            for (int axis = 0; axis < 3; ++axis)
                candidate.level[axis] = direction[axis] > 0
                                            ? roundDown(asked * std::pow(kLadder, step) * direction[axis], kLevelDigits)
                                            : 0;
            try {
                RunExtent extent = rehearsal_.calcExtent(candidate);
                const bool carries = limits.displacement <= 0 || extent.base_displacement <= limits.displacement;
                if (carries && extent.stroke <= limits.stroke) return Proposal{candidate, std::move(extent), {}};
            } catch (const SimulationDiverged&) {
                continue;  // beyond all limits, too
            }
        }
        return std::nullopt;
    }

    void rehearse(std::optional<Proposal> proposal) {
        if (!proposal) {
            ++refused_;
            return;
        }
        proposal->gain = calcGainWith(rehearsal_, proposal->candidate);
        ++plan_.rehearsed;
        plan_.proposals.push_back(std::move(*proposal));
    }

    Gain calcGainWith(const Rehearsal& rehearsal, const PlannedRun& candidate) const {
        std::vector<RunMotion> runs = runs_;
        runs.push_back(rehearsal.measure(candidate));
        return calcGain(plan_.now, fitMount(runs, model_, options_.fit));
    }

    /// Whichever leads with every possible device, until one has kept its place.
    void confirmBest(std::size_t all) {
        order();
        for (int tried = 0; tried < kMostConfirmed; ++tried) {
            if (plan_.proposals.empty() || plan_.proposals.front().confirmed) return;
            tell(all);
            confirm(plan_.proposals.front());
            order();
        }
        std::stable_partition(plan_.proposals.begin(), plan_.proposals.end(),
                              [](const Proposal& proposal) { return proposal.confirmed; });
    }

    void confirm(Proposal& proposal) const {
        std::vector<Gain> gains(possible_.size());
        runParallel(possible_.size(), [&](std::size_t k) {
            try {
                gains[k] = calcGainWith(possible_[k], proposal.candidate);
            } catch (const SimulationDiverged&) {
                gains[k] = {};  // nothing is told with it
            }
        });
        gains.insert(gains.begin(), proposal.gain);
        proposal.gain = findCommonGain(gains);
        proposal.confirmed = true;
    }

    void tell(std::size_t all) {
        if (options_.progress)
            options_.progress({"rehearsal of run " + std::to_string(told_ + 1),
                               std::min(1.0, static_cast<double>(told_) / static_cast<double>(all))});
        ++told_;
    }

    /// Further sensors are proposed first only for what the present ones do not tell, not for narrower intervals.
    void order() {
        const auto addsSensors = [&](const Proposal& proposal) {
            const SensorKinds known = plan_.setup.kinds(), used = proposal.candidate.sensors;
            return used.displacement != known.displacement || used.acceleration != known.acceleration;
        };
        std::stable_sort(plan_.proposals.begin(), plan_.proposals.end(), [&](const Proposal& a, const Proposal& b) {
            if (a.gain.tellsAsMuchAs(b.gain) && addsSensors(a) != addsSensors(b)) return addsSensors(b);
            return a.gain.isBetterThan(b.gain);
        });
    }

    void finish() {
        auto& proposals = plan_.proposals;
        proposals.erase(std::remove_if(proposals.begin(), proposals.end(),
                                       [](const Proposal& proposal) { return !proposal.gain.isWorthwhile(); }),
                        proposals.end());
        findTogether();
        keepFirst();
        findUnreached();
        if (refused_ > 0)
            plan_.notes.push_back(std::to_string(refused_) +
                                  " runs keep the limits at no level that is worth a test and are left out");
    }

    bool isSeparated(const std::vector<std::string>& tie) const {
        return std::any_of(plan_.proposals.begin(), plan_.proposals.end(), [&](const Proposal& proposal) {
            const auto& separates = proposal.gain.separates;
            return std::find(separates.begin(), separates.end(), tie) != separates.end();
        });
    }

    void findUnreached() {
        for (const auto& tie : listTies(plan_.now)) {
            if (isSeparated(tie)) continue;
            const auto group = std::find_if(plan_.now.not_identifiable.begin(), plan_.now.not_identifiable.end(),
                                            [&](const UnidentifiedGroup& candidate) { return candidate.names == tie; });
            plan_.unreached.push_back({tie, group->separate_by, {}, 0});
            findCombination(plan_.unreached.back());
        }
    }

    /// The shortest one, of the first proposal that tells any.
    void findCombination(UnreachedTie& tie) const {
        for (std::size_t p = 0; p < plan_.proposals.size() && tie.combination.empty(); ++p) {
            std::size_t fewest = 0;
            for (const UnidentifiedGroup& known : plan_.proposals[p].gain.combinations) {
                const bool holds =
                    std::find(known.names.begin(), known.names.end(), tie.names.front()) != known.names.end();
                if (!holds || (fewest > 0 && known.names.size() >= fewest)) continue;
                fewest = known.names.size();
                tie.combination = known.combination;
                tie.proposal = p;
            }
        }
    }

    /// Greedy: each time the proposal that adds most groups, until none adds any.
    void findTogether() {
        std::vector<std::vector<std::string>> covered;
        while (true) {
            std::size_t best = 0, most = 0;
            for (std::size_t p = 0; p < plan_.proposals.size(); ++p) {
                const auto& separates = plan_.proposals[p].gain.separates;
                const auto added = static_cast<std::size_t>(
                    std::count_if(separates.begin(), separates.end(), [&](const std::vector<std::string>& tie) {
                        return std::find(covered.begin(), covered.end(), tie) == covered.end();
                    }));
                if (added <= most) continue;
                most = added;
                best = p;
            }
            if (most == 0) return;
            const auto& separates = plan_.proposals[best].gain.separates;
            covered.insert(covered.end(), separates.begin(), separates.end());
            plan_.together.push_back(best);
        }
    }

    /// As many as asked for, and those that are needed together.
    void keepFirst() {
        std::vector<Proposal> kept;
        for (std::size_t p = 0; p < plan_.proposals.size(); ++p) {
            const auto needed = std::find(plan_.together.begin(), plan_.together.end(), p);
            if (p >= options_.most_proposals && needed == plan_.together.end()) continue;
            if (needed != plan_.together.end()) *needed = kept.size();
            kept.push_back(std::move(plan_.proposals[p]));
        }
        plan_.proposals = std::move(kept);
    }

    const std::vector<RunMotion>& runs_;
    const MountModel& model_;
    const PlanOptions& options_;
    Plan& plan_;
    Rehearsal rehearsal_;
    std::vector<Rehearsal> possible_;  // as devices that runs and tolerances leave possible
    std::size_t told_ = 0, refused_ = 0;
};

}  // namespace

Plan makePlan(const std::vector<RunMotion>& runs, const std::vector<Recording>& recordings, const MountModel& model,
              const PlanOptions& options) {
    Plan plan;
    plan.setup = findTestSetup(runs, recordings, model, options.asked);
    if (options.progress) options.progress({"fit of the recordings"});
    plan.now = fitMount(runs, model, options.fit);
    plan.trusted = plan.now.residual_over_noise < kNotable || plan.now.residual_fraction < kLeastFraction;
    plan.notes = plan.setup.notes;
    plan.notes.insert(plan.notes.end(), plan.now.notes.begin(), plan.now.notes.end());
    Planner(runs, model, options, plan).run();
    return plan;
}

}  // namespace wems::identify
