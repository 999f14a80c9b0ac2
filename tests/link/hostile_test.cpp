// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/endpoint.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>
#include <tests/allocation_counter.hpp>
#include <tests/link/between.hpp>

namespace tactus::link {
namespace {

class Between : public testing::Between, public ::testing::Test {};

TEST_F(Between, OfAHundredThousandHostilePacketsNoneIsAcceptedAndTheLinkGoesOn) {
  ASSERT_TRUE(meet());
  for (int i = 0; i < 4000; ++i) {
    tick_both();
    for (int k = 0; k < 25; ++k) attack();
    slave->receive(monotonic_ns());
    ASSERT_EQ(last.message.position_m, 1.0);
  }
  const auto counters = slave->counters();
  EXPECT_LE(counters.secure.opened, passed_to_slave);
  EXPECT_EQ(counters.malformed, 0U);
  EXPECT_EQ(counters.inbound.sessions, 1U);
  EXPECT_EQ(last.session, master->session());
  const std::uint64_t dropped = slave->socket().dropped();
  EXPECT_GT(dropped, 30'000U) << "by the kernel, for size and first bytes";
  EXPECT_GT(dropped + counters.secure.refused, 80'000U);
  const auto counted = counters.inbound.counted;
  for (int i = 0; i < 100; ++i) tick_both();
  EXPECT_GT(slave->counters().inbound.counted, counted + 50);
  // A busy machine may make the master begin another; the attacker completes none.
  EXPECT_LE(slave->counters().secure.handshakes, master->counters().secure.handshakes);
}

TEST_F(Between, WhatWasRecordedLongAgoIsDroppedByTheKernel) {
  ASSERT_TRUE(meet());
  const auto heard = attacker.next(0);
  const std::vector<std::byte> recorded(heard.begin(), heard.end());
  const std::uint64_t before = slave->socket().dropped();
  const auto dropped_now = [&] {
    const std::uint64_t counted = slave->counters().secure.refused + slave->counters().secure.handshake_packets;
    for (int i = 0; i < 20; ++i) send_to_slave(recorded);
    for (int i = 0; i < 5; ++i) slave->receive(monotonic_ns());
    return slave->counters().secure.refused + slave->counters().secure.handshake_packets == counted;
  };
  // As soon as the link has gone on by more than a window and the kernel has been told so.
  bool dropped = false;
  for (int i = 0; i < 20'000 && !dropped; ++i) {
    tick_both();
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    if (i % 500 == 499) dropped = dropped_now();
  }
  EXPECT_TRUE(dropped);
  EXPECT_GE(slave->socket().dropped(), before + 20);
  const auto counted = slave->counters().inbound.counted;
  for (int i = 0; i < 50; ++i) tick_both();
  EXPECT_GT(slave->counters().inbound.counted, counted + 20) << "the link goes on";
}

TEST_F(Between, HostileRecordsOfTheRightTypeCostNoMemory) {
  ASSERT_TRUE(meet());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the thread of the hand-shakes comes to rest
  for (const int kind : {0, 1, 4}) {
    const auto heard = slave->counters().secure;
    const std::uint64_t dropped = slave->socket().dropped();
    std::uint64_t allocating = 0;
    for (int i = 0; i < 1000; ++i) {
      attack(kind);
      const std::uint64_t before = laws::own_allocation_count();
      const auto packets = slave->receive(monotonic_ns());
      if (laws::own_allocation_count() != before) ++allocating;
      for (const control::Packet& packet : packets) {
        ASSERT_EQ(packet.session, last.session);
        ASSERT_LT(packet.sequence, last.sequence) << "nothing that would be applied";
      }
    }
    EXPECT_EQ(allocating, 0U) << "kind " << kind;
    const auto now = slave->counters().secure;
    EXPECT_GT(now.refused + now.handshake_packets + slave->socket().dropped(),
              heard.refused + heard.handshake_packets + dropped);
    // What the master sealed before the slave had its keys was never opened, and is once when the attacker sends it
    // again: a packet that came late.
    if (kind == 0) {
      EXPECT_LE(now.opened, passed_to_slave);
    } else {
      EXPECT_EQ(now.opened, heard.opened);
    }
  }
}

TEST_F(Between, BeginningsOfHandshakesLeaveNoMemoryBehind) {
  ASSERT_TRUE(meet());
  const auto burst = [&] {
    for (int i = 0; i < 500; ++i) {
      tick_both();
      for (int k = 0; k < 4; ++k) attack(5);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  };
  // A hand-shake under way holds 71,000 bytes, and a busy machine may make the master begin one at any time: what
  // counts is the least that is held while the link goes on in peace.
  const auto held = [&] {
    std::size_t least = mallinfo2().uordblks;
    for (int i = 0; i < 1000; ++i) {
      tick_both();
      least = std::min(least, mallinfo2().uordblks);
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
    return least;
  };
  burst();
  const std::size_t before = held();
  burst();
  EXPECT_LT(held(), before + 30'000);  // less than one connection that stayed, of 2000 that were begun
  EXPECT_LE(slave->counters().secure.handshakes, master->counters().secure.handshakes);
}

}  // namespace
}  // namespace tactus::link
