// libFuzzer target: the text formats other than CSV, each found by its beginning; start from tests/recording/data. A
// column map stands before a line `%%`, if there is one.
#include <cstdint>
#include <optional>
#include <string_view>

#include "models/common/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_table.hpp"
#include "tests/fuzz/promises.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    constexpr std::string_view mark = "\n%%\n";
    const auto split = text.find(mark);
    try {
        std::optional<wems::ColumnMap> map;
        if (split != std::string_view::npos) {
            map = wems::parseColumnMap(text.substr(0, split), "map.toml");
            text.remove_prefix(split + mark.size());
        }
        const wems::TextFormat* format = wems::findTextFormat(text);
        if (format == nullptr) return -1;
        wems::fuzz::checkPromises(wems::makeRecording(format->read(text, "run"), map ? &*map : nullptr));
    } catch (const wems::InputError& error) {
        wems::fuzz::require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    return 0;
}
