#include "models/command_line/usage.hpp"

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "models/common/atomic_file.hpp"
#include "models/common/error.hpp"

namespace wems {

namespace {

constexpr const char* file_type = "FILE";

/// CLI11's own ranges list their limits with 300 digits.
CLI::Validator accept(const std::string& name, const std::string& accepted, bool (*fits)(double)) {
    return CLI::Validator(
        [accepted, fits](std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            const bool right = end != text.c_str() && *end == '\0' && fits(value);
            return right ? std::string() : "'" + text + "' is not " + accepted;
        },
        name);
}

/// An output that another option reads or writes, too. All words of the command line are known by now.
void checkAgainstOthers(const CLI::App& app, const CLI::Option* output, const std::string& path) {
    for (const CLI::Option* other : app.get_options()) {
        if (other == output || other->get_type_name() != file_type) continue;
        for (const std::string& file : other->results())
            if (file != "-" && isSameFile(path, file))
                throw InputError({path, 0, {}}, "is given to " + output->get_name() + " and to " + other->get_name(),
                                 "another name for the output");
    }
}

std::string listCommands(const CLI::App& app) {
    std::string list;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        if (!command->get_name().empty()) list += (list.empty() ? "" : ", ") + command->get_name();
    return list;
}

}  // namespace

std::string describeUsageError(const CLI::App& app, const CLI::ParseError& error) {
    const auto called = app.get_subcommands();
    const std::string commands = listCommands(app);
    if (called.empty() && !commands.empty()) {
        const auto unknown = app.remaining();
        return (unknown.empty() ? "no command is given" : "'" + unknown.front() + "' is not a command") +
               " (accepted: " + commands + ")";
    }
    const std::string command = app.get_name() + (called.empty() ? "" : " " + called.front()->get_name());
    return std::string(error.what()) + " (" + command + " --help lists the options)";
}

CLI::Validator isPositive() {
    return accept("POSITIVE", "a number above 0", [](double value) { return value > 0; });
}

CLI::Validator isNonNegative() {
    return accept("NONNEGATIVE", "a number from 0 on", [](double value) { return value >= 0; });
}

CLI::Option* addOutputFile(CLI::App& app, const std::string& name, std::string& file, const std::string& help,
                           bool dash_is_output) {
    CLI::Option* option = app.add_option(name, file, help)->type_name(file_type);
    return option->each([&app, option, dash_is_output](const std::string& path) {
        if (dash_is_output && path == "-") return;
        checkAgainstOthers(app, option, path);
        AtomicFile::checkWritable(path);
    });
}

namespace {

std::vector<const CLI::App*> commandsOf(const CLI::App& app) {
    return app.get_subcommands([](const CLI::App*) { return true; });
}

/// `-o --output --json …`, hidden options left out.
std::string listOptions(const CLI::App& app) {
    std::string words;
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_group().empty()) continue;
        for (const auto& name : option->get_snames()) words += "-" + name + " ";
        for (const auto& name : option->get_lnames()) words += "--" + name + " ";
    }
    return words;
}

/// The values out of a type name such as `TEXT:{x,y,z}`; empty if anything goes.
std::string listValues(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const auto open = type.find('{'), close = type.rfind('}');
    if (open == std::string::npos || close == std::string::npos) return "";
    std::string values = type.substr(open + 1, close - open - 1);
    std::replace(values.begin(), values.end(), ',', ' ');
    return values;
}

/// A branch of `case "$command $previous"` for each option that takes one of a few values.
std::string formatValueCases(const CLI::App& app, const std::string& command) {
    std::string cases;
    for (const CLI::Option* option : app.get_options()) {
        const std::string values = listValues(*option);
        if (values.empty()) continue;
        for (const auto& name : option->get_lnames())
            cases += "        '" + command + " --" + name + "') words='" + values + "' ;;\n";
    }
    return cases;
}

}  // namespace

std::string formatBashCompletion(const CLI::App& app, const std::string& program) {
    std::string function = "_" + program;
    std::replace_if(
        function.begin(), function.end(), [](char c) { return c == '-' || c == '.'; }, '_');
    std::string names, options, values = formatValueCases(app, "");
    for (const CLI::App* command : commandsOf(app)) {
        names += command->get_name() + " ";
        options += "            " + command->get_name() + ") words='" + listOptions(*command) + "' ;;\n";
        values += formatValueCases(*command, command->get_name());
    }
    options += "            '') words='" + listOptions(app) + names + "' ;;\n";
    // What does not begin with a dash is a file, which bash completes by itself; but the first word may be a command.
    const std::string command = names.empty() ? "" : R"(
    case " )" + names + R"( " in *" ${COMP_WORDS[1]} "*) [ "$COMP_CWORD" -gt 1 ] && command=${COMP_WORDS[1]} ;; esac)";
    const std::string is_file = names.empty() ? "$current != -*" : "$current != -* && -n $command";
    return "# bash completion of " + program + "\n" + function + R"(() {
    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command='' words='')" +
           command + R"(
    case "$command $previous" in
)" + values +
           R"(    esac
    if [[ -z $words ]]; then
        if [[ )" +
           is_file + R"( ]]; then return; fi
        case "$command" in
)" + options +
           R"(        esac
    fi
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}
complete -o default -F )" +
           function + " " + program + "\n";
}

std::string programName(const std::string& call) {
    return call.substr(call.rfind('/') + 1);
}

void addCompletionOption(CLI::App& app) {
    app.add_option_function<std::string>(
           "--completion",
           [&app](const std::string& program) { throw CLI::CallForVersion(formatBashCompletion(app, program), 0); })
        ->group("");
}

}  // namespace wems
