#include "models/recording/uff_reader.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "models/common/error.hpp"
#include "models/common/text_file.hpp"
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

bool haveSameTime(const UffFunction& a, const UffFunction& b) {
    if (a.even != b.even || a.points != b.points) return false;
    if (!a.even) return a.abscissa == b.abscissa;
    const double tolerance = kSameTime * std::abs(a.step);
    return std::abs(a.start - b.start) <= tolerance &&
           std::abs(a.step - b.step) * static_cast<double>(a.points) <= tolerance;
}

std::vector<double> calcTime(const UffFunction& function) {
    std::vector<double> time(function.values.size());
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = function.time(i);
    return time;
}

/// Walks through the datasets of a file.
class DatasetWalk {
public:
    DatasetWalk(std::string_view text, const std::string& file) : lines_(text), file_(file) {}

    /// @param read takes the cursor behind the line with the number of a dataset 58, leaves it where the closing mark
    ///             is to be looked for
    /// @param pass called now and then
    template <typename Read, typename Pass>
    void walk(const Read& read, const Pass& pass) {
        while (!lines_.atEnd()) {
            if (isMark(lines_.take()) && !lines_.atEnd()) readDataset(read, pass);
        }
    }

    long system() const { return system_; }
    bool anyBinary() const { return binary_; }

private:
    template <typename Read, typename Pass>
    void readDataset(const Read& read, const Pass& pass) {
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
            read(lines_, storage);
        } else if (number == "164" && !lines_.atEnd()) {
            system_ = integer(lines_.take(), 0, 10);
        }
        // A binary part may end without a line end.
        skipToMark(pass);
    }

    long integer(std::string_view line, std::size_t from, std::size_t width) const {
        return uffInteger(line, from, width, file_, lines_.line());
    }

    template <typename Pass>
    void skipToMark(const Pass& pass) {
        constexpr long kLinesBetween = 1 << 17;
        while (!lines_.atEnd()) {
            if (isMark(lines_.take())) break;
            if (lines_.line() % kLinesBetween == 0) pass();
        }
        pass();
    }

    LineCursor lines_;
    const std::string& file_;
    long system_ = 0;
    bool binary_ = false;
};

UffTable makeUffTable(const std::vector<UffFunction>& functions, long system, bool binary, const std::string& file) {
    const auto found = std::find_if(functions.begin(), functions.end(),
                                    [](const UffFunction& function) { return function.isTimeResponse(); });
    if (found == functions.end())
        throw InputError({file, 0, {}},
                         functions.empty() ? "there is no dataset 58" : "no dataset 58 is a time response",
                         "functions of type 1 over time");
    const UffFunction& first = *found;
    UffTable result;
    RecordingTable& table = result.table;
    table.file = file;
    table.format = binary ? "UFF 58b" : "UFF 58";
    if (first.even && !(first.step > 0) && first.points > 1)
        throw InputError({file, 0, first.name()}, "the time step is not above zero");
    table.columns.push_back({"time", first.abscissa_unit.empty() ? "s" : first.abscissa_unit, {}});
    table.metadata["id"] = first.id;
    for (const auto& function : functions) {
        const std::string name = function.name();
        if (!function.isTimeResponse() || !haveSameTime(first, function)) {
            table.warnings.push_back(name + " (" + function.id + ") is not read: " +
                                     (function.isTimeResponse() ? "its times are not those of " + first.name()
                                                                : std::string("it is no time response")));
            continue;
        }
        const bool single = std::count_if(functions.begin(), functions.end(), [&](const UffFunction& other) {
                                return other.isTimeResponse() && other.name() == name;
                            }) == 1;
        const std::string full_name = name + " " + function.kind();
        OfferedColumn column{single ? name : full_name, {}, {function.id, full_name}};
        column.unit = function.unit.empty() ? findUnit(function.ordinate_kind, system) : std::optional(function.unit);
        table.columns.push_back(std::move(column));
        result.functions.push_back(&function - functions.data());
    }
    return result;
}

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

UffIndex indexUniversalFile(std::string_view text, const std::string& file, const std::function<void()>& pass) {
    UffIndex index;
    DatasetWalk walk(text, file);
    walk.walk(
        [&](LineCursor& lines, const UffStorage& storage) {
            index.extents.emplace_back();
            index.functions.push_back(readUffHeader(lines, storage, file, index.extents.back()));
        },
        pass);
    index.table = makeUffTable(index.functions, walk.system(), walk.anyBinary(), file);
    return index;
}

RecordingTable readUniversalFile(std::string_view text, const std::string& file) {
    std::vector<UffFunction> functions;
    DatasetWalk walk(text, file);
    walk.walk([&](LineCursor& lines,
                  const UffStorage& storage) { functions.push_back(readUffFunction(lines, storage, file)); },
              [] {});
    UffTable result = makeUffTable(functions, walk.system(), walk.anyBinary(), file);
    result.table.values.push_back(calcTime(functions[result.functions.front()]));
    for (const std::size_t f : result.functions) result.table.values.push_back(std::move(functions[f].values));
    return std::move(result.table);
}

namespace {

constexpr std::size_t kPointsAtOnce = 8192;

}  // namespace

UffRows::UffRows(const std::string& file, const ColumnMap* map) : file_(file), text_(file, TextFile::Pages::as_needed) {
    UffIndex index = indexUniversalFile(skipByteOrderMark(text_.view()), file_, [this] { text_.release(); });
    plan_ = planTable(index.table.table, map);
    const auto open = [&](std::size_t function) {
        series_.push_back(
            {index.functions[function], UffNumberReader(index.functions[function], index.extents[function], file_)});
    };
    // The time is that of the first function, whichever are used.
    open(index.table.functions.front());
    for (const SelectedColumn& column : plan_.columns) {
        const std::size_t function = column.index == 0 ? 0 : column.index - 1;
        used_.push_back(function == 0 ? 0 : series_.size());
        if (function != 0) open(index.table.functions[function]);
    }
    point_count_ = series_.front().function.points;
    text_.release();
}

bool UffRows::append(Recording& rows) {
    const std::size_t points = std::min(kPointsAtOnce, point_count_ - points_read_);
    if (points == 0) return false;
    for (Series& series : series_) series.reader.read(points_read_ + points, series.function);
    UffFunction& first = series_.front().function;
    std::vector<double> time(points);
    for (std::size_t i = 0; i < points; ++i) time[i] = first.even ? first.time(points_read_ + i) : first.abscissa[i];
    for (Series& series : series_) {
        auto& abscissa = series.function.abscissa;
        if (first.even) continue;
        if (!std::equal(time.begin(), time.end(), abscissa.begin()))
            throw InputError({file_, static_cast<long>(points_read_) + 1, series.function.name()},
                             "its times are not those of " + first.name(),
                             "responses of the same times in a recording that is longer than the memory");
        abscissa.erase(abscissa.begin(), abscissa.begin() + static_cast<std::ptrdiff_t>(points));
    }
    std::vector<std::vector<double>> values;
    for (Series& series : series_) values.push_back(takeValues(series, points));
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, plan_.columns[k].index == 0 ? time : values[used_[k]], rows);
    points_read_ += points;
    text_.release();
    return true;
}

std::vector<double> UffRows::takeValues(Series& series, std::size_t points) const {
    auto& pending = series.function.values;
    const auto end = pending.begin() + static_cast<std::ptrdiff_t>(points);
    std::vector<double> values(pending.begin(), end);
    pending.erase(pending.begin(), end);
    return values;
}

}  // namespace wems
