// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/interfaces/live/axis_loop.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace tactus::live {

namespace {

/// Beyond this a device has left its workspace, as in the tapping experiment.
constexpr double device_reach_m = 1.0;

template <Described T>
bool are_equal(const T& one, const T& other) {
  return configuration::to_toml(one) == configuration::to_toml(other);
}

}  // namespace

Result<std::unique_ptr<Loop>> AxisLoop::make(const Teleoperator::Params& params, double start_m,
                                             const Teleoperator::Parts& parts) {
  const auto made = Teleoperator::make(params, start_m);
  if (!made) return made.error();
  const double reach_m = device_reach_m * std::max(1.0, params.control.position_scale);
  return std::unique_ptr<Loop>(new AxisLoop(*made, reach_m, parts));
}

Result<LoopChange> AxisLoop::change(const Teleoperator::Params& before, const Teleoperator::Params& after,
                                    double start_m) {
  const bool goes_on = before.control.architecture == after.control.architecture;
  const Teleoperator::Parts parts{.grip = !are_equal(before.person, after.person),
                                  .environment = !are_equal(before.environment, after.environment),
                                  .channel = !are_equal(before.channel, after.channel),
                                  .controllers = !are_equal(before.control, after.control)};
  if (parts == Teleoperator::Parts{}) return LoopChange{};
  auto made = make(after, goes_on ? 0.0 : start_m, parts);
  if (!made) return made.error();
  return LoopChange{.made = *std::move(made), .goes_on = goes_on};
}

void AxisLoop::step(const HandPoint& path, const HandPoint& path_at_next_tick, double share, LoopTick& tick) noexcept {
  tick.record = teleoperator_.step(path[0], path_at_next_tick[0], share);
  // Written so that a NaN counts as outside.
  inside_ = std::fabs(tick.record.master_position_m) < reach_m_ && std::fabs(tick.record.tip_position_m) < reach_m_;
}

void AxisLoop::exchange(Loop& made) noexcept {
  auto& other = static_cast<AxisLoop&>(made);
  teleoperator_.exchange(other.teleoperator_, other.parts_);
}

}  // namespace tactus::live
