// The executable `identify`.
#include <cstdlib>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "identify/cli/program.hpp"
#include "models/command_line/standard_streams.hpp"

namespace {

/// Matrices of some megabytes come and go by the thousand; glibc would map and unmap, and the kernel zero, each one.
void keepFreedMemory() {
#ifdef __GLIBC__
    constexpr int largest = 32 << 20, kept = 1 << 30;
    mallopt(M_MMAP_THRESHOLD, largest);
    mallopt(M_TRIM_THRESHOLD, kept);
#endif
}

}  // namespace

int main(int argc, char** argv) {
    keepFreedMemory();
    return wems::runProgram("identify", wems::identify::cli::runIdentify, argc, argv);
}
