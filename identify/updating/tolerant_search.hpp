/// @file
/// A round of the search where all numbers have tolerances: the best few sets are judged where their estimates lead,
/// the likeliest that serves is taken, and its rivals are weighed where their own steps end.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "identify/updating/standing.hpp"
#include "identify/updating/trials.hpp"
#include "identify/verdict/diagnosis.hpp"

namespace wems::identify::updating {

class TolerantSearch {
public:
    /// @param band may be empty: then the prediction counts as known
    TolerantSearch(TestProblem& problem, const Settler& settler, const FreeJudge& judge, const BandJudge& band,
                   const ProgressListener& progress);

    /// Moves to the likeliest set that serves the prediction or the equations.
    /// @param evidence of the view at the present state, with the columns of all hypotheses
    /// @param[out] decision what was done, and the sets that were fitted
    /// @return whether the set changed
    bool takeBest(const Evidence& evidence, const std::vector<RankedSet>& candidates, Standing& standing,
                  Decision& decision);

    /// Moves to a set with one cause less, if some set of that kind is likelier than the present one and serves.
    /// @param evidence of the view at the present state
    /// @param[out] decision what was done, and the sets that were fitted
    /// @return whether the set changed
    bool takeFewer(const Evidence& evidence, Standing& standing, Decision& decision);

    /// Causes without which, when they were taken, the equations left twice as much or numbers beyond their tolerances.
    const std::vector<int>& needed() const { return needed_; }

private:
    /// A set that was settled, and its prediction.
    struct Attempt {
        SetState state;
        FreeError judged;
        bool needed = false;      ///< the equations leave twice as much without it, or numbers beyond their tolerances
        double log_evidence = 0;  ///< with a discrepancy whose size is not known
        std::size_t record = 0;   ///< in fitted_
    };

    void tell(const std::string& text) const;
    void begin(const SetState& present);
    std::optional<Attempt> findFewer(const Evidence& evidence, const Standing& standing);
    bool isHopeful(const Evidence& evidence, const std::vector<RankedSet>& candidates, const SetState& present) const;
    std::optional<Attempt> findServing(std::vector<Trial>& trials, const Standing& standing, int& attempts);
    std::vector<RankedSet> weighRivals(Attempt& best, std::vector<Trial>& trials, const Standing& standing,
                                       int attempts);
    void weighFreshStarts(std::optional<Attempt>& best, Standing& standing, std::vector<RankedSet>& ranked);
    void take(Attempt best, Standing& standing);
    /// @param rival log evidence that a trial from far away has to reach
    Attempt settle(const Trial& trial, const SetState& present, std::optional<double> rival = std::nullopt);
    void compare(Attempt& attempt, const Attempt& best);
    bool serves(Attempt& attempt, const Standing& standing);
    /// Why a set does not serve; null if it does.
    const char* findRefusal(const Attempt& attempt, const Standing& standing) const;
    bool isWithinBand(const Attempt& attempt) const;
    bool isNeeded(const SetState& next) const;
    bool isRelief(const SetState& next, const SetState& present) const;
    std::string nameCauses(const HypothesisSet& set) const;

    TestProblem& problem_;
    const Settler& settler_;
    const FreeJudge& judge_;
    const BandJudge& band_;
    const ProgressListener& progress_;
    double excess_ = 0;         // of the equations at the round's state, beyond the noise
    bool noise_alone_ = false;  // whether it is none
    double present_ = 0;        // log evidence of the round's set
    std::vector<FittedSet> fitted_;
    std::vector<int> needed_;
    std::vector<RankedSet> fewer_;     // sets of the round with one cause less that are less likely
    std::set<HypothesisSet> reached_;  // sets with one cause less that were settled to their end and judged
};

}  // namespace wems::identify::updating
