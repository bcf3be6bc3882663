// Any text is either a list of usable modes or an InputError with a message on one line.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "models/bracket.hpp"
#include "models/common/error.hpp"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    try {
        const auto modes = wems::parseBracketModes(text, "fuzz.csv");
        require(!modes.empty());
        for (const wems::BracketMode& mode : modes) {
            require(std::isfinite(mode.frequency) && mode.frequency > 0);
            require(std::isfinite(mode.damping_ratio) && mode.damping_ratio >= 0);
            require(mode.translation.allFinite() && mode.rotation.allFinite());
            require(mode.load_translation.allFinite() && mode.base_participation.allFinite());
        }
    } catch (const wems::InputError& error) {
        require(std::string_view(error.what()).find('\n') == std::string_view::npos);
        require(error.location().file == "fuzz.csv");
    }
    return 0;
}
