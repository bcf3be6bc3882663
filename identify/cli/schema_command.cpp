// identify schema: what the JSON of a command looks like, as a JSON Schema.
#include <iostream>
#include <memory>

#include "identify/cli/command.hpp"
#include "identify/commands/schemas.hpp"

namespace wems::identify::cli {

void addSchemaCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("schema", "Print the JSON Schema of what a command writes with --json");
    const auto name = std::make_shared<std::string>();
    command->add_option("command", *name, "the command")->required()->check(CLI::IsMember(listSchemas()));
    command->footer("Example:\n  identify schema diagnose > diagnose.schema.json");
    command->callback([name] {
        OutputFiles outputs;
        std::cout << makeSchema(*name).dump(2) << "\n";
        finishOutput(outputs);
    });
}

}  // namespace wems::identify::cli
