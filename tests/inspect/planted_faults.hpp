// Recordings of random devices with faults of the measurement planted on purpose.
#pragma once

#include <string>
#include <vector>

#include "identify/inspect/measurement_faults.hpp"
#include "tests/hidden/random_numbers.hpp"

namespace wems::test {

/// One fault and the channels that it spoils.
struct PlantedFault {
    identify::MeasurementFault::Kind kind = identify::MeasurementFault::Kind::gain;
    std::vector<std::string> channels;
    double size = 1;  ///< factor, s, or s/s
};

struct FaultyRun {
    MountModel model;
    Recording recording;
    std::vector<PlantedFault> planted;
    std::string set_up;  ///< for messages
};

/// A device of tests/hidden with stops, driven by a force on its bracket or by its table: a sweep or noise along a
/// random direction. Three accelerometers anywhere on the mobile part and on the bracket (or one or four on the table);
/// in half of the recordings displacements of the connections, too. Small errors everywhere: gains 0.5 %, directions
/// 0.5°, places 0.5 mm, noise.
/// Planted are `count` faults on channels of their own: a wrong unit (one channel, or a whole sensor), a wrong sign,
/// two channels exchanged, a delay of 2 to 10 ms, one clock that drifts by 2e-4 to 1e-3. A fault that changes its
/// channels by less than a fifth of their signal, or by less than 5 % of a typical channel's, is drawn again; where
/// channels run out there are fewer.
FaultyRun drawFaultyRun(int count, hidden::Random& random);

struct FaultScore {
    int planted = 0, named = 0;    ///< by kind and channel
    int innocent = 0, blamed = 0;  ///< channels without fault
    std::string missed;            ///< one line for each
};
FaultScore scoreFaults(const FaultyRun& run, const std::vector<identify::PartConsistency>& found);

}  // namespace wems::test
