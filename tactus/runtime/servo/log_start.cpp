// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/log_start.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>

#include <limits>

#include <time.h>

namespace tactus::runtime {

LogStart LogStart::now() noexcept {
  constexpr int readings = 16;
  LogStart best;
  std::int64_t least_apart_ns = std::numeric_limits<std::int64_t>::max();
  for (int i = 0; i < readings; ++i) {
    const std::int64_t before_ns = runtime::monotonic_ns();
    timespec wall{};
    clock_gettime(CLOCK_REALTIME, &wall);
    const std::int64_t apart_ns = runtime::monotonic_ns() - before_ns;
    if (apart_ns >= least_apart_ns) continue;
    least_apart_ns = apart_ns;
    best = {.monotonic_ns = before_ns + apart_ns / 2,
            .unix_ns = std::int64_t{wall.tv_sec} * 1'000'000'000 + std::int64_t{wall.tv_nsec}};
  }
  return best;
}

}  // namespace tactus::runtime
