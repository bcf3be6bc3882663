/// @file
/// From the columns that a file offers to the channels of a recording: names, units, the laboratory's own names.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/recording/column_map.hpp"

namespace wems {

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
