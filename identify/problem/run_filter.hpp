/// @file
/// The low pass that everything of a run goes through, and the rate at which it is kept.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "identify/problem/smoothing_kernel.hpp"

namespace wems::identify {

/// The band that a recording excites, Hz, from which all lengths of filters and tapers follow.
struct ExcitedBand {
    double lowest = 0, highest = 0;
    /// Laws act on the motion up to this multiple of the highest excited frequency, or as far as the samples reach:
    /// by default to the fourth harmonic, as campaigns of the exact method have measured it.
    double harmonics = 4.4;
    /// Hz, of the mobile part against all its stops, where they are reached: laws are sampled that much faster. 0: not.
    double contact = 0;
};

/// Zero phase; samples are kept further apart than the recording's where the band allows, and closer where contact
/// needs them.
class RunFilter {
public:
    RunFilter() = default;  ///< passes everything
    /// @param interval s, of the recording
    RunFilter(double interval, const ExcitedBand& band);

    double interval() const { return interval_; }  ///< s, between what is kept
    double pass() const { return pass_; }          ///< Hz, all is flat up to here
    bool refines() const { return between_ > 1; }  ///< whether samples are closer than those of the recording
    double edge() const;                           ///< s, at both ends, where samples are lacking

    /// Whether samples tell the course of a contact as they are. @param frequency Hz, of contact
    static bool resolves(double interval, double frequency);

    /// Derivative (0, 1 or 2) of each row, low-passed.
    Eigen::MatrixXd apply(const Eigen::Ref<const Eigen::MatrixXd>& rows, int derivative) const;
    /// For each sample that is kept, the one of the recording at or before it.
    Eigen::Index recorded(Eigen::Index kept) const { return kept * every_ / between_; }
    /// What is left of a sine, 1 … 0. @param frequency Hz
    double calcResponse(double frequency) const;

private:
    double raw_interval_ = 0, interval_ = 0, pass_ = 0;
    int between_ = 1, every_ = 1;  // so many samples are made of one; one of so many is kept
    SmoothingKernel kernel_;
    std::vector<double> response_;  // from 0 to half the rate of what is kept, equally spaced
};

}  // namespace wems::identify
