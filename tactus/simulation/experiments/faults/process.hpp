// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/simulation/experiments/faults/injection.hpp>
#include <tactus/simulation/teleoperator/packet_relay.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace tactus::experiments {

/// How the process of one site fares: whether it lives and is stepped, how long it was not, and what waits for it. What
/// goes wrong is a vector of whatever injects it, into one axis (`FaultInjection`) or into arms.
template <class Packet>
class FaultProcessOf {
 public:
  explicit FaultProcessOf(FaultSite site) : site_(site) { waiting_.reserve(4096); }

  /// One tick of the faults; `missed` where the machine itself steps no site. Returns whether the process must be
  /// started again, under the next session.
  template <class Injection>
  bool fare(std::vector<Injection>& injections, bool missed) noexcept {
    using Beat = simulation::FaultyClock::Beat;
    bool dead = false, stands = missed, sleeps = false;
    for (Injection& injection : injections) {
      const Beat beat = injection.at(site_).clock.step(injection.moment(), sleeps);
      dead = dead || beat == Beat::dead;
      stands = stands || beat == Beat::stands;
      sleeps = sleeps || beat == Beat::sleeps;
    }
    born_ = false;
    if (dead) {
      killed_ = true;
      stalled_ = false;
      waiting_.clear();
    } else if (killed_) {
      if (missed) return false;
      killed_ = false;
      born_ = true;
      elapsed_ticks_ = 1;
      ++session_;
    } else {
      // The first step after a stall counts the ticks before it, but for those in which the clock slept too.
      if (!sleeps_) elapsed_ticks_ = stalled_ ? elapsed_ticks_ + 1 : 1;
      stalled_ = stands || sleeps;
      sleeps_ = sleeps;
    }
    return born_;
  }

  /// Takes what the relay delivers at `tick`. Each tick.
  template <class Injection>
  void collect(simulation::PacketRelayOf<Packet>& relay, std::int64_t tick,
               const std::vector<Injection>& injections) noexcept {
    relay.deliver(tick, [&](Packet packet) {
      if (killed_) return;
      for (const Injection& injection : injections) {
        if (injection.sleeps()) return;
        packet.age_s = std::max(packet.age_s + injection.age_error_s(site_), 0.0);
        injection.spoil(site_, packet);
      }
      if (waiting_.size() < waiting_.capacity()) waiting_.push_back(packet);
    });
  }
  /// Gives all that waits to `take`. Where the site is stepped.
  template <class Take>
  void hand_over(double tick_s, Take&& take) noexcept {
    for (Packet& packet : waiting_) {
      // What waited in the queue of a stalled site has aged there.
      packet.age_s += static_cast<double>(elapsed_ticks_ - 1) * tick_s;
      take(packet);
    }
    waiting_.clear();
  }

  [[nodiscard]] FaultSite site() const noexcept { return site_; }
  [[nodiscard]] bool killed() const noexcept { return killed_; }
  [[nodiscard]] bool stands_still() const noexcept { return killed_ || stalled_; }
  /// It just died or started, which no gate can smooth.
  [[nodiscard]] bool excused() const noexcept { return killed_ || born_; }
  [[nodiscard]] std::int64_t elapsed_ticks() const noexcept { return elapsed_ticks_; }
  [[nodiscard]] std::int64_t session() const noexcept { return session_; }

 private:
  FaultSite site_;
  std::int64_t elapsed_ticks_ = 1;
  std::int64_t session_ = 1;
  bool killed_ = false;
  bool born_ = false;     ///< at this tick
  bool stalled_ = false;  ///< by a fault or, in real time, by the machine
  bool sleeps_ = false;   ///< and its clock with it
  std::vector<Packet> waiting_;
};
using FaultProcess = FaultProcessOf<control::Packet>;

}  // namespace tactus::experiments
