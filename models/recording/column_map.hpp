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

// From the columns that a file offers to the channels of a recording: names, units, the laboratory's own names.

inline constexpr const char* kTime = "time";  ///< name of the column of stamps

/// A column as a file has it.
struct OfferedColumn {
    std::string text;                  ///< header, with or without a unit: `Ch 3 [g]`
    std::optional<std::string> unit;   ///< where the file states it apart from the header
    std::vector<std::string> aliases;  ///< other names by which a column map may call it
};

/// A column that becomes a channel, or the time.
struct SelectedColumn {
    std::size_t index = 0;  ///< in the list of offered columns
    std::string name;       ///< channel, or `time`
    std::string unit;       ///< of the values in the file
    double scale = 1;       ///< value in SI = scale · number + offset
    double offset = 0;
};

struct ColumnSelection {
    std::vector<SelectedColumn> columns;    ///< in the order of the file
    std::vector<std::string> unused;        ///< texts of all others
    std::vector<std::string> without_unit;  ///< channels for which the file states no unit, taken as SI
};

/// What a column means for which neither the file nor the map states a unit.
enum class MissingUnit {
    error,      ///< always an error
    own_names,  ///< SI for a column that bears a channel's name in the file itself, otherwise an error
    si          ///< SI
};

/// A column named in the map becomes what the map says, one that bears a channel's name becomes that channel.
/// @param header_row row of the header in the file, for messages; 0 if there is none
/// @param map may be null
/// @throws InputError: no channel, no time column (unless the map says that there is none), a unit that is unknown or
///         missing, two columns for one channel, a column of the map that is not in the file or stands for several.
ColumnSelection selectColumns(const std::vector<OfferedColumn>& offered, const std::string& file, long header_row,
                              const ColumnMap* map, MissingUnit missing_unit);

/// `name [unit]`, or `name (unit)` where `parentheses` is set, taken apart.
struct ColumnHeader {
    std::string name, unit;
    bool has_unit = false;
};
ColumnHeader parseColumnHeader(const std::string& header, bool parentheses);

/// True if the column bears a channel's name, is the time, or stands in the map.
bool isKnownColumn(const std::string& text, const ColumnMap* map);

}  // namespace wems
