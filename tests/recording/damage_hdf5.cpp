// Damaged HDF5 files, drawn from a seed: each must be read or refused in one line, within the reader's limits, and none
// may end this program, which reads them as every command does (whole, and in blocks).
//   damage_hdf5 SEED COUNT FILE …     beside the files one that is compressed in pieces
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "models/common/error.hpp"
#include "models/recording/column_map.hpp"
#include "models/recording/recording_reader.hpp"
#include "models/recording/recording_stream.hpp"
#include "tests/recording/hdf5_sample.hpp"
#include "tests/recording/temporary_file.hpp"

namespace {

using Random = std::mt19937_64;

std::size_t below(std::size_t end, Random& random) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
}

/// Half of the damage falls upon the first two kilobytes, where the structure of a small file stands.
std::size_t drawPlace(const std::string& bytes, Random& random) {
    constexpr std::size_t kStructure = 2048;
    return below(random() % 2 == 0 ? std::min(bytes.size(), kStructure) : bytes.size(), random);
}

/// Cut, bytes flipped, a number in place of another, a piece moved over another.
std::string damage(std::string bytes, Random& random) {
    switch (random() % 8) {
        case 0:
            bytes.resize(below(bytes.size(), random));
            return bytes;
        case 1: {
            const std::size_t length = std::min<std::size_t>(1 + below(64, random), bytes.size() / 4);
            const std::size_t from = below(bytes.size() - length, random), to = below(bytes.size() - length, random);
            bytes.replace(to, length, std::string(bytes, from, length));
            return bytes;
        }
        case 2:
        case 3: {  // an address, a size or a count
            constexpr std::uint64_t values[] = {0,    1, 0x7f, 0xff, 0xffff, 0x7fffffff, 0xffffffff, 0x7fffffffffffffff,
                                                ~0ULL};
            const std::uint64_t value = values[below(std::size(values), random)];
            const std::size_t width = std::size_t{1} << below(4, random), at = drawPlace(bytes, random);
            for (std::size_t k = 0; k < width && at + k < bytes.size(); ++k)
                bytes[at + k] = static_cast<char>(static_cast<unsigned char>(value >> (8 * k)));
            return bytes;
        }
        default:
            for (std::size_t left = 1 + below(8, random); left > 0; --left)
                bytes[drawPlace(bytes, random)] ^= static_cast<char>(1U << below(8, random));
            return bytes;
    }
}

void readWhole(const std::string& file, bool in_blocks, const wems::ColumnMap* map) {
    if (!in_blocks) {
        wems::readRecording(file, map);
        return;
    }
    constexpr std::size_t block = 100;  // rows
    wems::RecordingStream stream(file, map, block);
    wems::Recording part;
    while (stream.next(part)) {
    }
}

bool isRead(const std::string& file, const wems::ColumnMap* map) {
    try {
        readWhole(file, false, map);
        readWhole(file, true, map);
        return true;
    } catch (const wems::InputError&) {
        return false;
    }
}

/// Compressed in pieces, as MATLAB writes it.
void writeCompressed(const std::string& file) {
    const wems::test::Hdf5Sample sample(file);
    constexpr int rows = 500;
    std::vector<double> time(rows), force(rows);
    for (int i = 0; i < rows; ++i) {
        time[i] = i * 1e-3;
        force[i] = i % 7 * 10.0;
    }
    sample.add("time", {1, rows}, {1, 64}, false, time);
    sample.add("load_fz", {1, rows}, {1, 64}, true, force);
}

}  // namespace

int main(int count, char** words) {
    if (count < 4) {
        std::fprintf(stderr, "damage_hdf5 SEED COUNT FILE …\n");
        return 2;
    }
    const std::uint64_t seed = std::strtoull(words[1], nullptr, 10);
    const long files = std::strtol(words[2], nullptr, 10);
    const wems::test::TemporaryFile compressed("");
    writeCompressed(compressed.path());
    std::vector<std::string> names(words + 3, words + count), sound;
    names.push_back(compressed.path());
    const wems::test::TemporaryFile laboratory(
        "[columns]\nt = \"time\"\n\"LVDT top\" = \"mobile.1.z\"\nA1 = \"mobile.1.az\"\nForce = \"load.fz\"\n");
    const wems::ColumnMap map = wems::readColumnMap(laboratory.path());
    std::vector<const wems::ColumnMap*> maps;
    for (const std::string& name : names) {
        std::ifstream file(name, std::ios::binary);
        sound.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        maps.push_back(isRead(name, nullptr) ? nullptr : &map);
        if (isRead(name, maps.back())) continue;
        std::fprintf(stderr, "%s is not read as it is\n", name.c_str());
        return 2;
    }
    long read = 0, refused = 0, broken = 0, wrong = 0;
    double slowest = 0;
    for (long k = 0; k < files; ++k) {
        Random random(seed * 1000003 + static_cast<std::uint64_t>(k));
        const std::size_t which = below(sound.size(), random);
        const wems::test::TemporaryFile file(damage(sound[which], random));
        const auto start = std::chrono::steady_clock::now();
        try {
            readWhole(file.path(), k % 2 == 1, maps[which]);
            ++read;
        } catch (const wems::InputError& error) {
            const std::string text = error.what();
            ++(text.find("broke off") == std::string::npos ? refused : broken);
            if (text.find('\n') != std::string::npos) {
                ++wrong;
                std::printf("%ld of %s: %s\n", k, names[which].c_str(), text.c_str());
            }
        } catch (const std::exception& error) {
            ++wrong;
            std::printf("%ld of %s: %s\n", k, names[which].c_str(), error.what());
        }
        slowest = std::max(slowest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::printf(
        "seed %llu: %ld files, %ld read, %ld refused, %ld ended the reader's process, %ld wrong; slowest %.1f s\n",
        static_cast<unsigned long long>(seed), files, read, refused, broken, wrong, slowest);
    return wrong == 0 ? 0 : 1;
}
