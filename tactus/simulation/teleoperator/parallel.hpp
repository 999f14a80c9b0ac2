// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace tactus::simulation {

/// Calls `work(i)` for every i below `count`, on `threads` threads, this one among them; 0 means as many as the machine
/// has cores. The order is not defined, so each call must write to a place of its own; then the results do not depend
/// on the number of threads. `progress` is called on this thread, now and then, with the share that is done, at last
/// with 1. Where the system has no more threads, fewer do the work. What `work` or `progress` throws, as for a lack of
/// memory, is thrown again on this thread once all threads have ended; no further work is begun.
void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work,
                          const std::function<void(double)>& progress, std::size_t threads = 0);

}  // namespace tactus::simulation
