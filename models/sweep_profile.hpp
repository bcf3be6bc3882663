/// @file
/// Sine sweeps as test specifications write them: levels of displacement, velocity or acceleration over frequency,
/// with crossovers and notches.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "models/common/units.hpp"
#include "models/excitation.hpp"

namespace wems {

/// One row of a profile: an amplitude (zero to peak) from one frequency to another, a straight line in log–log.
struct ProfileSegment {
    double from = 0, to = 0;                     ///< Hz, from < to
    double start_level = 0, end_level = 0;       ///< SI, of `quantity`
    Quantity quantity = Quantity::acceleration;  ///< length, velocity, acceleration or force
};

/// At each frequency the smallest of the rows that cover it holds, compared as accelerations. So crossovers are where
/// the rows cross, and a notch is a row of its own with a lower level. Where another row takes over, the level passes
/// within a 24th of an octave, a cubic in log–log that continues both sides with their slopes.
class SweepProfile {
public:
    /// @throws InputError if rows are out of range, leave a gap, or are partly of forces
    explicit SweepProfile(std::vector<ProfileSegment> segments);

    double lowest() const { return lowest_; }    ///< Hz
    double highest() const { return highest_; }  ///< Hz
    bool isForce() const { return force_; }
    /// Amplitude of the acceleration, m/s², or of the force, N; constant beyond the ends.
    double calcLevel(double frequency) const;
    /// Frequencies (Hz) at which the row that holds changes: crossovers, notches' edges.
    const std::vector<double>& findChanges() const { return changes_; }

private:
    struct Passage {
        double at = 0, width = 0;             // ln Hz; from at − width to at + width
        double level[2] = {}, slope[2] = {};  // ln of the level and its derivative by ln f, at both ends
    };
    double calcSharp(double frequency) const;
    std::size_t findRow(double frequency) const;

    std::vector<ProfileSegment> segments_;
    std::vector<double> changes_;  // Hz
    std::vector<Passage> passages_;
    double lowest_ = 0, highest_ = 0;
    bool force_ = false;
};

/// Rows `from,to,level` or `from,to,level at from,level at to`: Hz, and levels with their unit (`5,20,10mm`,
/// `20,100,1.5g`). A header, which begins with a word, is passed over. @throws InputError with file and line
SweepProfile parseSweepProfile(std::string_view text, const std::string& file);
SweepProfile readSweepProfile(const std::string& file);

/// A sweep with the profile's level at the swept frequency, in m/s² or N. Of a motion it is the acceleration of the
/// displacement E sin φ, E(t) the level over ω² times the fade: E'' sin φ + 2 E' φ' cos φ + E (φ'' cos φ − φ'² sin φ),
/// so that the table goes where the profile says and does not drift.
/// @param sweep without fade
std::unique_ptr<Signal> makeProfiledSweep(std::shared_ptr<const Signal> sweep, SweepProfile profile, Fade fade = {});

}  // namespace wems
