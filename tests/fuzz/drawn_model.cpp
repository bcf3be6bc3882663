#include "tests/fuzz/drawn_model.hpp"

#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <utility>
#include <vector>

namespace wems::fuzz {
namespace {

const std::array<std::string, 18> kNumbers{"0.0",   "-1.0", "1e300", "-1e300", "1e-300", "1e15", "1e9",  "1e6",  "1e-9",
                                           "1e-15", "nan",  "inf",   "1",      "true",   "[]",   "1e12", "1e-6", "0.5"};
const std::array<double, 10> kFactors{1e-9, 1e-4, 1e-2, 0.5, 2, 10, 1e2, 1e4, 1e9, -1};

/// Where numbers stand behind `=`, in arrays too, not in comments or texts.
std::vector<std::pair<std::size_t, std::size_t>> findNumbers(const std::string& text) {
    std::vector<std::pair<std::size_t, std::size_t>> places;
    bool quoted = false, comment = false;
    for (std::size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        if (c == '\n') quoted = comment = false;
        if (c == '#') comment = true;
        if (c == '"') quoted = !quoted;
        const bool starts = std::isdigit(static_cast<unsigned char>(c)) || c == '-';
        const char before = k > 0 ? text[k - 1] : '\n';
        if (comment || quoted || !starts || (before != ' ' && before != '[' && before != ',')) continue;
        std::size_t end = k + 1;
        while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '.' ||
                                     text[end] == '-' || text[end] == '+'))
            ++end;
        places.emplace_back(k, end - k);
        k = end - 1;
    }
    return places;
}

void changeNumber(std::string& text, DrawnBytes& bytes) {
    const auto places = findNumbers(text);
    if (places.empty()) return;
    const auto [at, length] = places[bytes.below(places.size())];
    if (bytes.below(2) == 0) {
        text.replace(at, length, bytes.pick(kNumbers));
        return;
    }
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), "%.9e",
                  bytes.pick(kFactors) * std::strtod(text.substr(at, length).c_str(), nullptr));
    text.replace(at, length, number.data());
}

std::pair<std::size_t, std::size_t> drawLine(const std::string& text, DrawnBytes& bytes) {
    std::vector<std::size_t> starts{0};
    for (std::size_t k = 0; k + 1 < text.size(); ++k)
        if (text[k] == '\n') starts.push_back(k + 1);
    const std::size_t from = starts[bytes.below(starts.size())], end = text.find('\n', from);
    return {from, end == std::string::npos ? text.size() - from : end + 1 - from};
}

void dropLine(std::string& text, DrawnBytes& bytes) {
    const auto [from, length] = drawLine(text, bytes);
    text.erase(from, length);
}

void repeatLine(std::string& text, DrawnBytes& bytes) {
    const auto [from, length] = drawLine(text, bytes);
    const std::string line = text.substr(from, length);
    text.insert(drawLine(text, bytes).first, line);
}

/// Behind the head of a table of one axis.
void addLaw(std::string& text, DrawnBytes& bytes) {
    static const std::array<std::pair<std::string, std::string>, 14> laws{{
        {"offset = ", ""},
        {"quadratic = ", ""},
        {"cubic = ", ""},
        {"loss_factor = ", ""},
        {"drift = ", ""},
        {"damping = ", ""},
        {"relaxation = { stiffness_ratio = 0.3, time_constant = ", " }"},
        {"relaxation = { time_constant = 0.01, stiffness_ratio = ", " }"},
        {"friction = { transition_velocity = 1.0e-3, force = ", " }"},
        {"friction = { force = 5.0, transition_velocity = ", " }"},
        {"hysteresis = { yield_displacement = 1.0e-4, force = ", " }"},
        {"branches = [ { time_constant = 0.01, stiffness = ", " } ]"},
        {"curve = [[-1.0e-3, ", "], [0.0, 0.0], [1.0e-3, 50.0]]"},
        {"sliders = [ { yield_displacement = 1.0e-4, force = ", ", gap = 1.0e-3 } ]"},
    }};
    std::vector<std::size_t> heads;
    for (const char* axis : {"x", "y", "z"}) {
        const std::string head = std::string("[connection.") + axis + "]\n";
        for (auto at = text.find(head); at != std::string::npos; at = text.find(head, at + 1))
            heads.push_back(at + head.size());
    }
    if (heads.empty()) return;
    const auto& [before, behind] = bytes.pick(laws);
    text.insert(heads[bytes.below(heads.size())], before + bytes.pick(kNumbers) + behind + "\n");
}

void addTable(std::string& text, DrawnBytes& bytes) {
    static const std::array<std::pair<std::string, std::string>, 9> tables{{
        {"[load]\ngain = ", "\n"},
        {"[load]\npart = \"mobile\"\nposition = [0.0, 0.0, ", "]\n"},
        {"[[sensor]]\nchannel = \"mobile.1.az\"\ngain = ", "\n"},
        {"[[sensor]]\nchannel = \"mobile\"\ndelay = ", "\n"},
        {"[[sensor]]\nchannel = \"fixed.1\"\nrotation = [0.0, 0.01, ", "]\n"},
        {"[tolerance]\nstiffness = ", "\n"},
        {"[tolerance]\nmass = 0.0\nsensor_gain = ", "\n"},
        {"[tolerance]\ncenter_of_gravity = ", "\n"},
        {"[[bracket.mode]]\nindex = 1\ndamping_ratio = 0.01\nfrequency = ", "\n"},
    }};
    const auto& [before, behind] = bytes.pick(tables);
    text += "\n" + before + bytes.pick(kNumbers) + behind;
}

}  // namespace

std::string makeOddModel(std::string toml, DrawnBytes& bytes) {
    static const std::array<void (*)(std::string&, DrawnBytes&), 8> oddities{
        changeNumber, changeNumber, changeNumber, dropLine, repeatLine, addLaw, addLaw, addTable};
    for (std::size_t left = bytes.below(5); left > 0; --left) bytes.pick(oddities)(toml, bytes);
    return toml;
}

}  // namespace wems::fuzz
