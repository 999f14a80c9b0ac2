// SPDX-License-Identifier: Apache-2.0
// Every counter of a pair of sites, a second before it would wrap or reach its limit.
#include <tactus/runtime/link/packet_filter.hpp>
#include <tactus/runtime/link/secure_channel.hpp>
#include <tactus/simulation/experiments/faults/table.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <tests/soak/two_sites.hpp>
#include <unistd.h>

namespace tactus::soak {
namespace {

using control::SiteCause;
using control::SiteState;

constexpr std::int64_t largest = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t run_ns = 2'000'000'000, half_ns = run_ns / 2;
constexpr std::int64_t run_ticks = 10'000, half_ticks = run_ticks / 2;
constexpr std::array<std::int64_t, 3> powers{std::int64_t{1} << 31, std::int64_t{1} << 32, std::int64_t{1} << 53};

experiments::FaultsParams params_with(const std::string& architecture) {
  experiments::FaultsParams params;
  params.plant.longest_step_s = 1e-4;
  params.control.architecture = architecture;
  return params;
}

/// What a run did: the forces at both motors, tick by tick.
struct Trace {
  std::vector<double> forces_N;
  bool became_active = false;
  bool stayed_active = true;
  SiteState master = SiteState::configure, slave = SiteState::configure;
  SiteCause master_cause = SiteCause::none;
  double told_J = 0.0;  ///< by the slave, at the end

