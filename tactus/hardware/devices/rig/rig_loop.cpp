// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig_loop.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::devices {

using control::SiteState;
using station::DeviceReading;

Result<RigLoop> RigLoop::make(const Joints<control::ControlParams>& control, const station::LinkParams& channel,
                              Seconds tick, const Params& params, runtime::SiteExchange& exchange,
                              MotorBusDevice& leader, MotorBusDevice& follower) {
  auto pair = station::JointLocalTeleoperator::make(control, channel, tick, Joints<double>(control.size(), 0.0), leader,
                                                    follower);
  if (!pair) return pair.error();
  Joints<double> scales(control.size());
  for (std::size_t joint = 0; joint < scales.size(); ++joint) scales[joint] = control[joint].position_scale;
  return RigLoop(tick, params, exchange, leader, follower, scales, *std::move(pair));
}

Result<RigLoop> RigLoop::around(station::JointSupervisedPair sites, Seconds tick, const Params& params,
                                runtime::SiteExchange& exchange, MotorBusDevice& leader, MotorBusDevice& follower,
                                const std::optional<Watches>& watches) {
  std::unique_ptr<station::WatchedArm> watched_leader, watched_follower;
  if (watches) {
    watched_leader = std::make_unique<station::WatchedArm>(leader, watches->leader);
    watched_follower = std::make_unique<station::WatchedArm>(follower, watches->follower);
  }
  const auto driven = [](auto& watched, MotorBusDevice& device) -> station::JointDevice& {
    return watched ? static_cast<station::JointDevice&>(*watched) : device;
  };
  auto pair = station::JointLocalTeleoperator::around(std::move(sites), driven(watched_leader, leader),
                                                      driven(watched_follower, follower));
  if (!pair) return pair.error();
  const Joints<double> scales(leader.limits().size(), 1.0);
  RigLoop loop(tick, params, exchange, leader, follower, scales, *std::move(pair));
  loop.watched_leader_ = std::move(watched_leader);
  loop.watched_follower_ = std::move(watched_follower);
  return loop;
}

RigLoop::RigLoop(Seconds tick, const Params& params, runtime::SiteExchange& exchange, MotorBusDevice& leader,
                 MotorBusDevice& follower, const Joints<double>& scales, station::JointLocalTeleoperator pair)
    : console_({.duration_s = params.duration_s,
                .arm_at_once = params.arm_at_once,
                .listen_before_arming_s = params.listen_before_arming_s,
                .tick_s = tick.value},
               exchange),
      params_(params),
      leader_(&leader),
      follower_(&follower),
      scales_(scales),
      pair_(std::move(pair)),
      leader_read_(scales_.size()),
      follower_read_(scales_.size()) {}

/// The joint that is farthest from its leader, as both stand.
void RigLoop::judge_distance() noexcept {
  second_.farthest = 0.0;
  for (std::size_t joint = 0; joint < scales_.size(); ++joint) {
    const double apart = std::fabs(follower_read_[joint].position_m - scales_[joint] * leader_read_[joint].position_m);
    if (apart <= second_.farthest) continue;
    second_.farthest = apart;
    second_.joint = joint;
  }
  second_.too_far = !active_ && (!seen_ || !(second_.farthest <= params_.farthest));
}

/// Whether the operator arms now. Before the first readings nobody knows how far apart the arms are, so an arming waits
/// for them, unless the operator stops or they take too long.
bool RigLoop::arms(const control::SiteRequests& pressed) noexcept {
  constexpr double longest_wait_s = 1.0;
  if (pressed.arm) arm_until_s_ = console_.time_s() + longest_wait_s;
  const bool wanted = console_.time_s() < arm_until_s_ && !pressed.emergency_stop && !pressed.leave;
  if (wanted && !read_once_) return false;
  arm_until_s_ = 0.0;
  return wanted;
}

/// They align when somebody arms and not before, so that a leader that was moved meanwhile is followed from where it
/// is.
control::SiteRequests RigLoop::asked(const control::SiteRequests& pressed) noexcept {
  control::SiteRequests request = pressed;
  request.arm = arms(pressed) && !second_.too_far;
  const bool unaligned = second_.leader == SiteState::configure || second_.follower == SiteState::configure;
  request.align = false;
  // Neither gets power where the other can't carry itself.
  if (pair_.sites().master().support().too_heavy() || pair_.sites().slave().support().too_heavy()) {
    refused_ = refused_ || request.arm;
    request.arm = request.clear = arming_ = false;
    return request;
  }
  refused_ = false;
  if (unaligned) {
    arming_ = arming_ || request.arm;
    request.align = arming_;
    request.arm = false;
  } else if (arming_) {
    arming_ = second_.leader != SiteState::align || second_.follower != SiteState::align;
    request.arm = !arming_;
  }
  return request;
}

