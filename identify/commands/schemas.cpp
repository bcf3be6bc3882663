#include "identify/commands/schemas.hpp"

#include <utility>

#include "models/common/error.hpp"
#include "models/common/format_number.hpp"

namespace wems::identify::commands {
namespace {

constexpr const char* kShared = "definitions";

}  // namespace

std::vector<std::string> listSchemas() {
    std::vector<std::string> commands;
    for (const auto& [name, text] : schemaTexts())
        if (name != kShared) commands.push_back(name);
    return commands;
}

nlohmann::json makeSchema(const std::string& command) {
    const auto found = schemaTexts().find(command);
    if (found == schemaTexts().end() || command == kShared)
        throw InputError({}, "there is no schema of `" + command + "`", joinWords(listSchemas()));
    const auto shared = nlohmann::json::parse(schemaTexts().at(kShared));
    auto schema = nlohmann::json::parse(found->second);
    if (const auto like = schema.find("like"); like != schema.end()) {
        auto same = nlohmann::json::parse(schemaTexts().at(*like));
        schema.erase(like);
        same.update(schema);
        schema = std::move(same);
    }
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema";
    schema["$defs"] = shared.at("$defs");
    schema["properties"].update(shared.at("record").at("properties"));
    for (const auto& name : shared.at("record").at("required")) schema["required"].push_back(name);
    return schema;
}

}  // namespace wems::identify::commands