  /// Bit for bit.
  [[nodiscard]] bool same_forces(const Trace& other) const {
    for (std::size_t i = 0; i < forces_N.size(); ++i) {
      if (std::bit_cast<std::uint64_t>(forces_N[i]) != std::bit_cast<std::uint64_t>(other.forces_N[i])) return false;
    }
    return forces_N.size() == other.forces_N.size();
  }
};

Trace run(const simulation::Teleoperator::Params& params, const Origin& origin) {
  TwoSites sites = TwoSites::make(params, origin).value();
  Trace trace;
  while (sites.ticks() < run_ticks) {
    const auto& seen = sites.step();
    trace.forces_N.push_back(seen.master.output.site.motor_force_N);
    trace.forces_N.push_back(seen.slave.output.site.motor_force_N);
    trace.became_active = trace.became_active || sites.active();
    trace.stayed_active = trace.stayed_active && (!trace.became_active || sites.active());
    trace.master = static_cast<SiteState>(seen.master.output.record.state);
    trace.slave = static_cast<SiteState>(seen.slave.output.record.state);
    trace.master_cause = static_cast<SiteCause>(seen.master.output.record.cause);
    trace.told_J = seen.slave.output.packet.message.energy_J;
  }
  return trace;
}

const Trace& ordinary() {
  static const Trace trace = run(params_with("position-force"), {});
  return trace;
}

void expect_ordinary(const Origin& origin) {
  const Trace trace = run(params_with("position-force"), origin);
  EXPECT_TRUE(trace.became_active && trace.stayed_active);
  EXPECT_TRUE(trace.same_forces(ordinary()));
}

TEST(Wraps, AnOrdinaryRunTapsAndStaysActive) {
  EXPECT_TRUE(ordinary().became_active && ordinary().stayed_active);
  EXPECT_GT(*std::max_element(ordinary().forces_N.begin(), ordinary().forces_N.end()), 0.1);
}

TEST(Wraps, ClocksThatPassAPowerOfTwoChangeNoBitOfAForce) {
  for (const std::int64_t power : powers) {
    SCOPED_TRACE(power);
    expect_ordinary({.master_clock_ns = power - half_ns});
    expect_ordinary({.slave_clock_ns = power - half_ns});
  }
}

TEST(Wraps, ClocksThatCountToTheirLastNanosecondChangeNoBitOfAForce) {
  const std::int64_t last = largest - run_ns;
  expect_ordinary({.master_clock_ns = last});
  expect_ordinary({.master_clock_ns = 1, .slave_clock_ns = last});
  expect_ordinary({.master_clock_ns = last, .slave_clock_ns = last});
}

TEST(Wraps, SequencesThatPassAPowerOfTwoOrReachTheLastNumberChangeNoBitOfAForce) {
  for (const std::int64_t power : powers) {
    SCOPED_TRACE(power);
    expect_ordinary({.sequence = power - half_ticks});
  }
  expect_ordinary({.sequence = largest - run_ticks});
}

TEST(Wraps, AnySessionButZeroChangesNoBitOfAForce) {
  for (const std::int64_t session : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, powers[1], largest}) {
    SCOPED_TRACE(session);
    expect_ordinary({.master_session = session, .slave_session = session});
  }
}

TEST(Wraps, ArmingsCountToTheirLimitAndChangeNoBitOfAForce) {
  constexpr std::int64_t most = control::PacketJudge::most_armings;
  for (const std::int64_t armings : {std::int64_t{1}, most - 2, most - 1}) {
    SCOPED_TRACE(armings);
    expect_ordinary({.armings = armings});
  }
}

TEST(Wraps, AnArmingBeyondTheLimitArmsNothingAndIsGivenUp) {
  const Trace trace = run(params_with("position-force"), {.armings = control::PacketJudge::most_armings});
  EXPECT_FALSE(trace.became_active);
  EXPECT_EQ(trace.master, SiteState::hold);
  EXPECT_EQ(trace.master_cause, SiteCause::unanswered);
  EXPECT_EQ(trace.slave, SiteState::align);
}

TEST(Wraps, ToldEnergiesThatPassAMillionJoulesOrAPowerOfTwoStopNothing) {
  const auto params = params_with("time-domain-passivity");
  const Trace from_zero = run(params, {});
  ASSERT_TRUE(from_zero.became_active && from_zero.stayed_active);
  ASSERT_GT(from_zero.told_J, 1e-4);
  // What is told in the run crosses the number; a double still tells 0.5 uJ there.
  for (const double number : {1e6, std::ldexp(1.0, 31), std::ldexp(1.0, 32)}) {
    SCOPED_TRACE(number);
    // So many packets ago that no motor was needed which is stronger than a site's may be.
    const auto sequence = static_cast<std::int64_t>(number);
    const Trace trace = run(params, {.sequence = sequence, .energy_J = number - 0.5 * from_zero.told_J});
    EXPECT_TRUE(trace.became_active && trace.stayed_active);
  }
}

TEST(Wraps, AStallOfAnyNumberOfTicksStopsBothSitesAndNoForceIsWild) {
  const auto params = params_with("position-force");
  for (const std::int64_t elapsed : {powers[0], powers[1], powers[2], largest}) {
    SCOPED_TRACE(elapsed);
    TwoSites sites = TwoSites::make(params, {}).value();
    while (sites.ticks() < half_ticks) sites.step();
    ASSERT_TRUE(sites.active());
    // Twice, so that what sums them up passes its limit too.
    for (int stall = 0; stall < 2; ++stall) {
      const auto& seen = sites.step(elapsed);
      EXPECT_NE(seen.master.output.record.state, static_cast<std::int64_t>(SiteState::active));
      EXPECT_NE(seen.slave.output.record.state, static_cast<std::int64_t>(SiteState::active));
    }
    while (sites.ticks() < run_ticks) {
      const auto& seen = sites.step();
      ASSERT_FALSE(sites.active());
      ASSERT_LE(std::fabs(seen.master.output.site.motor_force_N), params.control.gate.force_limit_N);
      ASSERT_LE(std::fabs(seen.slave.output.site.motor_force_N), params.control.slave_gate.force_limit_N);
    }
  }
}

/// A socket of the loopback and one that sends to it.
struct Sockets {
  int to = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK, 0);
  int from = socket(AF_INET, SOCK_DGRAM, 0);
  Sockets() {
    sockaddr_in any{};
    any.sin_family = AF_INET;
    any.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(any);
    EXPECT_EQ(bind(to, reinterpret_cast<const sockaddr*>(&any), size), 0);
    EXPECT_EQ(getsockname(to, reinterpret_cast<sockaddr*>(&any), &size), 0);
    EXPECT_EQ(connect(from, reinterpret_cast<const sockaddr*>(&any), size), 0);
  }
  Sockets(const Sockets&) = delete;
  Sockets& operator=(const Sockets&) = delete;
  ~Sockets() {
    close(to);
    close(from);
  }
  /// Whether a record with this number gets through.
  bool admits(std::uint64_t number, std::size_t message_bytes) {
    std::vector<unsigned char> record(message_bytes + link::SecureChannel::overhead_bytes);
    const std::array<unsigned char, 5> head{23, 0xfe, 0xfd, 0, 1};
    std::copy(head.begin(), head.end(), record.begin());
    for (std::size_t i = 0; i < 6; ++i) record[5 + i] = static_cast<unsigned char>(number >> (8 * (5 - i)));
    const auto size = static_cast<ssize_t>(record.size());
    EXPECT_EQ(send(from, record.data(), record.size(), 0), size);
    return recv(to, record.data(), record.size(), 0) == size;
  }
};

TEST(Wraps, TheKernelsFilterKnowsOldRecordsWhereHalvesOfTheirNumberWrap) {
  constexpr std::size_t message_bytes = link::datagram_bytes;
  constexpr std::uint64_t half = std::uint64_t{1} << 32, last = (std::uint64_t{1} << 48) - 1;
  Sockets sockets;
  for (const std::uint64_t least : {std::uint64_t{1}, half - 1, half, half + 1, 3 * half - 1, 3 * half, last}) {
    SCOPED_TRACE(least);
    if (!link::admit_records(sockets.to, control::SiteRole::slave, message_bytes, least))
      GTEST_SKIP() << "the kernel takes no filter";
    EXPECT_FALSE(sockets.admits(least - 1, message_bytes));
    EXPECT_TRUE(sockets.admits(least, message_bytes));
    EXPECT_TRUE(sockets.admits(std::min(least + 1, last), message_bytes));
    EXPECT_FALSE(sockets.admits(least > half ? least - half : 0, message_bytes));
  }
}

}  // namespace
}  // namespace tactus::soak
