/// @file
/// A law fitted to component tests: spring, dashpot, cubic term or force curve, stops, and of what a model's law may
/// have (models/axis_law.hpp) sliders, hysteresis and Maxwell branches.
///
/// What a unit of each part does along the recorded motion is a column, calculated by the law itself, so that a model
/// with the fitted law gives exactly this force along the same motion. All weights but those of the cubic term and of a
/// constant force are non-negative (block_regression.hpp): sliders over a grid of stretches are a distribution (Iwan
/// 1966), branches over a grid of time constants a relaxation spectrum, monotone splines a force curve in place of the
/// spring (curve_basis.hpp). One slider with a gap and one hysteresis have shapes that are searched instead.
#pragma once

#include <string>
#include <vector>

#include "identify/component/component_data.hpp"
#include "identify/component/component_fit.hpp"
#include "models/axis_law.hpp"

namespace wems::identify {

/// Which parts a law has besides spring, dashpot, stops and a constant force.
struct LawTerms {
    enum class Memory { none, hysteresis, sliders, gap_slider, gap_sliders };
    Memory memory = Memory::none;
    bool cubic = false, relaxation = false;
    bool curve = false;  ///< a force curve that never falls, in place of the spring

    /// `spring and dashpot`, `sliders`, `slider with gap, Prony series` …
    std::string name() const;
};

struct LawFit {
    LawTerms terms;
    AxisLaw law;
    double force_offset = 0;  ///< N
    std::vector<ComponentParameter> parameters;
    double fraction = 0;  ///< root relative squared error: RMS of what is left over that of the force about its mean
    int parameter_count = 0;       ///< weights that are not zero, and numbers of a shape that was searched
    double effective_samples = 0;  ///< samples over the correlation length of what is left
};

/// Fits all tests together. @param stops that act besides, at their clearances
/// @param place `1.z.`, before the names of parameters
LawFit fitLaw(const std::vector<ComponentData>& tests, const LawTerms& terms, const std::vector<Stop>& stops,
              const std::string& place);

/// Root relative squared error of a law along a test, its constant force included.
double calcLawError(const AxisLaw& law, double force_offset, const ComponentData& test);
/// The same over several tests together.
double calcLawError(const AxisLaw& law, double force_offset, const std::vector<ComponentData>& tests);

}  // namespace wems::identify
