/// @file
/// What a laboratory calls its columns, and what they are here. A TOML file:
///
///     [columns]                                  # header in the file (with or without its unit) = channel
///     "t [s]" = "time"
///     "Displacement (in)" = "relative.1.x"       # unit from the header, in [] or ()
///     "Trial 1_y" = { channel = "force.1.x", unit = "N", scale = -1.0, offset = 0.0 }
///
///     [table]                                    # the file's shape; every key optional
///     time = "none"                              # no time column: samples are numbered 0, 1, 2 …
///     sample_interval = 0.001                    # s, with time = "none"; absent = 1
///     separator = ";"                            # `,` `;` or tab; absent = found from the header
///     decimal = ","                              # `.` or `,`; absent = found from the data
///     skip_rows = 3                              # rows before the header that are not read
///     rest = 0.5                                 # displacements are positions: the mean over the first 0.5 s is rest;
///                                                # "none": they count from rest already; absent: as the format has it
///
/// A value becomes (scale · value + offset) · unit; scale and offset are thus in the column's own unit. Columns that
/// the map does not name are read if they carry a channel's name already.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wems {

struct MappedColumn {
    std::string column;   ///< header text, or the header without its unit
    std::string channel;  ///< a channel's name, or `time`
    std::string unit;     ///< empty = from the header
    double scale = 1;     ///< -, not 0
    double offset = 0;    ///< in the column's unit, after the scale
    long line = 0;        ///< in the map's file
};

/// From where displacement channels count.
struct RestPosition {
    enum class Kind {
        by_format,  ///< markers (.trc) from the first row, anything else from rest already
        none,       ///< they count from rest already
        mean        ///< they are positions; rest is the mean over the first `duration` seconds
    };
    Kind kind = Kind::by_format;
    double duration = 0;  ///< s
};

struct ColumnMap {
    std::string file;
    std::vector<MappedColumn> columns;
    bool has_time = true;        ///< false: samples are numbered
    double sample_interval = 1;  ///< s, without time column
    std::optional<char> separator, decimal;
    int skip_rows = 0;
    RestPosition rest;
};

/// @throws InputError with file, line and key: not TOML, unknown key, unknown channel, two columns for one channel.
ColumnMap readColumnMap(const std::string& file);
/// The same from text; `file` stands in messages.
ColumnMap parseColumnMap(std::string_view text, const std::string& file);

}  // namespace wems
