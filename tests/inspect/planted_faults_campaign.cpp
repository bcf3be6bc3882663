// Plants one to five faults in recordings of random devices and counts those that are named.
//   planted_faults SEED COUNT [FIRST]
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>

#include "tests/hidden/device_motion.hpp"
#include "tests/inspect/planted_faults.hpp"

int main(int argc, char** argv) {
    using namespace wems;
    if (argc < 3) {
        std::cerr << "usage: planted_faults SEED COUNT [FIRST]: recordings FIRST (absent: 0) to COUNT - 1 of a seed\n";
        return 2;
    }
    const auto seed = static_cast<unsigned>(std::strtoul(argv[1], nullptr, 10));
    const int count = std::atoi(argv[2]), first = argc > 3 ? std::atoi(argv[3]) : 0;
    constexpr int kSizes = 6;  // no fault to five
    std::array<test::FaultScore, kSizes> sums;
    double seconds = 0;
    for (int i = first; i < count; ++i) {
        std::seed_seq sequence{seed, static_cast<unsigned>(i)};
        hidden::Random random(sequence);
        const int faults = i % kSizes;
        try {
            const test::FaultyRun run = test::drawFaultyRun(faults, random);
            const auto start = std::chrono::steady_clock::now();
            const auto found = identify::findMeasurementFaults(run.recording, run.model);
            seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
            const test::FaultScore score = test::scoreFaults(run, found);
            auto& sum = sums[faults];
            sum.planted += score.planted;
            sum.named += score.named;
            sum.innocent += score.innocent;
            sum.blamed += score.blamed;
            std::cout << i << " (" << run.set_up << "): " << score.named << " of " << score.planted << " named, "
                      << score.blamed << " of " << score.innocent << " innocent channels blamed\n";
            for (const auto& part : found) {
                std::cout << "    " << (part.part == Part::mobile ? "mobile" : "fixed") << ", " << part.redundancy
                          << " to spare: " << part.before << " before, " << part.after << " after\n";
                if (score.missed.empty() && score.blamed == 0) continue;
                for (const auto& fault : part.faults) std::cout << "      " << describe(fault) << "\n";
            }
            std::cout << score.missed << std::flush;
        } catch (const hidden::TruthDiverged&) {
            std::cout << i << ": the device diverged, no recording\n";
        }
    }
    for (int faults = 0; faults < kSizes; ++faults) {
        const test::FaultScore& sum = sums[faults];
        std::cout << faults << " faults at once: " << sum.named << " of " << sum.planted << " named, " << sum.blamed
                  << " of " << sum.innocent << " innocent channels blamed\n";
    }
    std::cout << seconds / std::max(1, count - first) << " s a recording\n";
}
