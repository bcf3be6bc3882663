/// @file
/// What a result rests on, in every result that a program writes as JSON:
///
///     {"version": 2, "program": "wems identify 0.1.0", "command": "fit",
///      "inputs": [{"role": "recording", "file": "run.csv", "sha256": "…"}],
///      "options": {"use": "all"},
///      "tolerances": [{"of": "stiffness", "item": "1.z", "value": 0.02, "unit": "-", "source": "item"}],
///      "columns": {"mobile.1.az": "ACC 17 Z"}}
///
/// `tolerances` where the answer used any, `columns` where a column map was given; then every object that names such a
/// channel, or a parameter of it, has the user's own name beside it as `column`.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/mount_model.hpp"
#include "models/recording/column_map.hpp"

namespace wems {

// What tells a file that was read from another one of the same name.

/// SHA-256 of a file's bytes (FIPS 180-4), 64 hexadecimal digits. Nothing for what cannot be read a second time: a
/// pipe, a device, a file that is gone.
std::optional<std::string> calcChecksum(const std::string& file);

/// Of the layout of all results.
inline constexpr int kResultVersion = 2;

struct InputRecord {
    std::string role;        ///< `recording`, `validation`, `model` …
    std::string file;        ///< or what a recording in memory is called
    bool in_memory = false;  ///< then it has no checksum
};

struct ResultRecord {
    std::string program, command;
    std::vector<InputRecord> inputs;
    nlohmann::json options = nlohmann::json::object();  ///< of the question, those left at their defaults too
    nlohmann::json tolerances;                          ///< null: none were used
    std::map<std::string, std::string> columns;         ///< the user's name of each channel

    /// Leaves out what has no name.
    void addInput(const std::string& role, const std::string& file, bool in_memory = false);
    void addColumns(const ColumnMap& map);
};

/// Adds the record to a result, with the checksums of its inputs as they are now.
void addRecord(nlohmann::json& result, const ResultRecord& record);

/// Each tolerance that a diagnosis of the model works with: those of the model or their defaults, then those of items.
nlohmann::json listTolerances(const MountModel& model);

/// The user's name of a channel (`mobile.1.az`) or of the channel that a parameter is of (`mobile.1.az.gain`); nullptr
/// without.
const std::string* findColumn(const std::map<std::string, std::string>& columns, const std::string& name);

}  // namespace wems
