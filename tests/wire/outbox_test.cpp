// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/outbox.hpp>

#include <deque>
#include <utility>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/wire/scripted_end.hpp>

namespace tactus::wire {
namespace {

using testing::Bytes;

TEST(Outbox, AgreesWithAQueueThatHasNoEnd) {
  EXPECT_TRUE(rc::check([] {
    Outbox outbox(200);
    std::deque<std::pair<Bytes, std::int64_t>> expected;
    const auto steps = *rc::gen::inRange(1, 100);
    std::int64_t now_ns = 0;
    for (int step = 0; step < steps; ++step) {
      const auto packet = *rc::gen::resize(40, rc::gen::nonEmpty(rc::gen::arbitrary<Bytes>()));
      const std::int64_t due_ns = now_ns + *rc::gen::inRange(0, 20);
      std::size_t waiting = 0;
      for (const auto& [bytes, at_ns] : expected) waiting += 16 + bytes.size();
      const bool fits = waiting + 16 + packet.size() <= 200;
      RC_ASSERT(outbox.put(packet, due_ns) == fits);
      if (fits) expected.emplace_back(packet, due_ns);
      now_ns += *rc::gen::inRange(0, 15);
      while (!expected.empty() && expected.front().second <= now_ns) {
        RC_ASSERT(outbox.due_ns() == expected.front().second);
        const auto taken = outbox.take(now_ns);
        RC_ASSERT(Bytes(taken.begin(), taken.end()) == expected.front().first);
        expected.pop_front();
      }
      RC_ASSERT(outbox.take(now_ns).empty());
    }
  }));
}

TEST(Outbox, AnEmptyOneIsNeverDue) {
  Outbox outbox(64);
  EXPECT_EQ(outbox.due_ns(), never_ns);
  EXPECT_TRUE(outbox.take(never_ns).empty());
  EXPECT_TRUE(outbox.put(Bytes{}, 3));
  EXPECT_EQ(outbox.due_ns(), never_ns);
  ASSERT_TRUE(outbox.put(Bytes{1}, 3));
  outbox.clear();
  EXPECT_EQ(outbox.due_ns(), never_ns);
}

}  // namespace
}  // namespace tactus::wire
