#include "models/command_line/usage.hpp"

#include <cstdlib>

#include "models/atomic_file.hpp"
#include "models/error.hpp"

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

}  // namespace wems
