#include "virtual_wall.hpp"

#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>
#include <tactus/simulation/teleoperator/site_plants.hpp>

#include <algorithm>

using namespace tactus;

namespace {

constexpr double approach_m = 0.02, reach_s = 0.3;

/// Presses onto a wall at 0 from 20 mm before it. The force of the wall, which only pushes, is commanded at each tick
/// from the encoder's position x and the velocity v that follows from it:
///
///     F = −max(0, K·x + B·v)  where x > 0
Result<Press> press(const VirtualWallParams& params, double stiffness_N_per_m) {
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  auto master = simulation::MasterPlant::make(params.master, params.person, *clock, -approach_m);
  if (!master) return master.error();
  auto velocity = signal::FilteredDerivative::make(params.wall.velocity, Seconds{clock->tick_s});
  if (!velocity) return under("wall.velocity", velocity.error());

  const mechanics::MinimumJerk path{.start_m = -approach_m, .end_m = params.task.press_m, .duration_s = reach_s};
  Press result;
  std::size_t first_touch = 0;
  bool touched = false;
  for (std::size_t tick = 0;; ++tick) {
    const double now_s = static_cast<double>(tick) * clock->tick_s;
    const double position_m = master->read({}).position_m;
    const double velocity_m_per_s = velocity->step(position_m);
    const double wall_N = stiffness_N_per_m * position_m + params.wall.damping_N_s_per_m * velocity_m_per_s;
    const double force_N = position_m > 0.0 ? std::max(0.0, wall_N) : 0.0;
    master->write({.force_N = -force_N});
    if (!touched && force_N > 0.0) {
      touched = true;
      first_touch = tick;
    }
    result.time_s.push_back(now_s);
    result.force_N.push_back(force_N);
    result.pressed_in_m = position_m;
    const double seen_s = static_cast<double>(tick - first_touch) * clock->tick_s;
    if (touched && seen_s >= params.task.observation_s) break;
    if (!touched && now_s > 2.0 * reach_s) break;  // too weak a hand to get there
    master->begin_tick(path.position_m(now_s), path.position_m(now_s + clock->tick_s));
    for (int i = 0; i < clock->substeps; ++i) master->substep(i);
  }
  if (!touched) return result;
  const experiments::ContactMetrics metrics = experiments::judge_contact(result.force_N, first_touch, clock->tick_s);
  result.settles = metrics.settled;
  result.settling_time_s = metrics.settling_time_s;
  return result;
}

}  // namespace

Check check_virtual_wall(const VirtualWallParams& params) {
  if (params.task.softest_N_per_m >= params.task.stiffest_N_per_m) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "task.stiffest_N_per_m",
                 .message = format_number(params.task.stiffest_N_per_m) + " N/m is not above softest_N_per_m, " +
                            format_number(params.task.softest_N_per_m) + " N/m: raise one or lower the other",
                 .place = {}};
  }
  const auto tried = press(params, params.task.softest_N_per_m);
  return tried ? Check{} : Check{tried.error()};
}

Result<VirtualWallResult> stiffest_wall(const VirtualWallParams& params) {
  if (Check error = check_virtual_wall(params)) return *std::move(error);
  VirtualWallResult result;
  result.limit_N_per_m = experiments::find_gain_limit(
      params.task.softest_N_per_m, params.task.stiffest_N_per_m,
      [&params](double stiffness_N_per_m) { return press(params, stiffness_N_per_m)->settles; });
  const double limit_N_per_m = std::max(result.limit_N_per_m.gain, params.task.softest_N_per_m);
  result.settled = *press(params, limit_N_per_m);
  result.stiffer = *press(params, 2.0 * limit_N_per_m);
  return result;
}
