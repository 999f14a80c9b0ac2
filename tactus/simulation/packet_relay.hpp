#pragma once

#include <tactus/control/packet.hpp>
#include <tactus/simulation/fault_plan.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactus::simulation {

/// One way of the link in ticks of virtual time: packets in, whatever a faulty network makes of them out. It counts the
/// ticks that it is asked, so packets wait for a site that is not stepped.
class PacketRelay {
 public:
  /// A relay that impairs packets while `send` is told to. `tick_s` is the duration of a tick.
  PacketRelay(const Impairment& impairment, signal::Random random, double tick_s)
      : link_(impairment, random),
        tick_s_(tick_s),
        slots_(static_cast<std::size_t>(std::ceil((impairment.delay_s + impairment.jitter_s) / tick_s)) + 2) {}

  /// Sends a packet at `tick`. `share` of the impairment's delay is there now, 0 for no impairment. Does not allocate.
  void send(const control::Packet& packet, std::int64_t tick, double share) noexcept {
    const PacketFate fate = share > 0.0 ? link_.next() : PacketFate{};
    for (int copy = 0; copy < fate.copies; ++copy) {
      const auto late = static_cast<std::int64_t>(share * fate.delay_s[static_cast<std::size_t>(copy)] / tick_s_);
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
      control::Packet packet = slot.waiting[i].packet;
      packet.age_s = static_cast<double>(tick - slot.waiting[i].sent_tick) * tick_s_;
      take(packet);
    }
    slot.count = 0;
  }

 private:
  struct Waiting {
    control::Packet packet;
    std::int64_t sent_tick = 0;
  };
  struct Slot {
    std::array<Waiting, 12> waiting;
    std::size_t count = 0;
  };

  ImpairedLink link_;
  double tick_s_;
  std::vector<Slot> slots_;  ///< a ring, as long as the longest way takes
};

}  // namespace tactus::simulation
