/// @file
/// Simulations of several parameter sets side by side, compiled for several instruction sets.
#pragma once

#include "identify/forward/mount_kernel.hpp"
#include "identify/forward/stepper.hpp"

namespace wems::identify {

/// Integrates one simulation in each lane.
struct LaneProgram {
    int lanes;
    /// @param structure of all models; its constants are not used
    /// @param constants of the models, lane after lane for each number, aligned to 64 bytes
    /// @param work StepPlan::workSize() numbers for each lane, aligned likewise
    void (*run)(const MountKernel<double>& structure, const StepPlan& plan, const double* constants, LaneRun* runs,
                double* work);
};

/// The widest that this processor can run.
LaneProgram chooseLaneProgram();

// The instruction set's own, two lanes; AVX2 with FMA, four; AVX-512, eight.
void runTwoLanes(const MountKernel<double>& structure, const StepPlan& plan, const double* constants, LaneRun* runs,
                 double* work);
void runFourLanes(const MountKernel<double>& structure, const StepPlan& plan, const double* constants, LaneRun* runs,
                  double* work);
void runEightLanes(const MountKernel<double>& structure, const StepPlan& plan, const double* constants, LaneRun* runs,
                   double* work);

template <int lanes>
inline void runLanes(const MountKernel<double>& structure, const StepPlan& plan, const double* constants, LaneRun* runs,
                     double* work) {
    using Numbers = Pack<lanes>;
    const MountKernel<Numbers> kernel{reinterpret_cast<const Numbers*>(constants),
                                      structure.shapes,
                                      structure.connections,
                                      structure.modes,
                                      structure.at_connections,
                                      structure.prescribed,
                                      structure.load_on};
    Stepper<Numbers, lanes, NoGuides<Numbers>>(kernel, plan, {}, runs, reinterpret_cast<Numbers*>(work)).run();
}

}  // namespace wems::identify
