// libFuzzer target: a column map (up to a line `%%`, if there is one) and a CSV recording.
#include <cstdint>
#include <optional>
#include <string_view>

#include "models/common/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/csv_reader.hpp"
#include "tests/fuzz/promises.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    constexpr std::string_view mark = "\n%%\n";
    const auto split = text.find(mark);
    try {
        std::optional<wems::ColumnMap> map;
        if (split != std::string_view::npos) map = wems::parseColumnMap(text.substr(0, split), "map.toml");
        const auto csv = split == std::string_view::npos ? text : text.substr(split + mark.size());
        wems::fuzz::checkPromises(wems::parseRecording(csv, "run.csv", map ? &*map : nullptr));
    } catch (const wems::InputError& error) {
        wems::fuzz::require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    return 0;
}
