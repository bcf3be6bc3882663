#include "identify/inspect/measurement_faults.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <tuple>

#include "identify/inspect/fault_misfit.hpp"
#include "models/common/format_number.hpp"
#include "models/common/units.hpp"

namespace wems::identify {
namespace {

using FaultKind = MeasurementFault::Kind;

// Figures are of recordings of random devices (planted_faults in tests/inspect): 180 parts without fault, and 24
// recordings with none to five.

/// Misfit that small errors explain: of the parts without fault one has more, 1.76.
constexpr double kConsistent = 1.6;
/// Misfit of small errors, nothing is sought below: 176 parts without fault have less.
constexpr double kSmallest = 1.1;
/// Of a misfit between the two, which a fault has to take away: small errors alone, 0.58 in the middle, leave about
/// half.
constexpr double kConsistentGain = 0.5;
constexpr double kSolved = 4;  ///< misfit above which faults are not trusted: searches left 2.0 at most or 8 to 32
/// Of the misfit, which a fault has to take away. Less names more and blames more, above all delays below 1 ms: with
/// 0.05 (and 12 cells) 383 of 415 faults are named and 27 of 3543 innocent channels blamed, as it is 356 and 17 (the
/// campaign in models/recording/README.md); with 0.3 (and 12 cells) 35 of 60 faults are named where 0.15 names 48.
constexpr double kLeastGain = 0.15;
/// Of one part: one more than are planted, of which the last are named least (models/recording/README.md).
constexpr std::size_t kMostFaults = 6;
/// Sets of faults that are kept at each size. Of 60 faults 41, 43 and 45 are named with 1, 3 and 10 (0.44, 0.76 and
/// 1.3 s a recording), and 3, 0 and 0 of 758 innocent channels blamed.
constexpr std::size_t kBeam = 10;
/// Channels that are tried in full: as many as there may be faults, so that all faulty ones can be among them.
constexpr std::size_t kLikely = kMostFaults;
/// s: two frames of a camera of 50 frames a second, and 10 ms of a filter.
constexpr double kLongestLag = 0.05;
/// s/s: twice what 29.97 frames a second make that are taken for 30; quartz clocks differ by less than 1e-4.
constexpr double kSteepestDrift = 2e-3;
constexpr int kDriftSteps = 16;  ///< on either side: half a step turns 50 Hz by 0.2 rad at the ends of 20 s
constexpr double kSnap = 0.08;   ///< a factor this close to a wrong unit's is that; those differ by 1.55 and more
constexpr double kLeastGainError = 2 * kOwnFloor;  ///< a smaller one is no gross fault
constexpr double kTie = 1.15;  ///< misfits closer than this are one: parts without fault scatter from 0.58 to 0.90
constexpr double kGravity = 9.80665;

/// Recorded over true, of a label that does not fit the numbers.
struct UnitMistake {
    double factor;
    const char* text;
};
const std::vector<UnitMistake>& listMistakes(Derivative derivative) {
    static const std::vector<UnitMistake> accelerations{
        {1 / kGravity, "in g, labelled m/s^2"},    {kGravity, "in m/s^2, labelled g"},
        {1e3, "in mm/s^2, labelled m/s^2"},        {1e-3, "in m/s^2, labelled mm/s^2"},
        {1 / 0.0254, "in in/s^2, labelled m/s^2"}, {1 / 25.4, "in in/s^2, labelled mm/s^2"},
        {25.4, "in mm/s^2, labelled in/s^2"}};
    static const std::vector<UnitMistake> displacements{
        {1e3, "in mm, labelled m"},       {1e-3, "in m, labelled mm"},           {1 / 25.4, "in inches, labelled mm"},
        {25.4, "in mm, labelled inches"}, {1 / 0.0254, "in inches, labelled m"}, {1e6, "in um, labelled m"}};
    return derivative == Derivative::acceleration ? accelerations : displacements;
}

const UnitMistake* findMistake(Derivative derivative, double factor) {
    for (const UnitMistake& mistake : listMistakes(derivative))
        if (std::abs(factor / mistake.factor - 1) < kSnap) return &mistake;
    return nullptr;
}

/// Channels that may share a fault.
struct SuspectGroup {
    std::string name;
    std::vector<std::size_t> members;
};

/// One set of faults and what it does to the channels.
struct Explanation {
    std::vector<MeasurementFault> faults;
    PartState state;
    double misfit = 0;
    std::vector<std::string> key;  // names of the faults, sorted: the same set found by two ways
};

class FaultSearch {
public:
    explicit FaultSearch(const PartCells& part) : part_(part) {
        std::map<std::string, SuspectGroup> stations;
        SuspectGroup kinds[2];
        for (std::size_t c = 0; c < part.channels.size(); ++c) {
            const CellChannel& channel = part.channels[c];
            const bool acceleration = channel.derivative == Derivative::acceleration;
            const std::string prefix = channel.name.substr(0, channel.name.find('.'));
            SuspectGroup& station = stations[channel.station + (acceleration ? ".ax|ay|az" : ".x|y|z")];
            station.members.push_back(c);
            kinds[acceleration ? 1 : 0].members.push_back(c);
            kinds[acceleration ? 1 : 0].name = prefix + (acceleration ? ".*.ax|ay|az" : ".*.x|y|z");
        }
        for (auto& [name, station] : stations) {
            station.name = name;
            if (station.members.size() > 1) groups_.push_back(station);
        }
        stations_ = groups_.size();
        for (SuspectGroup& kind : kinds) {
            if (!kind.members.empty() && kind.members.size() < part.channels.size() && stations.size() > 1)
                groups_.push_back(kind);
        }
    }

