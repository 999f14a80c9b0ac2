// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/real_time_arm_tap.hpp>

#include <cmath>
#include <utility>

namespace tactus::real_time {

Result<RealTimeArmTap> RealTimeArmTap::make(const experiments::ArmPairSetup& setup, const experiments::ArmTap& tap,
                                            ArmTapStreams* streams) {
  auto run = experiments::ArmTapRun::make(setup, tap);
  if (!run) return run.error();
  return RealTimeArmTap(*std::move(run), streams);
}

RealTimeArmTap::RealTimeArmTap(experiments::ArmTapRun run, ArmTapStreams* streams)
    : run_(std::move(run)), streams_(streams), period_ns_(std::llround(1e9 * run_.pair().tick_s())) {}

bool RealTimeArmTap::step(const station::Tick& tick) noexcept {
  // Time counts from the first step, as that of the tap does.
  station::Tick own = tick;
  if (first_tick_ < 0) {
    first_tick_ = tick.number;
    own.missed = 0;
  }
  own.number -= first_tick_;
  for (std::int64_t lost = own.missed; lost > 0 && !run_.over(); --lost) {
    step_arms(tick.deadline_ns - lost * period_ns_);
  }
  if (run_.over()) return false;
  const Joints<control::Message> master_heard = run_.pair().sites().at_master();
  run_.step_sites(own);
  if (streams_ != nullptr) streams_->push(own, run_.pair().sites(), run_.pair().latest(), master_heard);
  step_arms(tick.deadline_ns);
  return !run_.over();
}

void RealTimeArmTap::step_arms(std::int64_t began_ns) noexcept {
  run_.step_arms();
  if (streams_ != nullptr) streams_->push_tools(began_ns, run_.trace().records.back());
}

}  // namespace tactus::real_time
