#include "models/recording/mat_extent.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "models/error.hpp"
#include "models/recording/inflate.hpp"

namespace wems {
namespace {

constexpr std::uint32_t kInt32 = 5, kUint32 = 6, kMatrix = 14, kCompressed = 15;                // types of elements
constexpr std::uint32_t kCell = 1, kStructure = 2, kSparse = 5, kLastNumeric = 15, kLast = 17;  // classes of arrays
constexpr std::size_t kHeader = 128, kTag = 8;
constexpr int kDeepest = 64;

class ExtentCheck {
public:
    ExtentCheck(std::string_view content, const std::string& file) : content_(content), file_(file) {}

    void run() {
        if (content_.substr(0, 10) == "MATLAB 5.0") {
            swapped_ = content_.substr(126, 2) == "MI";
            for (std::size_t at = kHeader; at + kTag <= content_.size();)
                at = checkElement(at, content_.size(), 0).next;
        } else {
            checkVersion4();
        }
    }

private:
    struct Element {
        std::uint32_t type = 0;
        std::size_t begin = 0, size = 0;  // of its data
        std::size_t next = 0;
    };

    std::uint32_t read(std::size_t at) const {
        if (at + 4 > content_.size()) fail(at);
        std::uint32_t word = 0;
        std::memcpy(&word, content_.data() + at, sizeof word);
        return swapped_ ? __builtin_bswap32(word) : word;
    }

    [[noreturn]] void fail(std::size_t at) const {
        throw InputError(
            {file_, 0, {}},
            "is damaged or cut off: what stands at byte " + std::to_string(at) + place_ + " reaches beyond its end",
            "a complete MATLAB file");
    }

    Element readTag(std::size_t at, std::size_t end) const {
        Element element;
        const std::uint32_t first = read(at);
        if (first >> 16U != 0) {  // up to four bytes within the tag
            element = {first & 0xFFFFU, at + 4, first >> 16U, at + kTag};
            if (element.size > 4 || element.next > end) fail(at);
            return element;
        }
        element = {first, at + kTag, read(at + 4), 0};
        if (element.size > end - std::min(end, element.begin)) fail(at);
        const std::size_t padding = first == kCompressed ? 0 : (8 - element.size % 8) % 8;
        element.next = element.begin + element.size + padding;
        return element;
    }

    Element checkElement(std::size_t at, std::size_t end, int depth) const {
        const Element element = readTag(at, end);
        if (element.type == kMatrix && element.size > 0 && depth < kDeepest) checkArray(element, depth);
        if (element.type == kCompressed) checkCompressed(element);
        return element;
    }

    /// A variable alone, which may claim more than its stream holds.
    void checkCompressed(const Element& element) const {
        const Inflated inflated = inflateAll(content_.substr(element.begin, element.size));
        ExtentCheck inside(inflated.plain, file_);
        inside.swapped_ = swapped_;
        inside.place_ = " of the variable compressed at byte " + std::to_string(element.begin);
        if (!inflated.complete)
            throw InputError({file_, 0, {}},
                             "the variable compressed at byte " + std::to_string(element.begin) + " is damaged",
                             "a complete MATLAB file");
        if (inside.readTag(0, inflated.plain.size()).type == kMatrix) inside.checkElement(0, inflated.plain.size(), 0);
    }

    void checkArray(const Element& array, int depth) const {
        const std::size_t end = array.begin + array.size;
        const Element flags = readTag(array.begin, end);
        const std::uint32_t kind = read(flags.begin) & 0xFFU;
        if (flags.type != kUint32 || flags.size != kTag || kind < kCell || kind > kLast) fail(flags.begin);
        if (kind == kSparse || kind > kLastNumeric) return;  // dimensions of another meaning, objects
        const Element dimensions = readTag(std::min(flags.next, end), end);
        // Signed by the format; some programs write them unsigned.
        if (dimensions.type != kInt32 && dimensions.type != kUint32) fail(dimensions.begin);
        double elements = 1;
        for (std::size_t k = 0; k + 4 <= dimensions.size; k += 4) elements *= read(dimensions.begin + k);
        const Element name = readTag(std::min(dimensions.next, end), end);
        std::size_t at = name.next;
        double least = 1;  // bytes of an element
        if (kind == kCell) least = kTag;
        if (kind == kStructure) {
            const Element length = readTag(std::min(at, end), end);
            const std::uint32_t field = read(length.begin);
            const Element names = readTag(std::min(length.next, end), end);
            if (length.type != kInt32 || length.size != 4 || field == 0 || names.size % field != 0) fail(length.begin);
            least = kTag * (static_cast<double>(names.size) / field);
            at = names.next;
        }
        if (elements * least > static_cast<double>(array.size)) fail(dimensions.begin);
        while (at + kTag <= end) at = checkElement(at, end, depth + 1).next;
    }

    void checkVersion4() {
        constexpr std::size_t kHead = 20;
        constexpr double kWidths[] = {8, 4, 4, 2, 2, 1};
        swapped_ = content_.size() >= 4 && read(0) > 9999;
        for (std::size_t at = 0; at + kHead <= content_.size();) {
            const std::uint32_t precision = read(at) / 10 % 10;
            if (precision > 5) fail(at);
            const double values = static_cast<double>(read(at + 4)) * read(at + 8) * (read(at + 12) != 0 ? 2 : 1);
            const double size = kHead + read(at + 16) + values * kWidths[precision];
            if (size > static_cast<double>(content_.size() - at)) fail(at);
            at += static_cast<std::size_t>(size);
        }
    }

    std::string_view content_;
    const std::string& file_;
    std::string place_;  // of the content in the file, if it is not the file itself
    bool swapped_ = false;
};

}  // namespace

void checkMatExtent(std::string_view content, const std::string& file) {
    ExtentCheck(content, file).run();
}

}  // namespace wems
