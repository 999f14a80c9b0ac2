// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/observer.hpp>
#include <tactus/simulation/real_time/hand_session.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace tactus::real_time {

namespace {

constexpr double rest_before_s = 0.3;
constexpr double workspace_m = 1.0;

}  // namespace

TapScript::TapScript(const experiments::TappingParams& params) {
  const experiments::TappingTask& task = params.task;
  const double depth_m = 0.5 * (task.shallowest_m + task.deepest_m);
  const double wall_m = params.environment.position_m / params.control.position_scale;
  for (std::int64_t i = 0; i < task.taps; ++i) {
    const double share = task.taps == 1 ? 0.5 : static_cast<double>(i) / static_cast<double>(task.taps - 1);
    const double speed = task.slowest_m_per_s + share * (task.fastest_m_per_s - task.slowest_m_per_s);
    const double reach_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed);
    const double reaches_s = duration_s_ + rest_before_s;
    const double returns_s = reaches_s + reach_s + task.observation_s;
    taps_.push_back({.reach = {wall_m - depth_m, wall_m + depth_m, reaches_s, reach_s},
                     .back = {wall_m + depth_m, wall_m - depth_m, returns_s, reach_s}});
    duration_s_ = returns_s + reach_s;
  }
}

double TapScript::position_m(double time_s) const {
  const auto later = std::upper_bound(taps_.begin(), taps_.end(), time_s, [](double time, const Tap& tap) {
    return time < tap.reach.start_time_s - rest_before_s;
  });
  const Tap& tap = later == taps_.begin() ? taps_.front() : *std::prev(later);
  return time_s < tap.back.start_time_s ? tap.reach.position_m(time_s) : tap.back.position_m(time_s);
}

Result<HandSession> HandSession::make(const experiments::TappingParams& params) {
  if (auto error = experiments::refuse_supervised(params, "run --ros2")) return *std::move(error);
  // The whole experiment is checked, as without ROS 2.
  if (const auto ensemble = experiments::TappingEnsemble::make(params); !ensemble) return ensemble.error();
  TapScript script(params);
  auto teleoperator = simulation::Teleoperator::make(params, script.position_m(0.0));
  if (!teleoperator) return teleoperator.error();
  const auto path = ros2::RemotePath::make({}, Seconds{teleoperator->tick_s()});
  if (!path) return path.error();
  return HandSession(*std::move(teleoperator), *path, std::move(script), workspace_m * params.control.position_scale);
}

HandSession::HandSession(simulation::Teleoperator teleoperator, const ros2::RemotePath& path, TapScript script,
                         double slave_workspace_m)
    : teleoperator_(std::move(teleoperator)),
      path_(path),
      script_(std::move(script)),
      slave_workspace_m_(slave_workspace_m),
      path_m_(script_.position_m(0.0)) {}

void HandSession::begin(ros2::Bridge& bridge, const runtime::RealTimeStreams& streams, const runtime::EndRequest& end) {
  bridge_ = &bridge;
  streams_ = streams;
  end_ = &end;
  to_time_of_day_ns_ = ros2::to_time_of_day_ns();
}

bool HandSession::operator()(const station::Tick& tick) noexcept {
  if (end_->insisted()) return false;
  if (first_tick_ < 0) first_tick_ = tick.number;
  while (done_ <= tick.number - first_tick_) {
    const bool over = time_s() >= script_.duration_s() || end_->asked() || diverged_;
    advance(tick.deadline_ns + to_time_of_day_ns_, over ? 0.0 : 1.0);
    if (!over) continue;
    letting_go_s_ += teleoperator_.tick_s();
    if (teleoperator_.at_rest() || letting_go_s_ >= runtime::longest_ramp_s) return false;
  }
  return true;
}

void HandSession::advance(std::int64_t stamp_ns, double share) noexcept {
  const auto since_start_ns = static_cast<std::uint64_t>(std::llround(1e9 * time_s()));
  ++done_;
  const double next_m =
      path_.step({.scripted_m = script_.position_m(time_s()), .requested_m = bridge_->take_request()});
  const simulation::Teleoperator::Record record = teleoperator_.step(path_m_, next_m, share);
  path_m_ = next_m;
  const bool healthy = teleoperator_.healthy();
  bridge_->publish(
      ros2::snapshot_of(record, stamp_ns, healthy ? ros2::OperatingState::enabled : ros2::OperatingState::fault));
  if (streams_.teleoperator != nullptr) streams_.teleoperator->push(since_start_ns, record);
  contacts_ += record.touched ? 1 : 0;
  peak_force_N_ = std::max(peak_force_N_, record.peak_contact_force_N);
  // Written so that a NaN counts as outside.
  const bool inside =
      std::fabs(record.master_position_m) < workspace_m && std::fabs(record.tip_position_m) < slave_workspace_m_;
  diverged_ = diverged_ || !inside || !healthy;
}

}  // namespace tactus::real_time
