#include "identify/motion/parallel.hpp"

#include <fftw3.h>

#include <atomic>
#include <exception>
#include <thread>

namespace wems::identify {

void runParallel(std::size_t count, const std::function<void(std::size_t)>& work) {
    if (count == 0) return;
    fftw_make_planner_thread_safe();  // plans are made within the pieces
    std::atomic<std::size_t> next{0};
    std::exception_ptr failures[2];
    const auto loop = [&](std::exception_ptr& failure) {
        try {
            for (std::size_t i = next++; i < count; i = next++) work(i);
        } catch (...) {
            failure = std::current_exception();
            next = count;
        }
    };
    std::thread helper(loop, std::ref(failures[1]));
    loop(failures[0]);
    helper.join();
    for (const auto& failure : failures)
        if (failure) std::rethrow_exception(failure);
}

}  // namespace wems::identify
