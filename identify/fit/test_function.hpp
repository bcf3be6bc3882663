/// @file
/// The test function of the weak form: a compact, smooth weight that an equation of motion is averaged with, so that
/// derivatives fall on the weight and not on measured signals.
///
/// φ(t) = B(t/h)/h, B the centred quintic B-spline (support ±3, unit integral, C⁴). With φ* written for the average
/// around each output time,
///
///     φ*x'  = −∫ φ'(s) x(t + s) ds,      φ*x'' = ∫ φ''(s) x(t + s) ds.
///
/// h is a whole number of samples: the zeros of the transform sinc(f h)^6 then fall on the multiples of the sampling
/// frequency, so that the sums reproduce polynomials up to degree five exactly, and a sine of frequency f up to a
/// relative error of about 2 (f / f_s)^4.
#pragma once

#include <vector>

namespace wems::identify {

class TestFunction {
public:
    /// @param knot_samples h in samples, ≥ 1
    /// @param interval     sample interval, s
    TestFunction(int knot_samples, double interval);

    int knotSamples() const { return knot_samples_; }
    double interval() const { return interval_; }
    /// Taps reach from −half() to +half() samples; index half() is the middle.
    int half() const { return half_; }
    /// Samples from one output to the next: close enough that no information in the pass band is lost.
    int stride() const;
    /// Outputs for a run of that many samples, the first centred on sample half().
    int outputCount(int samples) const;

    const std::vector<double>& value() const { return value_; }    ///< Δt φ
    const std::vector<double>& first() const { return first_; }    ///< Δt φ', 1/s
    const std::vector<double>& second() const { return second_; }  ///< Δt φ'', 1/s²

    /// Transform at frequency f (Hz): sinc(f h)^6.
    double response(double frequency) const;

private:
    int knot_samples_, half_;
    double interval_;
    std::vector<double> value_, first_, second_;
};

}  // namespace wems::identify
