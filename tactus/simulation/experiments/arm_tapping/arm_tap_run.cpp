// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_tapping/arm_tap_run.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>

#include <cmath>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr double no_touch_timeout_s = 2.0;  ///< after the reach, for a follower that has not touched
constexpr double farthest_m = 0.3;          ///< from where it began, for a follower's tool that has not run away

}  // namespace

Result<ArmTapRun> ArmTapRun::make(const ArmPairSetup& setup, const ArmTap& tap) {
  auto pair = ArmPair::make(setup, tap.model_params, tap.wall_m, tap.plant_errors);
  if (!pair) return pair.error();
  return ArmTapRun(setup, tap, *std::move(pair));
}

ArmTapRun::ArmTapRun(const ArmPairSetup& setup, const ArmTap& tap, ArmPair pair)
    : setup_(&setup),
      tap_(&tap),
      pair_(std::move(pair)),
      last_(ticks_in(tap.path.start_time_s + tap.path.duration_s + no_touch_timeout_s, pair_.tick_s())) {
  // So that a tick does not allocate: a touch comes before `last_`, and the observation after it.
  trace_.records.reserve(last_ + ticks_in(setup.params.task.observation_s, pair_.tick_s()));
}

void ArmTapRun::step_arms() {
  const double dt_s = pair_.tick_s();
  const std::size_t k = trace_.records.size();
  const double now_s = static_cast<double>(k) * dt_s;
  const arm::Vector3& outward = setup_->outward;
  trace_.records.push_back(
      pair_.step_arms(tap_->path.position_m(now_s) * outward, tap_->path.position_m(now_s + dt_s) * outward));
  const ArmRecord& record = trace_.records.back();
  if (!touched_ && record.contact_N > 0.0) {
    touched_ = true;
    first_touch_ = k;
    last_ = k + ticks_in(setup_->params.task.observation_s, dt_s);
  }
  if (touched_ && k == first_touch_ + ticks_in(pressing_after_s, dt_s)) {
    trace_.pressing = {record.contact_N, pair_.snapshot()};
  }
  diverged_ = !pair_.healthy() || !(std::fabs(record.leader_m) * setup_->tool_scale < farthest_m) ||
              !(std::fabs(record.follower_m) < farthest_m);
}

ArmContact ArmTapRun::contact() const {
  return touched_ ? judge_arm_contact(trace_.records, first_touch_, pair_.tick_s()) : ArmContact{};
}

}  // namespace tactus::experiments
