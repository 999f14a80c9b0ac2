// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace tactus::runtime {

/// How many there are of each value of an enum that begins at 0 and leaves none out.
template <class Word>
struct CountOfEach {
  std::array<std::int64_t, enumerators(Word{}).size()> counts{};
  std::int64_t& operator[](Word word) noexcept { return counts[static_cast<std::size_t>(word)]; }
  std::int64_t operator[](Word word) const noexcept { return counts[static_cast<std::size_t>(word)]; }
};

/// What a site went through.
struct SiteTotals {
  double duration_s = 0.0;
  std::int64_t ticks = 0;
  CountOfEach<control::SiteState> ticks_in;         ///< by state
  CountOfEach<control::ActiveLimit> ticks_limited;  ///< by what changed the force
  CountOfEach<control::SiteCause> holds;            ///< by what led into hold
  CountOfEach<control::GateFault> faults;           ///< by what the gate latched
  std::int64_t armings = 0;                         ///< out of align or hold
  double longest_silence_at_hold_s = 0.0;
  double peak_force_N = 0.0;
  double largest_force_step_N = 0.0;           ///< of the motor from tick to tick
  double largest_resuming_force_step_N = 0.0;  ///< the same in the first second after the site became active
  double force_step_limit_N = 0.0;             ///< what the gate allows
  std::int64_t steps_above_limit = 0;
  std::int64_t not_finite = 0;  ///< forces or messages that are not finite: must be 0
};

/// One second of a site, for the display. State, cause, limit and fault are those of its end.
struct SiteSecond {
  control::SiteRole role = control::SiteRole::master;
  double time_s = 0.0;  ///< of its end, since the start
  control::SiteState state = control::SiteState::configure;
  control::SiteCause cause = control::SiteCause::started;
  control::ActiveLimit limit = control::ActiveLimit::none;
  control::GateFault fault = control::GateFault::none;
  double round_trip_s = 0.0;  ///< mean over the packets that were applied in the second, as age
  double age_s = 0.0;
  double loss_fraction = 0.0;
  double peak_force_N = 0.0;  ///< of the motor, either way
};

/// The counters of a site, kept from the record of each tick. A value; real-time safe.
class SiteCounters {
 public:
  /// Of a site whose gate lets the force change by `force_step_limit_N` a tick.
  SiteCounters(control::SiteRole role, double tick_s, double force_step_limit_N) : role_(role), tick_s_(tick_s) {
    totals_.force_step_limit_N = force_step_limit_N;
  }

  /// One tick, `time_s` after the first.
  void step(const SiteLogRecord& record, double time_s) noexcept;
  /// Closes the second that has begun; what only a link knows is left at 0.
  SiteSecond end_second() noexcept;
  /// Whether a second has begun.
  [[nodiscard]] bool in_a_second() const noexcept { return second_ticks_ > 0; }

  [[nodiscard]] const SiteTotals& totals() const noexcept { return totals_; }
  /// Of the tick before; as made before the first.
  [[nodiscard]] const SiteLogRecord& last() const noexcept { return last_; }
  [[nodiscard]] control::SiteState state() const noexcept { return static_cast<control::SiteState>(last_.state); }

 private:
  void judge(const SiteLogRecord& record) noexcept;
  void measure(const SiteLogRecord& record) noexcept;

  control::SiteRole role_;
  double tick_s_;
  SiteTotals totals_;
  SiteLogRecord last_;
  std::int64_t ticks_since_active_ = 0;
  std::int64_t second_ticks_ = 0;
  double second_peak_N_ = 0.0;
};

}  // namespace tactus::runtime
