// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/ring.hpp>
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/kernel/arm_control/motor_watch.hpp>
#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/control/supervision.hpp>
#include <tactus/kernel/control/support_raise.hpp>
#include <tactus/runtime/servo/site_link.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace tactus::devices {

/// One second of a pair, for the display. States and causes are those of its end.
struct RigSecond {
  double time_s = 0.0;
  control::SiteState leader = control::SiteState::configure, follower = control::SiteState::configure;
  control::SiteCause cause =
      control::SiteCause::started;  ///< of the leader, or of the follower where that stopped by itself
  station::DeviceHealth leader_health = station::DeviceHealth::good, follower_health = station::DeviceHealth::good;
  DeviceTrouble leader_trouble, follower_trouble;       ///< the worst of the second, or of the present hold
  control::GateFault fault = control::GateFault::none;  ///< what a gate latched, of the leader first
  bool fault_of_leader = false;
  std::size_t fault_joint = 0;
  control::MotionCheck::Evidence fault_evidence;  ///< what a position and a reported velocity disagreed by
  control::SupportFinding support;                ///< while its support is what stops a side, of the leader first
  bool support_of_leader = false;
  control::ProbeFinding probe;  ///< while a motor that did not pass its sign probe is what stops a side
  bool probe_of_leader = false;
  arm_control::MotorWatch::Found motor;  ///< a motor that did not do as commanded, when a side is stopped
  bool motor_of_leader = false;
  double most_torque = 0.0;  ///< of any motor of the second, either way
  double farthest = 0.0;     ///< of a joint from its leader
  std::size_t joint = 0;     ///< which one
  bool too_far = false;      ///< so that nobody can arm
  double force_gain = 0.0;   ///< of the leader, at its end; 0 without a gain that can change
  /// Of a side's latest tare; what it found is added to the gravity compensation of each joint, in N m.
  struct Tare {
    control::TareReport report;
    Joints<double> found_Nm;
  };
  Tare leader_tare, follower_tare;
  runtime::LinkSecond link;  ///< where the other side is elsewhere
};

/// What a pair went through.
struct RigTotals {
  double duration_s = 0.0;
  std::int64_t ticks = 0, active_ticks = 0, armings = 0, holds = 0;
  std::int64_t late_ticks = 0, not_responding_ticks = 0, lost_ticks = 0;  ///< of the worse device
};

/// Seconds from the servo thread to one other.
using RigSeconds = telemetry::Ring<RigSecond, 64>;
inline std::optional<RigSecond> next_of(RigSeconds& seconds) noexcept {
  RigSecond second;
  if (!seconds.try_pop(second)) return std::nullopt;
  return second;
}

/// The worse of what kept a device from being good. Real-time safe, as what follows.
inline void note(DeviceTrouble& worst, const DeviceTrouble& now) noexcept {
  if (now.what > worst.what || (now.what == worst.what && now.age_s > worst.age_s)) worst = now;
}
/// A tick in which a device was so.
inline void count(RigTotals& totals, station::DeviceHealth health) noexcept {
  switch (health) {
    case station::DeviceHealth::good:
      return;
    case station::DeviceHealth::degraded:
      ++totals.late_ticks;
      return;
    case station::DeviceHealth::not_responding:
      ++totals.not_responding_ticks;
      return;
    case station::DeviceHealth::lost:
      ++totals.lost_ticks;
  }
}
/// A tick after which the leader is in `now`, where it was in `before`.
inline void count(RigTotals& totals, control::SiteState before, control::SiteState now) noexcept {
  using control::SiteState;
  if (now == SiteState::armed && before != SiteState::armed) ++totals.armings;
  if (now == SiteState::hold && before != SiteState::hold) ++totals.holds;
}
/// Notes what stops a side whose support is at fault.
template <class Site>
void note_support(RigSecond& second, const Site& site, bool of_leader) noexcept {
  const bool refused = site.cause() == control::SiteCause::weight || site.support().too_heavy();
  if (second.support.fault != control::SupportFault::none) return;
  if (!refused && site.cause() != control::SiteCause::support) return;
  second.support = site.support().found();
  second.support_of_leader = of_leader;
}
/// Notes the motor that did not pass its sign probe, while that stops its side.
template <class Site>
void note_probe(RigSecond& second, const Site& site, bool of_leader) noexcept {
  const control::ProbeFinding found = site.probe_finding();
  if (found.report.verdict == control::ProbeVerdict::none) return;
  second.probe = found;
  second.probe_of_leader = of_leader;
}
/// Notes how a side's tare goes; true at the tick at which its result has come in.
template <class Site>
bool note_tare(RigSecond::Tare& tare, const Site& site) noexcept {
  const control::TareState before = tare.report.state;
  tare.report = site.site().tare();
  if (tare.report.state == before || tare.report.state != control::TareState::done) return false;
  tare.found_Nm = site.site().tared_N();
  return true;
}
/// Notes a motor that does not do as it is commanded, the first one.
inline void note_motor(RigSecond& second, const arm_control::MotorWatch::Found& found, bool of_leader) noexcept {
  using arm_control::MotorFinding;
  if (found.what == MotorFinding::none || second.motor.what != MotorFinding::none) return;
  second.motor = found;
  second.motor_of_leader = of_leader;
}
/// Begins again what a second gathers. What stopped the sites is reported until they are armed again.
inline void begin_anew(RigSecond& second, bool stands) noexcept {
  second.most_torque = 0.0;
  if (!stands) {
    second.leader_trouble = second.follower_trouble = {};
    second.motor = {};
  }
}
inline bool stands(control::SiteState state) noexcept {
  return state == control::SiteState::hold || state == control::SiteState::fault;
}

}  // namespace tactus::devices
