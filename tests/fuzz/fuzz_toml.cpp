// Any text is either a model or an InputError with a message on one line; a model reads back as it was written.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "models/common/error.hpp"
#include "models/mount_model.hpp"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    wems::MountModel model;
    try {
        model = wems::parseMountModel(text, "fuzz.toml");
    } catch (const wems::InputError& error) {
        require(std::string_view(error.what()).find('\n') == std::string_view::npos);
        require(!error.location().file.empty());
        return 0;
    }
    const std::string written = wems::formatMountModel(model, model.bracket_file);
    const wems::MountModel again = wems::parseMountModel(written, "fuzz.toml");
    require(wems::formatMountModel(again, again.bracket_file) == written);
    return 0;
}
