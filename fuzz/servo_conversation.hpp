// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/hardware/wire/wire_end.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

namespace fuzz {

inline void demand(bool holds) {
  if (!holds) std::abort();
}

/// Where the goals stand in a packet to all servos.
struct Goal {
  std::size_t size;        ///< of the packet
  std::size_t at, stride;  ///< of the first goal, and from one to the next
  std::size_t instruction_at;
  std::uint8_t instruction;
  std::size_t address_at;
  std::uint8_t address;
  int most;
  bool sign_bit;  ///< or two's complement
};

/// A bus and its peer.
template <class Bus, class Peer>
struct Conversation {
  Bus bus;
  Peer peer;
  Goal goal;
  std::int64_t now_ns = 0;

  void command() {
    for (std::size_t i = 0; i < bus.motors(); ++i) bus.command(i, {.torque_Nm = 0.015, .enabled = 1});
  }
  void check(std::span<const std::uint8_t> packet) const {
    if (packet.size() != goal.size || packet[goal.instruction_at] != goal.instruction) return;
    if (packet[goal.address_at] != goal.address) return;
    for (std::size_t at = goal.at + 1; at + 1 < packet.size() - 1; at += goal.stride) {
      const int raw = packet[at] + 256 * packet[at + 1];
      const int value = raw < 0x8000 ? raw : goal.sign_bit ? 0x8000 - raw : raw - 0x10000;
      demand(std::abs(value) <= goal.most);
    }
  }
  void talk(int turns, std::int64_t turn_ns) {
    for (int turn = 0; turn < turns; ++turn) {
      int said = 0;
      for (auto packet = bus.say(now_ns); !packet.empty(); packet = bus.say(now_ns)) {
        check(packet);
        peer.hear(packet, now_ns);
        demand(++said < 8);
      }
      now_ns += turn_ns;
      for (auto packet = peer.say(now_ns); !packet.empty(); packet = peer.say(now_ns)) bus.hear(packet, now_ns);
    }
  }
};

/// The input says what happens: the bus hears bytes of it, the peer hears bytes of it, time passes and each hears the
/// other; from the start, or with all in power already. Whatever it is, no goal is beyond what was commanded, what is
/// read is a number, and neither talks for ever.
template <class Bus, class Peer>
void converse(const Conversation<Bus, Peer>& begun, std::span<const std::uint8_t> input) {
  static const Conversation<Bus, Peer> in_power = [&begun] {
    Conversation<Bus, Peer> conversation = begun;
    conversation.command();
    conversation.talk(100, 2'000'000);
    for (std::size_t i = 0; i < conversation.bus.motors(); ++i) demand(conversation.bus.reading(i).enabled != 0);
    return conversation;
  }();
  if (input.empty()) return;
  Conversation<Bus, Peer> now = (input.front() & 1) != 0 ? in_power : begun;
  now.command();
  for (input = input.subspan(1); !input.empty();) {
    const std::uint8_t what = input.front();
    input = input.subspan(1);
    const auto bytes = input.first(std::min<std::size_t>(what >> 2, input.size()));
    switch (what & 3) {
      case 0:
        now.bus.hear(bytes, now.now_ns);
        input = input.subspan(bytes.size());
        break;
      case 1:
        now.peer.hear(bytes, now.now_ns);
        input = input.subspan(bytes.size());
        break;
      case 2:
        now.talk(1 + (what >> 5), 600'000);
        break;
      default:
        now.talk(1, std::int64_t{1'000'000} << (what >> 5));  // up to 128 ms
    }
    for (std::size_t i = 0; i < now.bus.motors(); ++i) {
      const auto& reading = now.bus.reading(i);
      demand(std::isfinite(reading.position_rad) && std::isfinite(reading.velocity_rad_per_s));
      demand(std::isfinite(reading.torque_Nm));
    }
  }
  if (now.bus.problem()) demand(now.bus.state() == tactus::devices::BusState::refused);
}

}  // namespace fuzz