    void search(PartConsistency& result) {
        std::vector<Explanation> beam(1);
        beam[0].state = makeFaultless(part_.channels.size());
        beam[0].misfit = calcMisfit(part_, beam[0].state);
        result.before = beam[0].misfit * kOwnFloor;
        Explanation best = beam[0];
        while (best.misfit > kSmallest && beam.front().faults.size() < kMostFaults) {
            std::vector<Explanation> next;
            for (const Explanation& explanation : beam) expand(explanation, next);
            std::sort(next.begin(), next.end(), [](const auto& a, const auto& b) { return a.misfit < b.misfit; });
            next.erase(
                std::unique(next.begin(), next.end(), [](const auto& a, const auto& b) { return a.key == b.key; }),
                next.end());
            const double wanted = best.misfit > kConsistent ? kLeastGain : kConsistentGain;
            if (next.empty() || next.front().misfit > (1 - wanted) * best.misfit) break;
            if (next.size() > kBeam) next.resize(kBeam);
            beam = std::move(next);
            best = beam.front();
            addAlternatives(beam, best);
        }
        result.after = best.misfit * kOwnFloor;
        result.solved = best.misfit < kSolved;
        if (result.solved) result.faults = best.faults;
    }

private:
    const CellChannel& channel(std::size_t c) const { return part_.channels[c]; }

    /// Faults of other sets of the same size and about the same misfit.
    static void addAlternatives(const std::vector<Explanation>& beam, Explanation& best) {
        for (const Explanation& other : beam) {
            if (&other == &beam.front() || other.misfit > kTie * std::max(1.0, best.misfit)) continue;
            std::vector<std::size_t> own;
            std::vector<std::string> theirs;
            for (std::size_t i = 0; i < best.faults.size(); ++i)
                if (!std::count(other.key.begin(), other.key.end(), describe(best.faults[i]))) own.push_back(i);
            for (const std::string& text : other.key)
                if (!std::count(best.key.begin(), best.key.end(), text)) theirs.push_back(text);
            if (own.size() == 1 && theirs.size() == 1) best.faults[own.front()].alternatives.push_back(theirs.front());
        }
    }

    void add(const Explanation& from, MeasurementFault fault, PartState state, std::vector<Explanation>& next) const {
        Explanation explanation;
        explanation.misfit = calcMisfit(part_, state);
        if (!(explanation.misfit < (1 - kLeastGain) * from.misfit)) return;
        explanation.faults = from.faults;
        explanation.faults.push_back(std::move(fault));
        for (auto& each : explanation.faults) each.alternatives.clear();
        explanation.state = std::move(state);
        for (const auto& each : explanation.faults) explanation.key.push_back(describe(each));
        std::sort(explanation.key.begin(), explanation.key.end());
        next.push_back(std::move(explanation));
    }

    bool isTaken(const Explanation& from, const std::string& name, FaultKind kind) const {
        const bool factor = kind == FaultKind::unit || kind == FaultKind::gain;
        return std::any_of(from.faults.begin(), from.faults.end(), [&](const MeasurementFault& fault) {
            const bool same =
                fault.kind == kind || (factor && (fault.kind == FaultKind::unit || fault.kind == FaultKind::gain));
            return fault.channel == name && same;
        });
    }

    void expand(const Explanation& from, std::vector<Explanation>& next) const {
        const std::vector<ChannelOutlook> outlooks = lookAhead(part_, from.state);
        std::vector<std::size_t> order;
        for (std::size_t c = 0; c < outlooks.size(); ++c)
            if (!outlooks[c].forecasts.empty()) order.push_back(c);
        std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return outlooks[a].misfit_without < outlooks[b].misfit_without;
        });
        if (order.size() > kLikely) order.resize(kLikely);
        for (const std::size_t suspect : order) {
            const SuspectGroup one{channel(suspect).name, {suspect}};
            tryFactors(from, one, next);
            tryGain(from, one, outlooks[suspect].forecasts, next);
            tryDelay(from, one, outlooks[suspect].forecasts, false, from.misfit, next);
        }
        for (const SuspectGroup& group : groups_) {
            tryFactors(from, group, next);
            const auto forecasts = forecastGroup(part_, from.state, group.members);
            const double steady = tryDelay(from, group, forecasts, false, from.misfit, next);
            tryDelay(from, group, forecasts, true, steady, next);
        }
        tryExchanges(from, order, next);
    }

