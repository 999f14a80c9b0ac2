#pragma once

#include <cstddef>
#include <functional>

namespace tactus::simulation {

/// Calls `work(i)` for every i below `count`, on `threads` threads, this one among them; 0 means as many as the machine
/// has cores. The order is not defined, so each call must write to a place of its own; then the results do not depend
/// on the number of threads. `progress` is called on this thread, now and then, with the share that is done, at last
/// with 1. `work` must not throw.
void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work,
                          const std::function<void(double)>& progress, std::size_t threads = 0);

}  // namespace tactus::simulation
