/// @file
/// Independent pieces of work on two threads.
#pragma once

#include <cstddef>
#include <functional>

namespace wems::identify {

/// Calls `work(i)` for i = 0 … count − 1, each once, on this thread and one other. The pieces must not depend on each
/// other; results that go to places of their own are the same as with one thread.
/// @throws what the first piece that failed threw
void runParallel(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace wems::identify