bool RigLoop::operator()(const station::Tick& tick) noexcept {
  if (console_.insisted()) {
    pair_.release();
    return false;
  }
  const control::SiteRequests by_person =
      console_.step(tick, second_.leader, pair_.sites().master().heard().session != 0);
  if (console_.leaving() && !at_end_) at_end_ = second_;
  judge_distance();
  const control::SiteRequests pressed = asked(by_person);
  const auto done = pair_.step(tick, pressed);
  const auto trusted = [](const Joints<DeviceReading>& reading) {
    return std::all_of(reading.begin(), reading.end(),
                       [](const DeviceReading& joint) { return std::isfinite(joint.position_m); });
  };
  seen_ = trusted(done.master.reading) && trusted(done.slave.reading);
  if (seen_) {
    read_once_ = true;
    leader_read_ = done.master.reading;
    follower_read_ = done.slave.reading;
  }
  const auto state = static_cast<SiteState>(done.slave.output.record.state);
  const bool active = state == SiteState::active;
  active_ = active;
  if (streams_ != nullptr) {
    streams_->push(tick, pressed, pair_, done);
    streams_->push(tick, console_.mark(), console_.taken());
  }
  keep_books(done);
  look_at_tares(tick);
  bool works = false, gives_force = false;
  for (const std::int64_t each : {done.master.output.record.state, done.slave.output.record.state}) {
    const auto of_site = static_cast<SiteState>(each);
    works = works || (of_site != SiteState::configure && of_site != SiteState::fault);
  }
  gives_force = !pair_.at_rest();
  return !console_.over(tick, works, gives_force);
}

/// The worst of the second, of each side.
void RigLoop::note_troubles() noexcept {
  second_.leader_health = watched_leader_ ? watched_leader_->health() : leader_->health();
  second_.follower_health = watched_follower_ ? watched_follower_->health() : follower_->health();
  if (watched_leader_) note_motor(second_, watched_leader_->found(), true);
  if (watched_follower_) note_motor(second_, watched_follower_->found(), false);
  note(second_.leader_trouble, leader_->trouble());
  note(second_.follower_trouble, follower_->trouble());
  count(totals_, std::max(second_.leader_health, second_.follower_health));
}

/// The first fault that a gate has latched.
void RigLoop::note_fault() noexcept {
  second_.fault = control::GateFault::none;
  const auto look = [this](const auto& gates, bool of_leader) {
    for (std::size_t joint = 0; joint < gates.size() && second_.fault == control::GateFault::none; ++joint) {
      second_.fault = gates[joint].motor().fault();
      second_.fault_joint = joint;
      second_.fault_evidence = gates[joint].motor().evidence();
      second_.fault_of_leader = of_leader;
    }
  };
  look(pair_.sites().master().site().gates(), true);
  look(pair_.sites().slave().site().gates(), false);
}

/// What a tare found goes into the log once.
void RigLoop::look_at_tares(const station::Tick& tick) noexcept {
  const auto look = [&](RigSecond::Tare& tare, const auto& site, control::SiteRole role) noexcept {
    if (note_tare(tare, site) && streams_ != nullptr) streams_->push(tick, role, tare.found_Nm);
  };
  look(second_.leader_tare, pair_.sites().master(), control::SiteRole::master);
  look(second_.follower_tare, pair_.sites().slave(), control::SiteRole::slave);
}

void RigLoop::keep_books(const station::JointLocalTeleoperator::Output& done) noexcept {
  const auto leader = static_cast<SiteState>(done.master.output.record.state);
  const auto follower = static_cast<SiteState>(done.slave.output.record.state);
  const auto cause = [](std::int64_t number) { return static_cast<control::SiteCause>(number); };
  count(totals_, second_.leader, leader);
  second_.leader = leader;
  second_.follower = follower;
  second_.force_gain = done.master.output.record.force_gain;
  // The one that only went with the other knows no cause.
  const bool of_follower = stands(follower) && cause(done.slave.output.record.cause) != control::SiteCause::peer;
  second_.cause = cause(of_follower ? done.slave.output.record.cause : done.master.output.record.cause);
  note_troubles();
  note_fault();
  second_.support = {};
  second_.probe = {};
  note_support(second_, pair_.sites().master(), true);
  note_support(second_, pair_.sites().slave(), false);
  note_probe(second_, pair_.sites().slave(), false);
  note_probe(second_, pair_.sites().master(), true);
  if (refused_) second_.cause = control::SiteCause::weight;
  for (std::size_t joint = 0; joint < scales_.size(); ++joint) {
    second_.most_torque = std::max({second_.most_torque, std::fabs(done.master.output.site[joint].motor_force_N),
                                    std::fabs(done.slave.output.site[joint].motor_force_N)});
  }
  ++totals_.ticks;
  if (active_) ++totals_.active_ticks;
  totals_.duration_s = second_.time_s = console_.time_s();
  if (!console_.ends_second()) return;
  shared_->try_push(second_);
  begin_anew(second_, stands(leader) || stands(follower));
}

}  // namespace tactus::devices
