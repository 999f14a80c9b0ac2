// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/broadcast.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <thread>

#include "tests/allocation_counter.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace broadcast_test {

/// Words that must stay together: a torn read would part them.
struct Numbered {
  std::uint64_t number = 0;
  std::array<std::uint64_t, 20> complements{};
};

Numbered numbered(std::uint64_t number) {
  Numbered value{.number = number};
  value.complements.fill(~number);
  return value;
}

bool is_whole(const Numbered& value) { return value.complements == numbered(value.number).complements; }

using Eight = Broadcast<Numbered, 8>;

TEST(Broadcast, EveryReaderSeesEveryValueThatIsPushedAfterItWasMade) {
  const auto source = std::make_shared<Eight>();
  Eight::Reader early(source);
  source->push(numbered(1));
  Eight::Reader late(source);
  source->push(numbered(2));
  Numbered value;
  ASSERT_TRUE(early.next(value));
  EXPECT_EQ(value.number, 1U);
  ASSERT_TRUE(early.next(value));
  EXPECT_EQ(value.number, 2U);
  EXPECT_FALSE(early.next(value));
  ASSERT_TRUE(late.next(value));
  EXPECT_EQ(value.number, 2U);
  EXPECT_FALSE(late.next(value));
  EXPECT_EQ(early.lost() + late.lost(), 0U);
}

TEST(Broadcast, AReaderThatIsLappedLosesTheOldestAndCountsThem) {
  const auto source = std::make_shared<Eight>();
  Eight::Reader quick(source), slow(source);
  Numbered value;
  for (std::uint64_t i = 1; i <= 20; ++i) {
    source->push(numbered(i));
    ASSERT_TRUE(quick.next(value));
  }
  for (std::uint64_t i = 13; i <= 20; ++i) {
    ASSERT_TRUE(slow.next(value));
    EXPECT_EQ(value.number, i);
  }
  EXPECT_FALSE(slow.next(value));
  EXPECT_EQ(slow.lost(), 12U);
  EXPECT_EQ(quick.lost(), 0U);
}

TEST(Broadcast, AReaderOutlivesWhoPushed) {
  auto source = std::make_shared<Eight>();
  Eight::Reader reader(source);
  source->push(numbered(7));
  source.reset();
  Numbered value;
  ASSERT_TRUE(reader.next(value));
  EXPECT_EQ(value.number, 7U);
}

TEST(Broadcast, BetweenThreadsNothingIsTornReorderedOrLostUncounted) {
  const auto source = std::make_shared<Eight>();
  constexpr std::uint64_t count = 50'000;
  std::atomic<bool> done{false};
  const auto read = [&](Eight::Reader reader) {
    std::uint64_t received = 0, last = 0;
    Numbered value;
    for (bool ended = false; !ended;) {
      ended = done.load(std::memory_order_acquire);  // before the last look, so that nothing can come after it
      while (reader.next(value)) {
        ASSERT_TRUE(is_whole(value));
        ASSERT_GT(value.number, last);
        last = value.number;
        ++received;
      }
      std::this_thread::yield();
    }
    EXPECT_EQ(received + reader.lost(), count);
    EXPECT_EQ(last, count);
  };
  std::thread one(read, Eight::Reader(source)), other(read, Eight::Reader(source));
  for (std::uint64_t i = 1; i <= count; ++i) {
    source->push(numbered(i));
    if (i % 32 == 0) std::this_thread::yield();
  }
  done.store(true, std::memory_order_release);
  one.join();
  other.join();
}

TEST(Broadcast, NeitherSideAllocates) {
  const auto source = std::make_shared<Eight>();
  Eight::Reader reader(source);
  Numbered value;
  const auto before = laws::allocation_count();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    source->push(numbered(i));
    if (i % 30 == 0) reader.next(value);
  }
  EXPECT_EQ(laws::allocation_count(), before);
}

}  // namespace broadcast_test
}  // namespace tactus::telemetry
