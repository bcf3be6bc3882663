// identify set: a model with some of its parameters changed, by the names that results use.
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>

#include "identify/cli/command.hpp"
#include "identify/commands/recordings.hpp"
#include "identify/commands/schemas.hpp"
#include "models/command_line/usage.hpp"
#include "models/common/error.hpp"
#include "models/parameter_access.hpp"
#include "models/report/html_report.hpp"

namespace wems::identify::cli {

namespace {

constexpr const char* kChangeForms = "NAME=VALUE, NAME*=FACTOR or NAME+=ADDEND with numbers in SI units";

struct SetOptions {
    CommonOptions common;
    std::string model, output;
    std::vector<std::string> changes;
};

/// One of the command line's changes: `1.z.stiffness*=1.05`.
struct Change {
    std::string text, name;
    char operation = '=';  // '=', '*' or '+'
    double number = 0;
};

Change parseChange(const std::string& text) {
    Change change;
    change.text = text;
    const std::size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0) throw InputError({"", 0, text}, "is no change", kChangeForms);
    std::size_t end = equals;
    if (text[equals - 1] == '*' || text[equals - 1] == '+') {
        change.operation = text[equals - 1];
        --end;
    }
    change.name = text.substr(0, end);
    const std::string number = text.substr(equals + 1);
    char* rest = nullptr;
    change.number = std::strtod(number.c_str(), &rest);
    if (change.name.empty() || number.empty() || *rest != '\0' || std::isnan(change.number))
        throw InputError({"", 0, text}, "is no change", kChangeForms);
    return change;
}

double apply(const Change& change, double before) {
    if (change.operation == '*') return before * change.number;
    if (change.operation == '+') return before + change.number;
    return change.number;
}

void runSet(const SetOptions& options) {
    OutputFiles outputs;
    MountModel model = readDeviceModel(options.model, options.common.geometry);
    protectInputs({model.bracket_path}, options.output, options.common, outputs);
    Table table({"parameter", "before", "after", "unit"});
    auto parameters = nlohmann::json::array();
    for (const std::string& text : options.changes) {
        const Change change = parseChange(text);
        try {
            const double before = getParameter(model, change.name), after = apply(change, before);
            setParameter(model, change.name, after);
            const std::string unit = parameterUnit(change.name);
            table.addRow({change.name, formatNumber(before, 6), formatNumber(after, 6), unit});
            parameters.push_back({{"name", change.name},
                                  {"before", numberOrNull(before)},
                                  {"value", numberOrNull(after)},
                                  {"unit", unit}});
        } catch (const InputError& error) {
            throw InputError({"", 0, text}, error.problem(), error.accepted());
        }
    }
    try {
        writeMountModel(model, options.output, outputs);
    } catch (const InputError& error) {
        if (!error.location().file.empty()) throw;
        throw InputError({options.model, 0, error.location().key}, "as changed: " + error.problem(), error.accepted());
    }
    if (!options.common.json_file.empty()) {
        ResultRecord record = beginRecord("set");
        record.addInput("model", options.model);
        record.options = {{"changes", options.changes}};
        nlohmann::json result{{"model", options.output}, {"parameters", parameters}};
        addRecord(result, record);
        writeJson(result, options.common, outputs);
    }
    if (!options.common.report_file.empty()) {
        HtmlReport page("Changed parameters: " + model.name);
        page.addTable(table.header(), table.rows());
        page.write(options.common.report_file, outputs);
    }
    if (options.common.printsText()) std::cout << table.format(outputStyle());
    finishOutput(outputs);
}

}  // namespace

void addSetCommand(CLI::App& app, int& /*exit_status*/) {
    auto* command = app.add_subcommand("set", "Change parameters of a model, by the names that results use");
    const auto options = std::make_shared<SetOptions>();
    addInputFile(*command, "model", options->model, "mount model (TOML)")->required();
    command->add_option("changes", options->changes, kChangeForms)->required();
    addOutputFile(*command, "-o,--output", options->output, "the changed model (TOML)")->required();
    addResultOptions(*command, options->common);
    addGeometryOption(*command, options->common);
    command->footer(
        "Example:\n"
        "  identify set believed.toml 1.z.stiffness=95000 '4.z.damping*=1.1' body.center_of_gravity.z+=0.001 -o "
        "changed.toml");
    command->callback([options] { runSet(*options); });
}

// identify schema: what the JSON of a command looks like, as a JSON Schema.

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
