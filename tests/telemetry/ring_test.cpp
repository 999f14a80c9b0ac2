// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/ring.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

#include "tests/allocation_counter.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace {

/// Two halves that must stay together: a torn read would part them.
struct Pair {
  std::uint64_t value = 0;
  std::uint64_t complement = 0;
};

TEST(Ring, ItHoldsExactlyItsCapacityAndDropsAndCountsTheRest) {
  Ring<int, 4> ring;
  for (int i = 0; i < 7; ++i) EXPECT_EQ(ring.try_push(i), i < 4);
  EXPECT_EQ(ring.dropped(), 3U);
  int value = -1;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.try_pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.try_pop(value));
  EXPECT_TRUE(ring.try_push(9));
}

TEST(Ring, BetweenTwoThreadsNothingIsTornReorderedOrLostUncounted) {
  auto ring = std::make_unique<Ring<Pair, 64>>();
  constexpr std::uint64_t count = 200'000;
  std::atomic<bool> done{false};
  std::uint64_t accepted = 0;
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= count; ++i) {
      if (ring->try_push({i, ~i})) ++accepted;
      if (i % 32 == 0) std::this_thread::yield();
    }
    done.store(true, std::memory_order_release);
  });
  std::uint64_t received = 0, last = 0;
  Pair pair;
  for (bool ended = false; !ended;) {
    ended = done.load(std::memory_order_acquire);  // before the last look, so that nothing can come after it
    while (ring->try_pop(pair)) {
      ASSERT_EQ(pair.complement, ~pair.value);
      ASSERT_GT(pair.value, last);
      last = pair.value;
      ++received;
    }
    std::this_thread::yield();
  }
  producer.join();
  EXPECT_EQ(received, accepted);
  EXPECT_EQ(ring->dropped(), count - accepted);
}

TEST(Ring, NeitherSideAllocates) {
  auto ring = std::make_unique<Ring<Pair, 64>>();
  const auto before = laws::allocation_count();
  Pair pair;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    ring->try_push({i, ~i});
    if (i % 3 == 0) ring->try_pop(pair);
  }
  EXPECT_EQ(laws::allocation_count(), before);
}

}  // namespace
}  // namespace tactus::telemetry
