#include "identify/motion/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <exception>
#include <vector>

namespace wems::identify {

void runParallel(std::size_t count, const std::function<void(std::size_t)>& work) {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, count, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) work(i);
        },
        tbb::simple_partitioner());
}

void runParallel(std::initializer_list<std::function<void()>> pieces) {
    std::vector<std::exception_ptr> failures(pieces.size());
    runParallel(pieces.size(), [&](std::size_t i) {
        try {
            pieces.begin()[i]();
        } catch (...) {
            failures[i] = std::current_exception();
        }
    });
    for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace wems::identify
