/// @file
/// The good recordings and models that the oddities are drawn into, each short: half a second of a whole device on its
/// bracket, a device with one free motion on a moving base, an element on a test machine.
#pragma once

#include <string>
#include <vector>

#include "tests/fuzz/drawn_recording.hpp"

namespace wems::fuzz {

struct GoodInput {
    DrawnRecording recording;
    std::string model;  ///< TOML; its modes stand in `modes.csv` beside it
};
std::vector<GoodInput> makeGoodInputs();

}  // namespace wems::fuzz
