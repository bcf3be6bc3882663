// libFuzzer target: a column map (up to a line `%%`, if there is one) and a CSV recording.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "models/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/csv_reader.hpp"

namespace {

void require(bool condition) {
    if (!condition) std::abort();
}

/// What the reader promises of every recording that it accepts.
void checkPromises(const wems::Recording& recording) {
    require(!recording.time.empty() && !recording.channels.empty());
    for (std::size_t i = 0; i < recording.time.size(); ++i) {
        require(std::isfinite(recording.time[i]));
        require(i == 0 || recording.time[i] > recording.time[i - 1]);
    }
    for (const auto& channel : recording.channels) {
        require(channel.values.size() == recording.time.size());
        require(wems::parseChannelName(channel.name).has_value());
        for (const double value : channel.values) require(std::isfinite(value));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    constexpr std::string_view mark = "\n%%\n";
    const auto split = text.find(mark);
    try {
        std::optional<wems::ColumnMap> map;
        if (split != std::string_view::npos) map = wems::parseColumnMap(text.substr(0, split), "map.toml");
        const auto csv = split == std::string_view::npos ? text : text.substr(split + mark.size());
        checkPromises(wems::parseRecording(csv, "run.csv", map ? &*map : nullptr));
    } catch (const wems::InputError& error) {
        require(std::string_view(error.what()).find('\n') == std::string_view::npos);
    }
    return 0;
}