    static void scale(PartState& state, const SuspectGroup& group, double factor) {
        for (const std::size_t c : group.members) state[c].factor *= factor;
    }

    void tryFactors(const Explanation& from, const SuspectGroup& group, std::vector<Explanation>& next) const {
        const auto attempt = [&](FaultKind kind, double factor) {
            if (isTaken(from, group.name, kind)) return;
            MeasurementFault fault;
            fault.kind = kind;
            fault.channel = group.name;
            fault.factor = factor;
            PartState state = from.state;
            scale(state, group, factor);
            add(from, fault, std::move(state), next);
        };
        attempt(FaultKind::sign, -1);
        for (const UnitMistake& mistake : listMistakes(channel(group.members.front()).derivative))
            attempt(FaultKind::unit, mistake.factor);
    }

    /// A gain that is no unit's: the median over cells.
    void tryGain(const Explanation& from, const SuspectGroup& one, const std::vector<Forecast>& forecasts,
                 std::vector<Explanation>& next) const {
        if (forecasts.empty() || isTaken(from, one.name, FaultKind::gain)) return;
        std::vector<double> ratios;
        for (const Forecast& forecast : forecasts) ratios.push_back(forecast.ratio.real());
        const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
        std::nth_element(ratios.begin(), middle, ratios.end());
        const double gain = *middle;
        if (!(gain > 0) || std::abs(gain - 1) < kLeastGainError) return;
        if (findMistake(channel(one.members.front()).derivative, gain) != nullptr) return;
        MeasurementFault fault;
        fault.kind = FaultKind::gain;
        fault.channel = one.name;
        fault.factor = gain;
        PartState state = from.state;
        scale(state, one, gain);
        add(from, fault, std::move(state), next);
    }

    struct Lag {
        double delay = 0, drift = 0, agreement = -1e300;
    };

    /// No cell speaks for all.
    static std::complex<double> weigh(const Forecast& forecast) {
        return forecast.ratio / std::max(1.0, std::abs(forecast.ratio));
    }

    /// Where the phases tell most of a delay.
    static double findMiddle(const std::vector<Forecast>& forecasts) {
        double sum = 0, weights = 0;
        for (const Forecast& forecast : forecasts) {
            const double weight = std::norm(forecast.omega * weigh(forecast));
            sum += weight * forecast.time;
            weights += weight;
        }
        return weights > 0 ? sum / weights : 0;
    }

    static void raise(const std::vector<Forecast>& forecasts, double middle, double delay, double drift, Lag& best) {
        double agreement = 0;
        for (const Forecast& forecast : forecasts) {
            const double lag = delay + drift * (forecast.time - middle);
            agreement += (weigh(forecast) * std::polar(1.0, forecast.omega * lag)).real();
        }
        if (agreement > best.agreement) best = {delay, drift, agreement};
    }

    /// @param rival misfit of what explains with less
    /// @returns the misfit that is reached, or `rival`
    double tryDelay(const Explanation& from, const SuspectGroup& group, const std::vector<Forecast>& forecasts,
                    bool drifts, double rival, std::vector<Explanation>& next) const {
        const bool late = std::any_of(group.members.begin(), group.members.end(), [&](std::size_t c) {
            return from.state[c].delay != 0 || from.state[c].drift != 0;
        });
        if (forecasts.empty() || late) return rival;
        double highest = 0;
        for (const Forecast& forecast : forecasts) highest = std::max(highest, forecast.omega);
        const double step = kPi / 6 / highest;  // a twelfth of the shortest period
        const auto steps = static_cast<int>(kLongestLag / step);
        const double middle = drifts ? findMiddle(forecasts) : 0;
        Lag best;
        const int slopes = drifts ? kDriftSteps : 0;
        for (int j = -slopes; j <= slopes; ++j)
            for (int i = -steps; i <= steps; ++i)
                raise(forecasts, middle, i * step, j * kSteepestDrift / kDriftSteps, best);
        const PartState& state = from.state;
        const auto shift = [&](double delay, double drift) {
            PartState moved = state;
            for (const std::size_t c : group.members) {
                moved[c].delay += delay - drift * middle;
                moved[c].drift += drift;
            }
            return moved;
        };
        // Coordinate descent of the misfit itself.
        double delay = best.delay, drift = best.drift, width = 0.5 * step;
        double slope = drifts ? 0.5 * kSteepestDrift / kDriftSteps : 0;
        double misfit = calcMisfit(part_, shift(delay, drift));
        for (int round = 0; round < 9; ++round, width /= 2, slope /= 2) {
            const double tries[4][2] = {{width, 0}, {-width, 0}, {0, slope}, {0, -slope}};
            for (int k = 0; k < (drifts ? 4 : 2); ++k) {
                const double candidate = calcMisfit(part_, shift(delay + tries[k][0], drift + tries[k][1]));
                if (candidate >= misfit) continue;
                misfit = candidate;
                delay += tries[k][0];
                drift += tries[k][1];
            }
        }
        if (misfit > (1 - kLeastGain) * rival) return rival;
        MeasurementFault fault;
        fault.kind = drifts ? FaultKind::clock_drift : FaultKind::delay;
        fault.channel = group.name;
        fault.delay = delay - drift * middle;
        fault.drift = drift;
        add(from, fault, shift(delay, drift), next);
        return misfit;
    }

