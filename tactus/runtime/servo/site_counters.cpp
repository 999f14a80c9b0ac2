// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_counters.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::runtime {

namespace {

constexpr double resuming_s = 1.0;

}  // namespace

void SiteCounters::step(const SiteLogRecord& record, double time_s) noexcept {
  judge(record);
  measure(record);
  last_ = record;
  ++totals_.ticks;
  ++second_ticks_;
  totals_.duration_s = time_s;
}

void SiteCounters::judge(const SiteLogRecord& record) noexcept {
  using control::SiteState;
  const SiteState before = state(), now = static_cast<SiteState>(record.state);
  ++totals_.ticks_in[now];
  ++totals_.ticks_limited[static_cast<control::ActiveLimit>(record.limit)];
  ++ticks_since_active_;
  if (now == before) return;
  if (now == SiteState::armed && (before == SiteState::align || before == SiteState::hold)) ++totals_.armings;
  if (now == SiteState::active) ticks_since_active_ = 0;
  if (now == SiteState::fault) ++totals_.faults[static_cast<control::GateFault>(record.fault)];
  if (now == SiteState::hold) {
    ++totals_.holds[static_cast<control::SiteCause>(record.cause)];
    totals_.longest_silence_at_hold_s = std::max(totals_.longest_silence_at_hold_s, record.silence_s);
  }
}

void SiteCounters::measure(const SiteLogRecord& record) noexcept {
  const double force_N = record.motor_force_N;
  if (!std::isfinite(force_N) || !control::is_finite(static_cast<const SiteLogRecord::Sent&>(record)))
    ++totals_.not_finite;
  const double step_N = std::fabs(force_N - last_.motor_force_N);
  constexpr double round_off = 1e-12;
  if (step_N > totals_.force_step_limit_N * (1.0 + round_off)) ++totals_.steps_above_limit;
  totals_.peak_force_N = std::max(totals_.peak_force_N, std::fabs(force_N));
  second_peak_N_ = std::max(second_peak_N_, std::fabs(force_N));
  totals_.largest_force_step_N = std::max(totals_.largest_force_step_N, step_N);
  if (totals_.ticks_in[control::SiteState::active] > 0 &&
      static_cast<double>(ticks_since_active_) * tick_s_ < resuming_s) {
    totals_.largest_resuming_force_step_N = std::max(totals_.largest_resuming_force_step_N, step_N);
  }
}

SiteSecond SiteCounters::end_second() noexcept {
  const SiteSecond second{.role = role_,
                          .time_s = totals_.duration_s,
                          .state = state(),
                          .cause = static_cast<control::SiteCause>(last_.cause),
                          .limit = static_cast<control::ActiveLimit>(last_.limit),
                          .fault = static_cast<control::GateFault>(last_.fault),
                          .peak_force_N = second_peak_N_};
  second_ticks_ = 0;
  second_peak_N_ = 0.0;
  return second;
}

}  // namespace tactus::runtime
