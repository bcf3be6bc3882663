#include "models/recording/hdf5_rows.hpp"

#include <algorithm>
#include <map>

#include "models/recording/hdf5_file.hpp"
#include "models/recording/separate_reader.hpp"

namespace wems {
namespace {

constexpr std::size_t kSamplesAtOnce = 8192;
constexpr std::size_t kSmall = 4096;  // numbers of an array that is read at once

/// The same samples of many channels. Where a row of the file has a sample of every channel, it is read once for all.
class Stretch {
public:
    Stretch(std::size_t first, std::size_t count) : first_(first), count_(count) {}

    std::vector<double> read(const MatSeries& series) {
        const MatValue& array = *series.array;
        if (series.down || !array.stored || array.rows == 1) return series.read(first_, count_);
        auto found = rows_.find(&array);
        if (found == rows_.end())
            found = rows_.emplace(&array, array.stored->read(0, array.rows, first_, count_)).first;
        std::vector<double> values(count_);
        for (std::size_t i = 0; i < count_; ++i) values[i] = found->second[i * array.rows + series.channel];
        return values;
    }

private:
    std::size_t first_, count_;
    std::map<const MatValue*, std::vector<double>> rows_;
};

}  // namespace

Hdf5Rows::Hdf5Rows(const std::string& file, const ColumnMap* map)
    : content_(tabulateMat(readSeparately(file, "HDF5", [&file] { return readHdf5File(file, kSmall); }), file)),
      plan_(planTable(content_.table, map)) {
    const auto count = [this](const SelectedColumn& column) { return content_.series[column.index].sampleCount(); };
    sample_count_ = checkLengths(plan_, count);
}

bool Hdf5Rows::append(Recording& rows) {
    const std::size_t count = std::min(kSamplesAtOnce, sample_count_ - samples_read_);
    if (count == 0) return false;
    Stretch part(samples_read_, count);
    for (std::size_t k = 0; k < plan_.columns.size(); ++k)
        appendValues(plan_, k, part.read(content_.series[plan_.columns[k].index]), rows);
    samples_read_ += count;
    return true;
}

}  // namespace wems
