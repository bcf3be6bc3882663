/// @file
/// Rows of a CSV file.
#pragma once

#include <fstream>
#include <string>
#include <string_view>

#include "models/recording/csv_reader.hpp"
#include "models/recording/row_source.hpp"

namespace wems {

/// Reads a few megabytes of text at a time.
class CsvRows : public RowSource {
public:
    CsvRows(const std::string& file, const ColumnMap* map);

    const Recording& header() const override { return plan_.recording; }
    double expectedSamples() const override { return expected_samples_; }
    bool append(Recording& rows) override;

private:
    std::string_view readText();
    void parse(Recording& rows);

    std::string file_;
    std::ifstream input_;
    std::string text_;             // read and not yet parsed
    std::size_t parsed_text_ = 0;  // bytes of text_ that were
    CsvPlan plan_;
    double expected_samples_ = 0;
    bool is_first_ = true;    // the rows that came with the header are still to be parsed
    bool at_end_ = false;     // of the file
    bool past_rows_ = false;  // a blank row was read: no more may follow
};

}  // namespace wems
