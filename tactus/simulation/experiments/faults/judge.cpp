// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/judge.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>

#include <algorithm>

namespace tactus::experiments {

using control::SiteState;
using namespace fault_schedule;

void FaultJudge::see_states(const SiteView& master, const SiteView& slave, const FaultMoment& moment,
                            bool before_rearming, FaultOutcome& outcome) {
  const auto since_ticks = static_cast<std::int64_t>(std::lround(moment.since_s / tick_s_));
  bool none_active = true, all_latched = true;
  for (int i = 0; i < 2; ++i) {
    const SiteView& site = i == 0 ? master : slave;
    const bool active = !site.gone && site.state == SiteState::active;
    none_active = none_active && !active;
    if (active && before_rearming) {
      (i == 0 ? outcome.master_followed_s : outcome.slave_followed_s) = static_cast<double>(since_ticks + 1) * tick_s_;
    }
    const bool latched = site.gone || site.state == SiteState::hold || site.state == SiteState::fault;
    if (latched && outcome.detection_ticks < 0) outcome.detection_ticks = since_ticks;
    all_latched = all_latched && latched;
    outcome.left_workspace = outcome.left_workspace || site.left_workspace;
    if (!before_rearming) continue;
    if (left_[i] && active) ++outcome.active_without_arming;
    left_[i] = left_[i] || (outcome.became_active && !active);
  }
  if (before_rearming && outcome.became_active && none_active && !outcome.stopped) {
    outcome.stopped = true;
    outcome.time_to_stop_s = static_cast<double>(since_ticks) * tick_s_;
    stopped_at_s_ = moment.now_s;
  }
  if (before_rearming && all_latched && latched_at_s_ < 0.0) latched_at_s_ = moment.now_s;
}

void FaultJudge::see(const SiteView& master, const SiteView& slave, const FaultMoment& moment, double end_s,
                     FaultOutcome& outcome) {
  outcome.given_J = master.truth.enter(energy_);
  const bool both = master.state == SiteState::active && slave.state == SiteState::active;
  if (moment.before) {
    outcome.became_active = both;
    return;
  }
  outcome.active_in_fault = outcome.active_in_fault || (both && moment.during);
  const double now_s = moment.now_s;
  const bool before_rearming = now_s <= end_s + look_after_s;
  see_states(master, slave, moment, before_rearming, outcome);
  if (before_rearming) {
    at_master_.see(master.truth, now_s, outcome.master);
    at_slave_.see(slave.truth, now_s, outcome.slave);
    if (outcome.stopped) {
      outcome.master.release_s = std::max(at_master_.forced_s() - stopped_at_s_, 0.0);
      outcome.slave.release_s = std::max(at_slave_.forced_s() - stopped_at_s_, 0.0);
    }
    const double forced_s = std::max(at_master_.forced_s(), at_slave_.forced_s());
    if (latched_at_s_ >= 0.0) outcome.release_s = std::max(forced_s - latched_at_s_, 0.0);
    rearms_ = !both;
  }
  if (rearms_ && now_s > end_s + rearm_after_s && now_s < end_s + repress_after_s + resume_watch_s) {
    outcome.resume_step_N = std::max({outcome.resume_step_N, master.step_N, slave.step_N});
  }
  if (now_s >= end_s + settled_after_s) outcome.active_at_end = both;
}

}  // namespace tactus::experiments
