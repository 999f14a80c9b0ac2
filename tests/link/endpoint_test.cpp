// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/endpoint.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <tests/allocation_counter.hpp>
#include <tests/link/pair.hpp>
#include <unistd.h>

namespace tactus::link {
namespace {

using testing::loopback;
using testing::meet;
using testing::open;
using testing::Ports;
using testing::test_key;
using testing::tick;
using testing::tick_until;

class Link : public ::testing::TestWithParam<bool> {
 protected:
  [[nodiscard]] std::optional<Key> key() const { return GetParam() ? std::optional(test_key()) : std::nullopt; }
  Ports ports;
};
INSTANTIATE_TEST_SUITE_P(PlainAndEncrypted, Link, ::testing::Bool(),
                         [](const auto& mode) { return mode.param ? "encrypted" : "plain"; });

TEST_P(Link, TwoSitesHearEachOther) {
  Endpoint master = open(SiteRole::master, ports, key());
  Endpoint slave = open(SiteRole::slave, ports, key());
  EXPECT_FALSE(tick(master, 1.0));
  EXPECT_FALSE(master.condition(monotonic_ns()).heard);
  ASSERT_TRUE(meet(master, slave));
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto at_master = tick(master, 1.0), at_slave = tick(slave, 2.0);
  ASSERT_TRUE(at_master && at_slave);
  EXPECT_EQ(at_master->message.position_m, 2.0);
  EXPECT_EQ(at_slave->message.position_m, 1.0);
  EXPECT_EQ(at_master->session, slave.session());
  EXPECT_EQ(at_slave->session, master.session());
  EXPECT_LT(at_slave->age_s, 1.0);
  const auto condition = master.condition(monotonic_ns());
  EXPECT_TRUE(condition.heard);
  EXPECT_LT(condition.silence_s, 1.0);
  EXPECT_GT(condition.round_trip_s, 0.0);
  // One host, one clock: the offset is known to half of the round trip.
  EXPECT_LT(std::abs(condition.clock_offset_s), 0.01);
}

TEST_P(Link, ASiteThatWasKilledAndCameBackIsHeardAgainAndKnownAsAnother) {
  for (const SiteRole killed : {SiteRole::master, SiteRole::slave}) {
    std::optional<Endpoint> master = open(SiteRole::master, ports, key());
    std::optional<Endpoint> slave = open(SiteRole::slave, ports, key());
    ASSERT_TRUE(meet(*master, *slave));
    std::optional<Endpoint>& gone = killed == SiteRole::master ? master : slave;
    Endpoint& left = killed == SiteRole::master ? *slave : *master;
    gone.reset();  // says nothing to the other side
    gone = open(killed, ports, key());
    ASSERT_TRUE(tick_until(*master, *slave, [&] {
      return left.counters().inbound.sessions == 2 && gone->counters().inbound.counted > 3;
    }));
    std::optional<control::Packet> came;
    for (int i = 0; i < 1000 && !came; ++i) {
      tick(*gone, 1.0);
      came = tick(left, 2.0);
    }
    ASSERT_TRUE(came);
    EXPECT_EQ(came->session, gone->session());
    EXPECT_EQ(left.counters().inbound.sessions, 2U);
  }
}

TEST_P(Link, ATickDoesNotAllocate) {
  Endpoint master = open(SiteRole::master, ports, key());
  Endpoint slave = open(SiteRole::slave, ports, key());
  ASSERT_TRUE(meet(master, slave));
  // The thread of the hand-shakes is counted too, and works where a busy machine lets the link fall silent; a tick that
  // allocates does so every time.
  std::uint64_t fewest = ~std::uint64_t{0};
  for (int attempt = 0; attempt < 20 && fewest > 0; ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const std::uint64_t before = laws::allocation_count();
    for (int i = 0; i < 100; ++i) {
      tick(master, 1.0);
      tick(slave, 2.0);
    }
    fewest = std::min(fewest, laws::allocation_count() - before);
  }
  EXPECT_EQ(fewest, 0U);
  EXPECT_GT(slave.counters().inbound.counted, 50U);
}

/// One end of several joints.
JointEndpoint open_joints(SiteRole site, const Ports& ports, const std::optional<Key>& key, std::size_t joints) {
  const bool master = site == SiteRole::master;
  auto endpoint = JointEndpoint::make({.site = site,
                                       .peer = loopback(master ? ports.slave : ports.master),
                                       .listen = loopback(master ? ports.master : ports.slave),
                                       .key = key},
                                      joints);
  if (!endpoint) throw std::runtime_error(describe(endpoint.error()));
  return *std::move(endpoint);
}

/// One tick of a site whose joint number i tells `position_m` + i.
std::optional<control::JointPacket> tick_joints(JointEndpoint& endpoint, double position_m, std::size_t joints) {
  const std::int64_t now_ns = monotonic_ns();
  const auto packets = endpoint.receive(now_ns);
  const auto last = packets.empty() ? std::nullopt : std::optional(packets.back());
  const auto counters = endpoint.counters();
  control::JointPacket packet{.session = endpoint.session(),
                              .sequence = static_cast<std::int64_t>(counters.sent + counters.unsent) + 1,
                              .message = Joints<control::Message>(joints)};
  for (std::size_t i = 0; i < joints; ++i) packet.message[i].position_m = position_m + static_cast<double>(i);
  endpoint.send(packet, now_ns);
  return last;
}

TEST_P(Link, TwoSitesOfEightJointsHearEachOther) {
  constexpr std::size_t joints = 8;
  JointEndpoint master = open_joints(SiteRole::master, ports, key(), joints);
  JointEndpoint slave = open_joints(SiteRole::slave, ports, key(), joints);
  std::optional<control::JointPacket> at_master, at_slave;
  for (int i = 0; i < 20'000 && !(at_master && at_slave); ++i) {
    if (auto came = tick_joints(master, 1.0, joints)) at_master = came;
    if (auto came = tick_joints(slave, 2.0, joints)) at_slave = came;
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  ASSERT_TRUE(at_master && at_slave);
  ASSERT_EQ(at_master->message.size(), joints);
  for (std::size_t i = 0; i < joints; ++i) {
    EXPECT_EQ(at_master->message[i].position_m, 2.0 + static_cast<double>(i));
    EXPECT_EQ(at_slave->message[i].position_m, 1.0 + static_cast<double>(i));
  }
  EXPECT_EQ(at_master->session, slave.session());
  EXPECT_EQ(master.counters().other_joints, 0U);
}

TEST_P(Link, SitesOfOtherNumbersOfJointsNeverHearEachOtherAndKnowWhy) {
  JointEndpoint master = open_joints(SiteRole::master, ports, key(), 3);
  JointEndpoint slave = open_joints(SiteRole::slave, ports, key(), 2);
  for (int i = 0; i < 2000 && (master.counters().other_joints == 0 || slave.counters().other_joints == 0); ++i) {
    EXPECT_FALSE(tick_joints(master, 1.0, 3));
    EXPECT_FALSE(tick_joints(slave, 2.0, 2));
    std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  EXPECT_EQ(slave.counters().other_joints, 3U);
  EXPECT_EQ(master.counters().other_joints, 2U);
  EXPECT_FALSE(master.condition(monotonic_ns()).heard);
  EXPECT_FALSE(slave.condition(monotonic_ns()).heard);
}

TEST(Endpoint, HasOneToEightJoints) {
  const Ports ports;
  for (const std::size_t joints : {std::size_t{0}, most_joints + 1}) {
    const auto endpoint = JointEndpoint::make({.site = SiteRole::master,
                                               .peer = loopback(ports.slave),
                                               .listen = loopback(ports.master),
                                               .key = std::nullopt},
                                              joints);
    ASSERT_FALSE(endpoint);
    EXPECT_EQ(endpoint.error().code, ErrorCode::out_of_bounds);
    EXPECT_EQ(endpoint.error().parameter, "joints");
  }
}

TEST(Endpoint, AWrongKeyIsNeverHeard) {
  const Ports ports;
  Endpoint master = open(SiteRole::master, ports, test_key(1));
  Endpoint slave = open(SiteRole::slave, ports, test_key(2));
  EXPECT_FALSE(tick_until(
      master, slave, [&] { return master.established() || slave.established(); }, 1.0));
  EXPECT_FALSE(master.condition(monotonic_ns()).heard);
  EXPECT_FALSE(slave.condition(monotonic_ns()).heard);
}

TEST(Endpoint, BothSitesKnowThatTheOtherHasAnotherKeyOrNone) {
  const Ports ports;
  const auto knows = [](auto& master, auto& slave, const auto& told) {
    return tick_until(
        master, slave, [&] { return told(master.counters(), slave.counters()); }, 20.0);
  };
  {
    Endpoint master = open(SiteRole::master, ports, test_key(1)), slave = open(SiteRole::slave, ports, test_key(2));
    EXPECT_TRUE(knows(master, slave, [](const auto& of_master, const auto& of_slave) {
      return of_master.secure.forged > 0 && of_slave.secure.forged > 0;
    }));
    EXPECT_FALSE(master.established() || slave.established());
  }
  {
    Endpoint master = open(SiteRole::master, ports, test_key()), slave = open(SiteRole::slave, ports, std::nullopt);
    EXPECT_TRUE(knows(master, slave, [](const auto& of_master, const auto& of_slave) {
      return of_master.secure.plain > 0 && of_slave.keyed > 0;
    }));
  }
  {
    Endpoint master = open(SiteRole::master, ports, std::nullopt), slave = open(SiteRole::slave, ports, test_key());
    EXPECT_TRUE(knows(master, slave, [](const auto& of_master, const auto& of_slave) {
      return of_master.keyed > 0 && of_slave.secure.plain > 0;
    }));
  }
  {
    Endpoint master = open(SiteRole::master, ports, test_key()), slave = open(SiteRole::slave, ports, test_key());
    EXPECT_TRUE(tick_until(
        master, slave, [&] { return master.condition(monotonic_ns()).heard && slave.condition(monotonic_ns()).heard; },
        20.0));
    for (const auto& counters : {master.counters(), slave.counters()}) {
      EXPECT_EQ(counters.secure.forged + counters.secure.plain + counters.keyed, 0U);
    }
  }
}

TEST(Endpoint, ASiteWithAKeyAndOneInPlainTextDoNotMeet) {
  const Ports ports;
  Endpoint master = open(SiteRole::master, ports, std::nullopt);
  Endpoint slave = open(SiteRole::slave, ports, test_key());
  EXPECT_FALSE(tick_until(
      master, slave, [&] { return master.condition(monotonic_ns()).heard || slave.condition(monotonic_ns()).heard; },
      0.5));
  // While there is no link they get in, so that the slave can say why.
  EXPECT_GT(slave.counters().secure.plain, 0U);
  EXPECT_EQ(slave.counters().secure.opened, 0U);
}

TEST(Endpoint, PlainTextOffTheLoopbackIsRefused) {
  const auto endpoint =
      Endpoint::make({.site = SiteRole::master,
                      .peer = Address::parse("192.0.2.1:7300").value(),
                      .listen = Address::parse("0.0.0.0:" + std::to_string(testing::free_port())).value(),
                      .key = std::nullopt});
  ASSERT_FALSE(endpoint);
  EXPECT_EQ(endpoint.error().code, ErrorCode::inconsistent);
  EXPECT_NE(endpoint.error().message.find("tactus key"), std::string::npos);
}

bool has_ipv6_loopback() {
  const int probe = ::socket(AF_INET6, SOCK_DGRAM, 0);
  sockaddr_in6 address{};
  address.sin6_family = AF_INET6;
  address.sin6_addr = in6addr_loopback;
  sockaddr_storage generic{};
  std::memcpy(&generic, &address, sizeof address);
  const bool bound = probe >= 0 && ::bind(probe, reinterpret_cast<const sockaddr*>(&generic), sizeof address) == 0;
  if (probe >= 0) ::close(probe);
  return bound;
}

TEST(Endpoint, IPv6CarriesItToo) {
  if (!has_ipv6_loopback()) GTEST_SKIP() << "this machine has no [::1]";
  const Ports ports;
  const auto at = [](std::uint16_t port) { return Address::parse("[::1]:" + std::to_string(port)); };
  auto master = Endpoint::make({.site = SiteRole::master,
                                .peer = at(ports.slave).value(),
                                .listen = at(ports.master).value(),
                                .key = test_key()});
  ASSERT_TRUE(master) << describe(master.error());
  auto slave = Endpoint::make({.site = SiteRole::slave,
                               .peer = at(ports.master).value(),
                               .listen = at(ports.slave).value().any_host(),
                               .key = test_key()});
  ASSERT_TRUE(slave) << describe(slave.error());
  EXPECT_TRUE(meet(*master, *slave));
}

}  // namespace
}  // namespace tactus::link
