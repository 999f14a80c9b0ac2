// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/inbound.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/link/any_datagram.hpp>

namespace tactus::link {
namespace {

using Verdict = Inbound::Verdict;

constexpr std::int64_t own_session = 77;
constexpr std::int64_t ms = 1'000'000;

/// What the slave of `session` sends at `sent_ns` of its clock when it has just heard what the master sent at that
/// time.
Datagram from_slave(std::int64_t session, std::int64_t sequence, std::int64_t sent_ns) {
  Datagram datagram;
  datagram.site = SiteRole::slave;
  datagram.packet.session = session;
  datagram.packet.sequence = sequence;
  datagram.packet.message.position_m = static_cast<double>(sequence);
  datagram.peer_session = own_session;
  datagram.sent_ns = sent_ns;
  datagram.echo_sent_ns = sent_ns;
  return datagram;
}

/// The verdict on a datagram whose age does not matter.
Verdict verdict(Inbound& inbound, Datagram datagram, std::int64_t now_ns) { return inbound.take(datagram, now_ns); }

TEST(ReplayWindow, AgreesWithASetThatForgetsNothing) {
  EXPECT_TRUE(rc::check([] {
    const auto sequences = *rc::gen::container<std::vector<std::uint64_t>>(rc::gen::inRange<std::uint64_t>(0, 300));
    ReplayWindow window;
    std::set<std::uint64_t> seen;
    for (const std::uint64_t sequence : sequences) {
      const std::uint64_t newest = seen.empty() ? 0 : *seen.rbegin();
      const auto verdict = window.judge(sequence);
      if (sequence > newest) {
        RC_ASSERT(verdict == ReplayWindow::Verdict::newest);
      } else if (sequence == 0 || seen.contains(sequence) || newest - sequence >= 64) {
        RC_ASSERT(verdict == ReplayWindow::Verdict::repeated);
      } else {
        RC_ASSERT(verdict == ReplayWindow::Verdict::late);
      }
      if (verdict != ReplayWindow::Verdict::repeated) seen.insert(sequence);
      RC_ASSERT(window.newest() == (seen.empty() ? 0 : *seen.rbegin()));
    }
  }));
}

TEST(Inbound, EachDatagramOfASessionCountsOnceWhateverTheOrder) {
  EXPECT_TRUE(rc::check([] {
    const auto order = *rc::gen::container<std::vector<std::int64_t>>(rc::gen::inRange<std::int64_t>(1, 60));
    Inbound inbound(SiteRole::master, own_session);
    std::set<std::int64_t> seen;
    for (const std::int64_t sequence : order) {
      const bool counts = verdict(inbound, from_slave(5, sequence, 1000 * ms), 1001 * ms) == Verdict::counted;
      RC_ASSERT(counts == seen.insert(sequence).second);
      RC_ASSERT(inbound.arrived() == seen.size());
    }
  }));
}

TEST(Inbound, NoDatagramThatDoesNotAnswerTheOwnSessionCounts) {
  EXPECT_TRUE(rc::check([] {
    Datagram datagram = *testing::any_datagram();
    if (datagram.peer_session == own_session) datagram.peer_session = 0;
    Inbound inbound(SiteRole::master, own_session);
    RC_ASSERT(inbound.take(datagram, 1000 * ms) != Verdict::counted);
    RC_ASSERT(inbound.counters().counted == 0U);
    RC_ASSERT(inbound.received_ns() == 0);
  }));
}

TEST(Inbound, AnyDatagramIsJudgedWithoutHarm) {
  EXPECT_TRUE(rc::check([] {
    Inbound inbound(SiteRole::master, own_session);
    for (int i = 0; i < 20; ++i) {
      Datagram datagram = *testing::any_datagram();
      datagram.peer_session = own_session;
      inbound.take(datagram, static_cast<std::int64_t>(*rc::gen::arbitrary<std::uint64_t>() >> 1));
    }
  }));
}

TEST(Inbound, OwnDatagramsThatComeBackAreRefused) {
  Inbound inbound(SiteRole::master, own_session);
  Datagram reflected = from_slave(5, 1, 1000 * ms);
  reflected.site = SiteRole::master;
  EXPECT_EQ(inbound.take(reflected, 1001 * ms), Verdict::reflected);
}

TEST(Inbound, APacketHasItsAgeAndAnInfiniteOneWhereNoEchoTells) {
  Inbound inbound(SiteRole::master, own_session);
  Datagram mute = from_slave(5, 1, 1000 * ms);
  mute.echo_sent_ns = 0;
  ASSERT_EQ(inbound.take(mute, 1002 * ms), Verdict::counted);
  EXPECT_TRUE(std::isinf(mute.packet.age_s));
  // Back at once, after a round trip of 2 ms: half of it is its age, and the other clock goes 1 ms behind.
  Datagram quick = from_slave(5, 2, 1000 * ms);
  ASSERT_EQ(inbound.take(quick, 1002 * ms), Verdict::counted);
  EXPECT_NEAR(quick.packet.age_s, 0.001, 1e-9);
  Datagram slow = from_slave(5, 3, 1100 * ms);
  slow.echo_sent_ns = 0;
  ASSERT_EQ(inbound.take(slow, 1600 * ms), Verdict::counted);
  EXPECT_NEAR(slow.packet.age_s, 0.499, 1e-9);
}

// What counts twice at one site counts once at the other: the judge of packets refuses what is late or too old.
TEST(Inbound, OfWhatCountsTheJudgeOfPacketsAppliesTheNewestOnly) {
  Inbound inbound(SiteRole::master, own_session);
  auto judge = control::PacketJudge::make({.longest_age_s = 0.2}, Seconds{1e-3}).value();
  const auto applied = [&](std::int64_t sequence, std::int64_t sent_ns, std::int64_t now_ns) {
    Datagram datagram = from_slave(5, sequence, sent_ns);
    EXPECT_EQ(inbound.take(datagram, now_ns), Verdict::counted);
    return judge.step(datagram.packet);
  };
  EXPECT_EQ(applied(1, 1000 * ms, 1002 * ms), control::PacketVerdict::applied);
  EXPECT_EQ(applied(3, 1002 * ms, 1004 * ms), control::PacketVerdict::applied);
  EXPECT_EQ(applied(2, 1001 * ms, 1005 * ms), control::PacketVerdict::late);
  EXPECT_EQ(applied(4, 1006 * ms, 1600 * ms), control::PacketVerdict::stale);
  EXPECT_EQ(applied(5, 1600 * ms, 1602 * ms), control::PacketVerdict::applied);
}

TEST(Inbound, AGreetingIsAnsweredAndDoesNotCount) {
  Inbound inbound(SiteRole::master, own_session);
  Datagram greeting = from_slave(5, 1, 1000 * ms);
  greeting.peer_session = 0;
  EXPECT_EQ(inbound.take(greeting, 1001 * ms), Verdict::greeting);
  EXPECT_EQ(inbound.answered_session(), 5);
  EXPECT_EQ(inbound.echo_sent_ns(), 1000 * ms);
  // One from before the session was taken up comes late: it is not what is echoed.
  EXPECT_EQ(verdict(inbound, from_slave(5, 3, 1002 * ms), 1003 * ms), Verdict::counted);
  EXPECT_EQ(inbound.take(greeting, 1004 * ms), Verdict::greeting);
  EXPECT_EQ(inbound.echo_sent_ns(), 1002 * ms);
}

TEST(Inbound, ARestartedSiteIsTakenUpOnceItAnswersAndTheOldOneNeverAgain) {
  Inbound inbound(SiteRole::master, own_session);
  EXPECT_EQ(verdict(inbound, from_slave(5, 900, 1000 * ms), 1001 * ms), Verdict::counted);
  // Recorded before the own start: answers another session.
  Datagram recorded = from_slave(6, 901, 1000 * ms);
  recorded.peer_session = own_session - 1;
  EXPECT_EQ(inbound.take(recorded, 1001 * ms), Verdict::foreign);
  EXPECT_EQ(verdict(inbound, from_slave(6, 1, 1002 * ms), 1003 * ms), Verdict::counted);
  EXPECT_EQ(inbound.counters().sessions, 2U);
  EXPECT_EQ(verdict(inbound, from_slave(5, 902, 1004 * ms), 1005 * ms), Verdict::foreign);
  Datagram late_greeting = from_slave(5, 903, 1004 * ms);
  late_greeting.peer_session = 0;
  EXPECT_EQ(inbound.take(late_greeting, 1005 * ms), Verdict::foreign);
  EXPECT_EQ(inbound.answered_session(), 6);
}

TEST(PeerClock, FindsTheOffsetToHalfTheRoundTripWhateverTheWays) {
  EXPECT_TRUE(rc::check([] {
    const auto offset_ns = *rc::gen::inRange<std::int64_t>(-1'000'000'000'000, 1'000'000'000'000);
    PeerClock clock;
    std::int64_t now_ns = 2'000'000'000'000, shortest_ns = 1'000'000'000;
    for (int i = 0; i < 20; ++i) {
      const auto there_ns = *rc::gen::inRange<std::int64_t>(0, 5 * ms);
      const auto held_ns = *rc::gen::inRange<std::int64_t>(0, 5 * ms);
      const auto back_ns = *rc::gen::inRange<std::int64_t>(0, 5 * ms);
      const std::int64_t arrived_ns = now_ns + there_ns + held_ns + back_ns;
      RC_ASSERT(clock.observe(now_ns, held_ns, now_ns + there_ns + held_ns + offset_ns, arrived_ns));
      RC_ASSERT(clock.round_trip_ns() == there_ns + back_ns);
      shortest_ns = std::min(shortest_ns, there_ns + back_ns);
      now_ns = arrived_ns;
    }
    // Half a nanosecond is lost in halving.
    RC_ASSERT(std::abs(clock.offset_ns() - offset_ns) <= shortest_ns / 2 + 1);
  }));
}

TEST(PeerClock, ForgetsAnOffsetThatHasDriftedAwayWithinTwoSeconds) {
  PeerClock clock;
  // The other clock is 100 ppm fast. Every tenth echo took no time in queues, the others up to 3 ms.
  for (std::int64_t k = 0; k < 10'000; ++k) {
    const std::int64_t sent_ns = (1'000'000 + k) * ms;
    const std::int64_t queue_ns = k % 10 == 0 ? 0 : (k % 4) * ms;
    const std::int64_t answered_ns = sent_ns + ms + queue_ns;
    clock.observe(sent_ns, 0, answered_ns + k * 100, answered_ns + ms);
  }
  EXPECT_NEAR(static_cast<double>(clock.offset_ns()), 1e6, 2e9 * 100e-6);
}

TEST(PeerClock, IgnoresEchoesThatNoClockCouldHaveMade) {
  PeerClock clock;
  EXPECT_FALSE(clock.observe(2000, 0, 1500, 1000));      // sent after it was answered
  EXPECT_FALSE(clock.observe(1000, 5000, 6000, 2000));   // held longer than it was gone
  EXPECT_FALSE(clock.observe(0, 0, 1, 61'000'000'000));  // more than a minute
  EXPECT_FALSE(clock.known());
}

}  // namespace
}  // namespace tactus::link
