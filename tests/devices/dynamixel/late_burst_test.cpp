// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/hardware/wire/paced.hpp>

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::devices::dynamixel {
namespace late_burst_test {

using emulation::dynamixel::DynamixelPeer;

constexpr std::int64_t ms = 1'000'000;

/// A line whose adapter keeps what it hears for a while, once, and then hands over all of it at once.
class Stalling final : public wire::WireEnd {
 public:
  Stalling(wire::WireEnd& line, std::int64_t from_ns, std::int64_t until_ns)
      : line_(&line), from_ns_(from_ns), until_ns_(until_ns) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    constexpr std::uint8_t sync_write = 0x83;
    // The first packet of a cycle.
    if (bytes[7] == sync_write) {
      ++cycles_;
      if (answered_ < asked_) ++early_;
    }
    constexpr std::uint8_t sync_read = 0x82, fast_sync_read = 0x8a;
    if (bytes[7] == sync_read || bytes[7] == fast_sync_read) asked_ += bytes[7] == sync_read ? servos : 1;
    line_->hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    for (auto said = line_->say(now_ns); !said.empty(); said = line_->say(now_ns)) {
      waiting_.emplace_back(said.begin(), said.end());
    }
    const bool stalls = now_ns >= from_ns_ && now_ns < until_ns_;
    if (stalls || waiting_.empty()) return {};
    said_ = waiting_.front();
    waiting_.pop_front();
    constexpr std::size_t state_bytes = 21;  // one alone is longer than any other answer
    if (said_.size() >= state_bytes) ++answered_;
    return said_;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override {
    return waiting_.empty() ? line_->wakes_ns() : std::min(until_ns_, line_->wakes_ns());
  }
  /// Cycles that began, and those of them before all of the one before was heard.
  [[nodiscard]] std::int64_t cycles() const { return cycles_; }
  [[nodiscard]] std::int64_t early() const { return early_; }

  static constexpr std::int64_t servos = 4;

 private:
  wire::WireEnd* line_;
  std::int64_t from_ns_, until_ns_;
  std::deque<std::vector<std::uint8_t>> waiting_;
  std::vector<std::uint8_t> said_;
  std::int64_t asked_ = 0, answered_ = 0, cycles_ = 0, early_ = 0;
};

/// Answers that come late must not be taken for those to the next question: every answer would be a cycle old from then
/// on, and each question would meet the answers to the one before on the line.
TEST(DynamixelBus, ALateBurstDoesNotLeaveItACycleBehind) {
  for (const bool fast : {false, true}) {
    for (std::int64_t stall_ns = ms; stall_ns < 20 * ms; stall_ns += ms / 4) {
      DynamixelPeer::Params there;
      DynamixelBus::Params here;
      there.servos.clear();
      for (std::int64_t id = 1; id <= Stalling::servos; ++id) {
        there.servos.push_back({.id = id});
        here.motors.push_back({.id = id});
      }
      here.fast_sync_read = fast;
      auto peer = DynamixelPeer::make(there).value();
      auto bus = DynamixelBus::make(here).value();
      wire::Paced line(peer, wire::byte_ns(there.bits_per_s), wire::Paced::Line::half_duplex);
      constexpr std::int64_t begin_ns = 400 * ms, end_ns = 600 * ms;
      // Two waits for an answer that does not come.
      const std::int64_t settled_ns = begin_ns + stall_ns + 8 * ms;
      Stalling adapter(line, begin_ns, begin_ns + stall_ns);
      wire::join(bus, adapter, 0, settled_ns);
      ASSERT_EQ(bus.state(), BusState::ready);
      const std::int64_t cycles = adapter.cycles(), early = adapter.early();
      wire::join(bus, adapter, settled_ns, end_ns);
      EXPECT_GT(adapter.cycles() - cycles, 40);
      EXPECT_EQ(adapter.early() - early, 0) << (fast ? "fast, " : "plain, ") << stall_ns / 1000 << " us";
    }
  }
}

/// Asked again because the first answer was late, a servo answers twice, and is no two servos.
TEST(DynamixelBus, AServoWhoseAnswerWasLateIsNotTakenForTwo) {
  for (std::int64_t begin_ns = 0; begin_ns < 20 * ms; begin_ns += ms / 2) {
    for (const std::int64_t stall_ns : {2 * ms, 3 * ms, 5 * ms, 80 * ms}) {
      DynamixelPeer::Params there;
      DynamixelBus::Params here;
      there.servos.clear();
      for (std::int64_t id = 1; id <= Stalling::servos; ++id) {
        there.servos.push_back({.id = id});
        here.motors.push_back({.id = id});
      }
      auto peer = DynamixelPeer::make(there).value();
      auto bus = DynamixelBus::make(here).value();
      wire::Paced line(peer, wire::byte_ns(there.bits_per_s), wire::Paced::Line::half_duplex);
      Stalling adapter(line, begin_ns, begin_ns + stall_ns);
      wire::join(bus, adapter, 0, 300 * ms);
      EXPECT_EQ(bus.state(), BusState::ready)
          << begin_ns / 1000 << " us: " << (bus.problem() ? describe(*bus.problem()) : std::string());
    }
  }
}

}  // namespace late_burst_test
}  // namespace tactus::devices::dynamixel
