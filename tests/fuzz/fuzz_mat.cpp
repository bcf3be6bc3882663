// libFuzzer target: MATLAB files before 7.3; start from tests/recording/data/*.mat. The reader runs in the fuzzer's own
// process, not in a child for each input, so that the sanitizers see it; what crashes inside matio is matio's. HDF5 has
// a campaign of its own (tests/recording/damage_hdf5.cpp), since the fuzzer would end at the first fault of the
// library.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "models/common/error.hpp"
#include "models/recording/mat_file.hpp"
#include "models/recording/mat_reader.hpp"
#include "tests/fuzz/promises.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 128) return -1;
    const std::string_view bytes(reinterpret_cast<const char*>(data), size);
    if (bytes.substr(0, 10) != "MATLAB 5.0") return -1;
    const int descriptor = memfd_create("fuzz.mat", 0);
    wems::fuzz::require(descriptor >= 0);
    wems::fuzz::require(::write(descriptor, data, size) == static_cast<ssize_t>(size));
    const std::string file = "/proc/self/fd/" + std::to_string(descriptor);
    try {
        wems::checkMatExtent(bytes, file);
        wems::fuzz::checkPromises(
            wems::makeRecording(wems::takeValues(wems::tabulateMat(wems::readMatFile(file), file)), nullptr));
    } catch (const wems::InputError& error) {
        wems::fuzz::require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    ::close(descriptor);
    return 0;
}
