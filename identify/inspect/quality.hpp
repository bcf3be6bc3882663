/// @file
/// Whether a recording is good enough to be fitted, and why not.
#pragma once

#include <string>
#include <vector>

#include "identify/inspect/measurement_faults.hpp"
#include "models/recording/recording.hpp"

namespace wems::identify {

// Whether accelerations are the second derivatives of the displacements beside them.

/// What the accelerations of points whose displacement was recorded, too, are of the second derivatives of those: the
/// ratio at the frequencies where both agree in course (coherence above 0.9 over Hann segments), its median. 1 within
/// the sensors' gains; 0.102 where g are labelled m/s^2, 10^6 where milliseconds are labelled seconds, below 0 where
/// one of them has the wrong sign.
/// @returns one sentence for all channels that share a ratio outside 0.67 to 1.5, which no sensor's gain explains;
///          nothing where too little is recorded to tell
std::vector<std::string> findContradictions(const Recording& recording);

/// - `unusable`: a wrong unit, a wrong sign, exchanged channels, a delay or a clock of its own: any fit would be wrong;
///   or channels of a rigid part that contradict each other by more than 15 % of their signal, whatever the reason.
/// - `doubtful`: a gain that is off, channels that agree to 5 to 15 % only, or signals with gaps, drop-outs or limits.
/// - `good`: none of these.
enum class Quality { good, doubtful, unusable };
const char* qualityName(Quality quality);

struct QualityVerdict {
    Quality quality = Quality::good;
    std::vector<std::string> reasons;  ///< one sentence each, the worst first
    std::vector<MeasurementFault> faults;
    double contradiction =
        0;                 ///< of the signals, the larger one of both parts, as recorded; 0 if nothing can be checked
    bool checked = false;  ///< channels beyond those that the rigid motions need were there to compare
};

/// @param model null: findings of the signals and contradictions with the derivatives alone
/// @param findings of the recording's signals
QualityVerdict judgeQuality(const Recording& recording, const MountModel* model, const std::vector<Finding>& findings);

/// By the findings alone, of a recording too long to compare its channels.
QualityVerdict judgeFindings(const std::vector<Finding>& findings);

/// `Quality: good.` or `Quality: unusable: mobile.1.az has the wrong sign; …`
std::string formatVerdict(const QualityVerdict& verdict);

}  // namespace wems::identify
