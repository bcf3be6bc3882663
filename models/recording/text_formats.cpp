#include "models/recording/text_formats.hpp"

#include "models/recording/lvm_reader.hpp"
#include "models/recording/lvm_rows.hpp"
#include "models/recording/opensim_reader.hpp"
#include "models/recording/opensim_rows.hpp"
#include "models/recording/uff_reader.hpp"
#include "models/recording/uff_rows.hpp"

namespace wems {
namespace {

template <typename Rows>
std::unique_ptr<RowSource> openAs(const std::string& file, const ColumnMap* map) {
    return std::make_unique<Rows>(file, map);
}

}  // namespace

const std::vector<TextFormat>& textFormats() {
    static const std::vector<TextFormat> formats{
        {isTrc, readTrc, openAs<OpensimRows>, {".trc"}, "a line that begins with PathFileType"},
        {isLvm, readLvm, openAs<LvmRows>, {".lvm"}, "a line that begins with LabVIEW Measurement"},
        {isUniversalFile,
         readUniversalFile,
         openAs<UffRows>,
         {".uff", ".unv"},
         "a line -1, then a line with a dataset's number"},
        // Last: it looks for the end of a header anywhere in the first lines.
        {isStorage, readStorage, openAs<OpensimRows>, {".sto", ".mot"}, "a header that ends with the line endheader"}};
    return formats;
}

const TextFormat* findTextFormat(std::string_view text) {
    for (const TextFormat& format : textFormats())
        if (format.recognises(text)) return &format;
    return nullptr;
}

}  // namespace wems
