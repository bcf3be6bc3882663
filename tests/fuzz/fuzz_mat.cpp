// libFuzzer target: MATLAB files; start from tests/recording/data/*.mat. What crashes inside matio or HDF5 is theirs:
// both are given the file as it is.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "models/error.hpp"
#include "models/recording/recording_reader.hpp"
#include "tests/fuzz/promises.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 128) return -1;
    const int descriptor = memfd_create("fuzz.mat", 0);
    wems::fuzz::require(descriptor >= 0);
    wems::fuzz::require(::write(descriptor, data, size) == static_cast<ssize_t>(size));
    try {
        wems::fuzz::checkPromises(wems::readRecording("/proc/self/fd/" + std::to_string(descriptor)));
    } catch (const wems::InputError& error) {
        wems::fuzz::require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    ::close(descriptor);
    return 0;
}
