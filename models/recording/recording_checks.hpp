/// @file
/// What may be wrong with a recording, found without a model.
///
/// Repaired, with a finding:
/// - a time stamp that repeats the one before, up to 10 % of the rows: the later row is dropped;
/// - a time stamp that goes back, up to 3 rows: the row is dropped;
/// - a channel without any value: the channel is dropped;
/// - empty fields in up to 5 rows on end: straight line between the neighbours;
/// - empty fields at the start or the end, up to half of the rows: the rows are cut off.
/// Beyond these limits: InputError with row and channel. Found and left as it is: gaps, non-uniform time stamps,
/// clipped and constant channels.
#pragma once

#include <vector>

#include "models/recording/recording.hpp"

namespace wems {

/// Makes every value finite and time strictly increasing, then runs checkChannels. NaN stands for an empty field.
/// @throws InputError where that would take more than the limits above.
std::vector<Finding> repairAndCheck(Recording& recording);

/// Gaps, non-uniform time, clipped and constant channels of a recording of finite values and increasing time.
/// @param rows row of the file of each sample; empty: consecutive from first_row
std::vector<Finding> checkChannels(const Recording& recording, const std::vector<long>& rows = {});

}  // namespace wems
