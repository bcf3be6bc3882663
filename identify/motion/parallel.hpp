/// @file
/// Independent pieces of work on the processor's cores (oneTBB).
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>

namespace wems::identify {

/// Calls `work(i)` for i = 0 … count − 1, each once, on as many threads as the machine has cores or the caller's
/// `tbb::global_control` allows (`--threads`). The pieces must not depend on each other; results that go to places of
/// their own are the same whatever the number of threads.
/// @throws what one of the pieces that failed threw; pieces that had not begun are left out then
void runParallel(std::size_t count, const std::function<void(std::size_t)>& work);

/// Each of the pieces once, likewise.
/// @throws what the first of those that failed threw
void runParallel(std::initializer_list<std::function<void()>> pieces);

}  // namespace wems::identify
