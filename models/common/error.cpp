#include "models/common/error.hpp"

#include <algorithm>
#include <utility>

namespace wems {
namespace {

std::string compose(const InputLocation& location, const std::string& problem, const std::string& accepted) {
    std::string message;
    if (!location.file.empty()) {
        message += location.file;
        if (location.line > 0) message += ":" + std::to_string(location.line);
        message += ": ";
    }
    if (!location.key.empty()) message += location.key + ": ";
    message += problem;
    if (!accepted.empty()) message += " (accepted: " + accepted + ")";
    // Names and values come from files that may hold anything; the message stays one printable line.
    std::replace_if(
        message.begin(), message.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
    return message;
}

}  // namespace

InputError::InputError(InputLocation location, const std::string& problem, const std::string& accepted)
    : std::runtime_error(compose(location, problem, accepted)),
      location_(std::move(location)),
      problem_(problem),
      accepted_(accepted) {}

}  // namespace wems
