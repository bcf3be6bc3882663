#include "models/recording/uff_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "models/error.hpp"
#include "models/recording/uff_function.hpp"

namespace wems {
namespace {

constexpr double kSameTime = 1e-6;  // of the interval

bool isMark(std::string_view line) {
    return uffField(line, 0, line.size()) == "-1";
}

/// Units of a dataset 164 by its code: length, force.
std::pair<const char*, const char*> findSystem(long code) {
    switch (code) {
        case 1:
            return {"m", "N"};
        case 5:
            return {"mm", "mN"};
        case 7:
            return {"in", "lbf"};
        case 10:
            return {"mm", "N"};
        default:
            return {nullptr, nullptr};
    }
}

/// The unit of an ordinate without label; nothing if the file does not say.
std::optional<std::string> findUnit(int kind, long system) {
    const auto [length, force] = findSystem(system);
    if (length == nullptr) return std::nullopt;
    switch (kind) {
        case 8:
            return length;
        case 11:
            return std::string(length) + "/s";
        case 12:
            return std::string(length) + "/s^2";
        case 9:
        case 13:
            return force;
        default:
            return std::nullopt;
    }
}

class UniversalFile {
public:
    UniversalFile(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

    RecordingTable read() {
        while (!lines_.atEnd()) {
            if (isMark(lines_.take()) && !lines_.atEnd()) readDataset();
        }
        const auto first = std::find_if(functions_.begin(), functions_.end(),
                                        [](const UffFunction& function) { return function.isTimeResponse(); });
        if (first == functions_.end())
            throw InputError({file_, 0, {}},
                             functions_.empty() ? "there is no dataset 58" : "no dataset 58 is a time response",
                             "functions of type 1 over time");
        return makeTable(*first);
    }

private:
    void readDataset() {
        const auto line = lines_.take();
        const auto number = uffField(line, 0, 6);
        if (number == "58") {
            UffStorage storage;
            storage.binary = line.size() > 6 && (line[6] == 'b' || line[6] == 'B');
            if (storage.binary) {
                storage.big_endian = integer(line, 7, 6) != 1;
                storage.floating_format = static_cast<int>(integer(line, 13, 6));
                storage.bytes = integer(line, 31, 12);
                binary_ = true;
            }
            functions_.push_back(readUffFunction(lines_, storage, file_));
            // A binary part may end without a line end.
            skipToMark();
            return;
        }
        if (number == "164" && !lines_.atEnd()) system_ = integer(lines_.take(), 0, 10);
        skipToMark();
    }

    long integer(std::string_view line, std::size_t from, std::size_t width) const {
        return uffInteger(line, from, width, file_, lines_.line());
    }

    void skipToMark() {
        while (!lines_.atEnd()) {
            if (isMark(lines_.take())) return;
        }
    }

    static std::vector<double> calcTime(const UffFunction& function) {
        std::vector<double> time(function.values.size());
        for (std::size_t i = 0; i < time.size(); ++i) time[i] = function.time(i);
        return time;
    }

    static bool haveSameTime(const UffFunction& a, const UffFunction& b) {
        if (a.even != b.even || a.values.size() != b.values.size()) return false;
        if (!a.even) return a.abscissa == b.abscissa;
        const double tolerance = kSameTime * std::abs(a.step);
        return std::abs(a.start - b.start) <= tolerance &&
               std::abs(a.step - b.step) * static_cast<double>(a.values.size()) <= tolerance;
    }

    RecordingTable makeTable(const UffFunction& first) const {
        RecordingTable table;
        table.file = file_;
        table.format = binary_ ? "UFF 58b" : "UFF 58";
        if (first.even && !(first.step > 0) && first.values.size() > 1)
            throw InputError({file_, 0, first.name()}, "the time step is not above zero");
        table.columns.push_back({"time", first.abscissa_unit.empty() ? "s" : first.abscissa_unit, {}});
        table.values.push_back(calcTime(first));
        table.metadata["id"] = first.id;
        for (const auto& function : functions_) {
            const std::string name = function.name();
            if (!function.isTimeResponse() || !haveSameTime(first, function)) {
                table.warnings.push_back(name + " (" + function.id + ") is not read: " +
                                         (function.isTimeResponse() ? "its times are not those of " + first.name()
                                                                    : std::string("it is no time response")));
                continue;
            }
            const bool single = std::count_if(functions_.begin(), functions_.end(), [&](const UffFunction& other) {
                                    return other.isTimeResponse() && other.name() == name;
                                }) == 1;
            const std::string full_name = name + " " + function.kind();
            OfferedColumn column{single ? name : full_name, {}, {function.id, full_name}};
            column.unit =
                function.unit.empty() ? findUnit(function.ordinate_kind, system_) : std::optional(function.unit);
            table.columns.push_back(std::move(column));
            table.values.push_back(function.values);
        }
        return table;
    }

    LineCursor lines_;
    const std::string& file_;
    std::vector<UffFunction> functions_;
    long system_ = 0;
    bool binary_ = false;
};

}  // namespace

bool isUniversalFile(std::string_view text) {
    LineCursor lines(text.substr(0, 4096));
    std::string_view line;
    while (!lines.atEnd()) {
        line = lines.take();
        if (!uffField(line, 0, line.size()).empty()) break;
    }
    if (!isMark(line) || lines.atEnd()) return false;
    const auto number = uffField(lines.take(), 0, 6);
    return !number.empty() && number.find_first_not_of("0123456789") == std::string_view::npos;
}

RecordingTable readUniversalFile(std::string_view text, const std::string& file) {
    return UniversalFile(text, file).read();
}

}  // namespace wems
