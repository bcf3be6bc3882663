/// @file
/// JSON Schemas (draft 2020-12) of the results of the commands.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace wems::identify::commands {

/// The files of the folder `schema`: of each command its own part, of `definitions` what all share. `like` names the
/// command whose part is the same but for the keys beside it. Those of simulate are there too, so that one command
/// prints them all.
const std::map<std::string, std::string>& schemaTexts();

/// Commands that have a schema.
std::vector<std::string> listSchemas();

/// The whole schema of a command's result. @throws InputError listing the commands
nlohmann::json makeSchema(const std::string& command);

}  // namespace wems::identify::commands
