#include "identify/forward/lanes.hpp"

namespace wems::identify {

void runEightLanes(const MountKernel<double>& structure, const StepPlan& plan, const double* constants, LaneRun* runs,
                   double* work) {
    runLanes<8>(structure, plan, constants, runs, work);
}

}  // namespace wems::identify