    void tryExchanges(const Explanation& from, const std::vector<std::size_t>& likely,
                      std::vector<Explanation>& next) const {
        const auto attempt = [&](const std::string& a, const std::string& b,
                                 const std::vector<std::pair<std::size_t, std::size_t>>& pairs) {
            MeasurementFault fault;
            fault.kind = FaultKind::exchanged;
            fault.channel = a;
            fault.exchanged_with = b;
            PartState state = from.state;
            for (const auto& [i, j] : pairs) std::swap(state[i].row, state[j].row);
            add(from, fault, std::move(state), next);
        };
        const auto isLikely = [&](std::size_t c) { return std::count(likely.begin(), likely.end(), c) > 0; };
        for (std::size_t a = 0; a < part_.channels.size(); ++a)
            for (std::size_t b = a + 1; b < part_.channels.size(); ++b)
                if (channel(a).derivative == channel(b).derivative && (isLikely(a) || isLikely(b)))
                    attempt(channel(a).name, channel(b).name, {{a, b}});
        for (std::size_t g = 0; g < stations_; ++g)
            for (std::size_t h = g + 1; h < stations_; ++h) {
                const auto &first = groups_[g], &second = groups_[h];
                if (first.members.size() != second.members.size() ||
                    channel(first.members[0]).derivative != channel(second.members[0]).derivative)
                    continue;
                std::vector<std::pair<std::size_t, std::size_t>> pairs;
                for (std::size_t i = 0; i < first.members.size(); ++i)
                    pairs.emplace_back(first.members[i], second.members[i]);
                attempt(first.name, second.name, pairs);
            }
    }

    const PartCells& part_;
    std::vector<SuspectGroup> groups_;
    std::size_t stations_ = 0;  // of the groups, the first
};

}  // namespace

const char* kindName(MeasurementFault::Kind kind) {
    static constexpr const char* names[] = {"unit", "gain", "sign", "exchanged", "delay", "clock_drift"};
    return names[static_cast<std::size_t>(kind)];
}

std::string describe(const MeasurementFault& fault) {
    switch (fault.kind) {
        case FaultKind::sign:
            return fault.channel + " has the wrong sign";
        case FaultKind::exchanged:
            return fault.channel + " is exchanged with " + fault.exchanged_with;
        case FaultKind::delay:
            return fault.channel + (fault.delay > 0 ? " is late by " : " is early by ") +
                   formatNumber(1e3 * std::abs(fault.delay), 2) + " ms";
        case FaultKind::clock_drift:
            return fault.channel + " runs on another clock, which loses " + formatNumber(1e3 * fault.drift, 2) +
                   " ms a second";
        case FaultKind::unit:
        case FaultKind::gain:
            break;
    }
    const bool acceleration = fault.channel.find('a', fault.channel.rfind('.')) != std::string::npos;
    const UnitMistake* mistake =
        findMistake(acceleration ? Derivative::acceleration : Derivative::displacement, fault.factor);
    return fault.channel + " is " + formatNumber(fault.factor, 3) + " times what the others say" +
           (mistake != nullptr ? std::string(" (as ") + mistake->text + ")" : "");
}

std::vector<PartConsistency> findMeasurementFaults(const Recording& recording, const MountModel& model) {
    std::vector<PartConsistency> parts;
    for (const Part part : {Part::mobile, Part::fixed}) {
        const PartCells cells = collectCells(recording, model, part);
        if (cells.cells.empty()) continue;
        PartConsistency result;
        result.part = part;
        result.redundancy = cells.redundancy;
        if (cells.redundancy > 0) FaultSearch(cells).search(result);
        parts.push_back(std::move(result));
    }
    return parts;
}

}  // namespace wems::identify
