#include "models/result/result_record.hpp"

#include <openssl/evp.h>

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <vector>

#include "models/common/format_number.hpp"
#include "models/model_tolerance.hpp"

namespace wems {

std::optional<std::string> calcChecksum(const std::string& file) {
    std::error_code problem;
    if (!std::filesystem::is_regular_file(file, problem)) return std::nullopt;
    std::ifstream stream(file, std::ios::binary);
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    if (!stream || !context || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) return std::nullopt;
    constexpr std::size_t piece = std::size_t{1} << 20;
    std::vector<char> bytes(piece);
    while (stream.read(bytes.data(), static_cast<std::streamsize>(piece)) || stream.gcount() > 0)
        if (EVP_DigestUpdate(context.get(), bytes.data(), stream.gcount()) != 1) return std::nullopt;
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int length = 0;
    if (!stream.eof() || EVP_DigestFinal_ex(context.get(), digest.data(), &length) != 1) return std::nullopt;
    std::string text;
    for (unsigned int i = 0; i < length; ++i) {
        constexpr const char* digits = "0123456789abcdef";
        text += digits[digest[i] >> 4U];
        text += digits[digest[i] & 15U];
    }
    return text;
}

namespace {

/// Adds `column` to each object that names a channel of the user's map.
void addColumnNames(nlohmann::json& value, const std::map<std::string, std::string>& columns) {
    if (value.is_structured())
        for (auto& part : value) addColumnNames(part, columns);
    if (!value.is_object()) return;
    for (const char* key : {"channel", "name"}) {
        const auto named = value.find(key);
        if (named == value.end() || !named->is_string()) continue;
        if (const std::string* column = findColumn(columns, named->get<std::string>())) value["column"] = *column;
    }
    const auto where = value.find("where");
    if (where == value.end() || !where->is_array()) return;
    for (const auto& place : *where)
        if (const std::string* column = place.is_string() ? findColumn(columns, place.get<std::string>()) : nullptr)
            value["columns"][place.get<std::string>()] = *column;
}

void addItem(nlohmann::json& list, const std::string& item, const Tolerances& given) {
    for (std::size_t k = 0; k < kToleranceKeys.size(); ++k)
        if (const auto value = given.find(static_cast<ToleranceOf>(k)))
            list.push_back({{"of", kToleranceKeys[k].key},
                            {"item", item},
                            {"value", *value},
                            {"unit", kToleranceKeys[k].unit},
                            {"source", "item"}});
}

}  // namespace

void ResultRecord::addInput(const std::string& role, const std::string& file, bool in_memory) {
    if (!file.empty() || in_memory) inputs.push_back({role, file, in_memory});
}

void ResultRecord::addColumns(const ColumnMap& map) {
    for (const MappedColumn& mapped : map.columns)
        if (mapped.channel != "time") columns[mapped.channel] = mapped.column;
}

void addRecord(nlohmann::json& result, const ResultRecord& record) {
    addColumnNames(result, record.columns);
    auto inputs = nlohmann::json::array();
    for (const InputRecord& input : record.inputs) {
        const auto checksum = input.in_memory ? std::nullopt : calcChecksum(input.file);
        inputs.push_back({{"role", input.role},
                          {"file", input.file},
                          {"sha256", checksum ? nlohmann::json(*checksum) : nlohmann::json()}});
    }
    result["version"] = kResultVersion;
    result["program"] = record.program;
    result["command"] = record.command;
    result["inputs"] = std::move(inputs);
    result["options"] = record.options;
    if (!record.tolerances.is_null()) result["tolerances"] = record.tolerances;
    if (!record.columns.empty()) result["columns"] = record.columns;
}

nlohmann::json listTolerances(const MountModel& model) {
    auto list = nlohmann::json::array();
    for (std::size_t k = 0; k < kToleranceKeys.size(); ++k) {
        const auto what = static_cast<ToleranceOf>(k);
        list.push_back({{"of", kToleranceKeys[k].key},
                        {"item", ""},
                        {"value", toleranceOf(model, what)},
                        {"unit", kToleranceKeys[k].unit},
                        {"source", model.tolerances.find(what) ? "model" : "default"}});
    }
    addItem(list, "body", model.body.tolerances);
    for (const Connection& connection : model.connections) {
        addItem(list, connection.name, connection.tolerances);
        for (std::size_t axis = 0; axis < 3; ++axis)
            addItem(list, connection.name + "." + kAxes[axis], connection.axis_tolerances[axis]);
    }
    for (std::size_t mode = 0; mode < model.bracket.size(); ++mode)
        addItem(list, "bracket mode " + std::to_string(mode + 1), model.bracket[mode].tolerances);
    for (const SensorFault& sensor : model.sensors) addItem(list, sensor.channel, sensor.tolerances);
    return list;
}

const std::string* findColumn(const std::map<std::string, std::string>& columns, const std::string& name) {
    for (std::string part = name; !part.empty();) {
        if (const auto found = columns.find(part); found != columns.end()) return &found->second;
        const auto dot = part.rfind('.');
        if (dot == std::string::npos) return nullptr;
        part.resize(dot);
    }
    return nullptr;
}

}  // namespace wems
