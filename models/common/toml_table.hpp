/// @file
/// One table of a TOML file, read key by key: type and finiteness are checked, places are remembered for messages, keys
/// that nobody asked for are an error. Internal to the model reader.
#pragma once

#include <toml++/toml.h>

#include <Eigen/Core>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace wems {

/// The file and the line of every key seen so far, by full key (`connection[0].z.stiffness`).
struct TomlPlaces {
    std::string file;
    std::map<std::string, long> line;

    /// Line of the key, or of the nearest table around it; 0 if there is none.
    long find(const std::string& key) const;
};

class TomlTable {
public:
    /// @param prefix full key of the table, empty for the root
    TomlTable(const toml::table& table, std::string prefix, TomlPlaces& places);

    bool has(const std::string& key) const { return table_.contains(key); }

    // Each reads one key and marks it as known. Absent: nullopt, or for require… an error naming the table.
    std::optional<double> findNumber(const std::string& key);
    double requireNumber(const std::string& key, const std::string& unit);
    std::optional<std::string> findString(const std::string& key);
    std::string requireString(const std::string& key, const std::string& accepted);
    std::optional<Eigen::Vector3d> findVector(const std::string& key);
    /// Texts of a list; nullopt if absent.
    std::optional<std::vector<std::string>> findStrings(const std::string& key);
    Eigen::Vector3d requireVector(const std::string& key, const std::string& unit);
    long requireInteger(const std::string& key, const std::string& accepted);
    /// Numbers of a list; every length of `lengths` is accepted.
    std::vector<double> requireNumbers(const std::string& key, const std::vector<std::size_t>& lengths,
                                       const std::string& accepted);
    /// Rows of so many numbers, at most `most` of them in each; nullopt if absent.
    std::optional<std::vector<std::vector<double>>> findRows(const std::string& key, std::size_t columns,
                                                             std::size_t most = 0);

    /// Calls `read` with the table under this key; false if there is none.
    bool readTable(const std::string& key, const std::function<void(TomlTable&)>& read);
    /// Calls `read` with each table of the list under this key; the number of them.
    std::size_t readTables(const std::string& key, const std::function<void(TomlTable&)>& read);

    [[noreturn]] void fail(const std::string& key, const std::string& problem, const std::string& accepted = {}) const;

    /// Throws on the first key that was never asked for, naming those that may stand here.
    void rejectUnknownKeys() const;

private:
    const toml::node* find(const std::string& key);
    std::string fullKey(const std::string& key) const { return prefix_.empty() ? key : prefix_ + "." + key; }
    double toNumber(const toml::node& node, const std::string& key) const;
    const toml::array& toArray(const toml::node& node, const std::string& key, const std::string& accepted) const;

    const toml::table& table_;
    std::string prefix_;
    TomlPlaces& places_;
    std::vector<std::string> asked_;
};

/// Parses the text of a file. @throws InputError with its line if it is no TOML
toml::table parseToml(std::string_view text, const std::string& file);

/// Calls `read` with the root of the TOML file `file`; a key that `read` does not ask for is an error.
/// @throws InputError: no such file, no TOML, unknown key, and what `read` throws
void readTomlFile(const std::string& file, const std::function<void(TomlTable&)>& read);

}  // namespace wems
