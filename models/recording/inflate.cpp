#include "models/recording/inflate.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace wems {

Inflated inflateAll(std::string_view stream) {
    constexpr std::size_t kPiece = 1 << 18;
    z_stream state;
    std::memset(&state, 0, sizeof state);
    if (inflateInit(&state) != Z_OK) return {};
    std::vector<Bytef> piece(kPiece), input;
    Inflated result;
    int status = Z_OK;
    while (status == Z_OK) {
        if (state.avail_in == 0 && !stream.empty()) {
            const std::size_t count = std::min(stream.size(), kPiece);
            input.assign(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(count));  // zlib wants it mutable
            stream.remove_prefix(count);
            state.next_in = input.data();
            state.avail_in = static_cast<uInt>(count);
        }
        state.next_out = piece.data();
        state.avail_out = static_cast<uInt>(kPiece);
        status = inflate(&state, Z_NO_FLUSH);  // Z_BUF_ERROR where the stream is cut off
        result.plain.append(piece.begin(), piece.end() - static_cast<std::ptrdiff_t>(state.avail_out));
    }
    inflateEnd(&state);
    result.complete = status == Z_STREAM_END;
    return result;
}

}  // namespace wems
