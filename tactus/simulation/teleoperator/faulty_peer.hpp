// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

namespace tactus::simulation {

/// What a site that is alive states when it goes wrong: it repeats itself, or reports what could be and is not. Of a
/// plan that is for another part or site it states what it means.
class FaultyPeer {
 public:
  /// How a site that is wrong is wrong, by the plan's choice.
  enum class Wrong { sign, scale, frozen, noise };
  static constexpr std::int64_t ways = 4;

  FaultyPeer(const FaultPlan& plan, FaultSite site)
      : plan_(plan),
        here_(plan.site == site),
        random_(signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(site == FaultSite::master ? 11 : 12)) {}

  /// What the site sends in place of `packet`. Once a tick. Real-time safe.
  void step(control::Packet& packet, const FaultMoment& moment) noexcept {
    if (moment.before || moment.begins) last_ = packet;
    if (!here_ || !moment.during) return;
    if (plan_.kind == FaultKind::peer_repeats) {
      const std::int64_t session = packet.session, sequence = packet.sequence;
      packet = last_;
      packet.session = session;
      packet.sequence = sequence;
    } else if (plan_.kind == FaultKind::peer_wrong) {
      spoil(packet.message);
    }
  }

 private:
  void spoil(control::Message& message) noexcept {
    switch (static_cast<Wrong>(plan_.choice % ways)) {
      case Wrong::sign:
        scale(message, -1.0);
        break;
      case Wrong::scale:
        scale(message, -plan_.size);
        break;
      case Wrong::frozen:
        message = last_.message;
        break;
      case Wrong::noise:
        message.position_m += noise_m * random_.normal();
        message.force_N += noise_N * random_.normal();
        break;
    }
  }
  static void scale(control::Message& message, double factor) noexcept {
    for (double* value : {&message.position_m, &message.velocity_m_per_s, &message.force_N, &message.wave}) {
      *value *= factor;
    }
  }

  static constexpr double noise_m = 0.005, noise_N = 2.0;

  FaultPlan plan_;
  bool here_;
  signal::Random random_;
  control::Packet last_;  ///< sent before the fault
};

}  // namespace tactus::simulation
