// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/simulation/teleoperator/fault_plan.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactus::simulation {

/// One way of the link in ticks of virtual time: packets in, whatever a faulty network makes of them out. It counts the
/// ticks that it is asked, so packets wait for a site that is not stepped.
template <class Packet>
class PacketRelayOf {
 public:
  /// A relay whose packets pass one link after another, each of which impairs them while `send` is commanded to.
  /// `tick_s` is the duration of a tick.
  PacketRelayOf(const std::vector<ImpairedLink>& links, double longest_way_s, double tick_s)
      : links_(links), tick_s_(tick_s), slots_(static_cast<std::size_t>(std::ceil(longest_way_s / tick_s)) + 2) {}

  /// Sends a packet at `tick`. `share(i)` of the delay of link number i is there now, 0 for no impairment. What comes
  /// twice from one link comes no more often from the next. Does not allocate.
  template <class Share>
  void send(const Packet& packet, std::int64_t tick, Share&& share) noexcept {
    PacketFate fate;
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const double of_delay = share(i);
      if (of_delay <= 0.0) continue;
      const PacketFate next = links_[i].next();
      fate.copies = std::min(fate.copies * next.copies, 2);
      for (std::size_t copy = 0; copy < fate.delay_s.size(); ++copy) {
        fate.delay_s[copy] += of_delay * next.delay_s[copy];
      }
    }
    for (int copy = 0; copy < fate.copies; ++copy) {
      const auto late = static_cast<std::int64_t>(fate.delay_s[static_cast<std::size_t>(copy)] / tick_s_);
      Slot& slot = slots_[static_cast<std::size_t>(tick + late) % slots_.size()];
      // What finds no room is lost, as in a queue of a network.
      if (slot.count < slot.waiting.size()) slot.waiting[slot.count++] = {packet, tick};
    }
  }

  /// Calls `take` with every packet that arrives at `tick`, its age filled in. Once each tick, in order of ticks.
  template <class Take>
  void deliver(std::int64_t tick, Take&& take) noexcept {
    Slot& slot = slots_[static_cast<std::size_t>(tick) % slots_.size()];
    for (std::size_t i = 0; i < slot.count; ++i) {
      Packet packet = slot.waiting[i].packet;
      packet.age_s = static_cast<double>(tick - slot.waiting[i].sent_tick) * tick_s_;
      take(packet);
    }
    slot.count = 0;
  }

 private:
  struct Waiting {
    Packet packet;
    std::int64_t sent_tick = 0;
  };
  struct Slot {
    std::array<Waiting, 12> waiting;
    std::size_t count = 0;
  };

  std::vector<ImpairedLink> links_;
  double tick_s_;
  std::vector<Slot> slots_;  ///< a ring, as long as the longest way takes
};
/// Of sites of one axis, and of several joints.
using PacketRelay = PacketRelayOf<control::Packet>;
using JointPacketRelay = PacketRelayOf<control::JointPacket>;

}  // namespace tactus::simulation
