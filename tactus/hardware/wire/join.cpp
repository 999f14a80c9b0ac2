// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/join.hpp>

#include <algorithm>

namespace tactus::wire {

namespace {

/// Whether it said anything.
bool tell(WireEnd& from, WireEnd& to, std::int64_t now_ns) noexcept {
  bool told = false;
  for (auto bytes = from.say(now_ns); !bytes.empty(); bytes = from.say(now_ns)) {
    to.hear(bytes, now_ns);
    told = true;
  }
  return told;
}

}  // namespace

void join(WireEnd& a, WireEnd& b, std::int64_t from_ns, std::int64_t to_ns) noexcept {
  for (std::int64_t now_ns = from_ns; now_ns < to_ns;) {
    tell(a, b, now_ns);
    const bool a_heard = tell(b, a, now_ns);
    const std::int64_t wakes_ns = a_heard ? now_ns : std::min(a.wakes_ns(), b.wakes_ns());
    now_ns = std::max(wakes_ns, now_ns + 1);
  }
}

}  // namespace tactus::wire
