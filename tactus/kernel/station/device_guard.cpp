// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/force_gate.hpp>
#include <tactus/kernel/station/device_guard.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace tactus::station {

namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();
/// For the last bit of a command that changes exactly as fast as it may, or with its law is exactly as strong.
constexpr double rounding = 1.0 + 1e-9;

double limit_or_none(double limit) noexcept { return limit > 0.0 ? limit : no_limit; }

double held_to(double value, double largest) noexcept {
  return std::fabs(value) <= largest ? value : std::copysign(largest, value);
}

}  // namespace

const char* in_words(ReleaseCause cause) {
  switch (cause) {
    case ReleaseCause::none:
      return "nothing was wrong";
    case ReleaseCause::timed_out:
      return "commands stopped coming";
    case ReleaseCause::not_finite:
      return "a command or a reading was not a number";
    case ReleaseCause::force:
      return "commands insisted on more force than the device may give";
    case ReleaseCause::rate:
      return "commands insisted on changing the force faster than the device may";
    case ReleaseCause::velocity:
      return "the device was faster than it may be";
    case ReleaseCause::position:
      return "the device left its workspace";
  }
  return "of what this version does not know";
}

DeviceGuard::DeviceGuard(const DeviceLimits& limits, Seconds timeout) noexcept
    : limits_{.force_N = limit_or_none(limits.force_N),
              .handle_force_N = limit_or_none(limits.handle_force_N),
              .rate_N_per_s = limit_or_none(limits.rate_N_per_s),
              .velocity_m_per_s = limit_or_none(limits.velocity_m_per_s),
              .position_m = limit_or_none(limits.position_m),
              .stiffness_N_per_m = limits.stiffness_N_per_m,
              .damping_N_s_per_m = limits.damping_N_s_per_m},
      timeout_ns_(std::llround(1e9 * timeout.value)) {}

void DeviceGuard::release(ReleaseCause cause) noexcept {
  if (cause_ == ReleaseCause::none) cause_ = cause;
}

void DeviceGuard::rearm() noexcept {
  cause_ = ReleaseCause::none;
  insisting_ns_ = 0;
  marked_ = false;
}

void DeviceGuard::observe(double position_m, const Tick& tick, double age_s, double velocity_m_per_s) noexcept {
  if (!std::isfinite(position_m) || !std::isfinite(age_s) || !std::isfinite(velocity_m_per_s)) {
    return release(ReleaseCause::not_finite);
  }
  position_m_ = position_m;
  velocity_m_per_s_ = velocity_m_per_s;
  const std::int64_t now_ns = tick.deadline_ns - std::llround(1e9 * age_s);
  if (std::fabs(position_m) > limits_.position_m) release(ReleaseCause::position);
  if (marked_) {
    const double window_s = 1e-9 * static_cast<double>(std::max(now_ns - mark_ns_, speed_window_ns));
    if (std::fabs(position_m - mark_m_) > limits_.velocity_m_per_s * window_s) release(ReleaseCause::velocity);
    if (now_ns - mark_ns_ < speed_window_ns) return;
  }
  marked_ = true;
  mark_m_ = position_m;
  mark_ns_ = now_ns;
}

control::DriveLaw DeviceGuard::allowed(const control::DriveLaw& wanted) const noexcept {
  control::DriveLaw law = wanted;
  law.stiffness_N_per_m = std::clamp(wanted.stiffness_N_per_m, 0.0, limits_.stiffness_N_per_m);
  law.damping_N_s_per_m = std::clamp(wanted.damping_N_s_per_m, 0.0, limits_.damping_N_s_per_m);
  return law;
}

DeviceCommand DeviceGuard::pass(const DeviceCommand& wanted, const Tick& tick) noexcept {
  const control::DriveLaw law = allowed(wanted.law);
  const bool runs_law = law.stiffness_N_per_m > 0.0 || law.damping_N_s_per_m > 0.0;
  const double whole_N = runs_law ? wanted.force_N + law.stiffness_N_per_m * (law.position_m - position_m_) +
                                        law.damping_N_s_per_m * (law.velocity_m_per_s - velocity_m_per_s_)
                                  : wanted.force_N;
  const bool gains = std::isfinite(wanted.law.stiffness_N_per_m) && std::isfinite(wanted.law.damping_N_s_per_m);
  if (!std::isfinite(whole_N) || !std::isfinite(wanted.handle_force_N) || !gains) release(ReleaseCause::not_finite);
  const std::int64_t since_ns = passed_any_ ? std::max<std::int64_t>(0, tick.deadline_ns - passed_ns_) : 0;
  const std::int64_t period_ns = since_ns / (1 + std::max<std::int64_t>(0, tick.missed));
  passed_any_ = true;
  passed_ns_ = tick.deadline_ns;
  const double step_N =
      limits_.rate_N_per_s == no_limit ? no_limit : limits_.rate_N_per_s * 1e-9 * static_cast<double>(period_ns);
  // A force that falls toward zero may take the faster of the two ways, and all of the time that passed counts for it.
  const auto toward = [step_N, since_ns](double from_N, double to_N, double limit_N) {
    const double largest_N = limit_N == no_limit ? std::fabs(from_N) : limit_N;
    const double fall_N = largest_N / control::longest_stop_s * 1e-9 * static_cast<double>(since_ns);
    const bool falls = std::fabs(to_N) < std::fabs(from_N) || to_N * from_N < 0.0;
    const double most_N = falls ? std::max(step_N, std::min(fall_N, std::fabs(from_N))) : step_N;
    return std::fabs(to_N - from_N) <= rounding * most_N ? to_N : from_N + std::copysign(most_N, to_N - from_N);
  };

  if (cause_ == ReleaseCause::none && wanted.enabled) {
    const bool strongest = runs_law && std::fabs(whole_N) <= rounding * limits_.force_N;
    const DeviceCommand strong{.force_N = strongest ? whole_N : held_to(whole_N, limits_.force_N),
                               .handle_force_N = held_to(wanted.handle_force_N, limits_.handle_force_N)};
    const DeviceCommand now{
        .force_N = toward(passed_.force_N, strong.force_N, limits_.force_N),
        .handle_force_N = toward(passed_.handle_force_N, strong.handle_force_N, limits_.handle_force_N)};
    const bool too_strong = strong.force_N != whole_N || strong.handle_force_N != wanted.handle_force_N ||
                            law.stiffness_N_per_m != wanted.law.stiffness_N_per_m ||
                            law.damping_N_s_per_m != wanted.law.damping_N_s_per_m;
    const bool too_fast = now.force_N != strong.force_N || now.handle_force_N != strong.handle_force_N;
    if (too_strong || too_fast) ++held_back_;
    insisting_ns_ = too_strong || too_fast ? insisting_ns_ + period_ns : 0;
    if (insisting_ns_ > timeout_ns_) release(too_strong ? ReleaseCause::force : ReleaseCause::rate);
    passed_ = now;
    if (!runs_law) return now;
    // Of force and law the share that passes of both; where it is none, the force alone.
    const double share = now.force_N == whole_N ? 1.0 : now.force_N / whole_N;
    if (!(share >= 0.0 && share <= 1.0)) return now;
    DeviceCommand part = now;
    part.force_N = share * wanted.force_N;
    part.law = law;
    part.law.stiffness_N_per_m *= share;
    part.law.damping_N_s_per_m *= share;
    return part;
  }
  passed_.force_N = toward(passed_.force_N, 0.0, limits_.force_N);
  passed_.handle_force_N = toward(passed_.handle_force_N, 0.0, limits_.handle_force_N);
  passed_.enabled = passed_.force_N != 0.0 || passed_.handle_force_N != 0.0;
  return passed_;
}

namespace {

Check check_limits(const DeviceLimits& limits, bool simulated) {
  for (const auto& [name, value, unit, needed] :
       {std::tuple{"force_N", limits.force_N, units::newton, true},
        std::tuple{"handle_force_N", limits.handle_force_N, units::newton, false},
        std::tuple{"rate_N_per_s", limits.rate_N_per_s, units::newton_per_second, true},
        std::tuple{"velocity_m_per_s", limits.velocity_m_per_s, units::metre_per_second, true},
        std::tuple{"position_m", limits.position_m, units::metre, true},
        std::tuple{"stiffness_N_per_m", limits.stiffness_N_per_m, units::newton_per_metre, false},
        std::tuple{"damping_N_s_per_m", limits.damping_N_s_per_m, units::newton_second_per_metre, false},
        std::tuple{"velocity_step_m_per_s", limits.velocity_step_m_per_s, units::metre_per_second, false}}) {
    if (!std::isfinite(value) || value < 0.0) return out_of_bounds(name, value, non_negative, unit);
    if (value == 0.0 && needed && !simulated) {
      return Error{.code = ErrorCode::missing,
                   .parameter = name,
                   .message =
                       "a device that is not simulated must state this limit of its own: without it nothing "
                       "is between a wrong controller and the motor",
                   .place = {}};
    }
  }
  return std::nullopt;
}

}  // namespace

template <class Reading>
Check check_limits(const DeviceOf<Reading>& device) {
  const auto limits = device.limits();
  if (joints_of(limits) == 0 || joints_of(limits) > most_joints) {
    return out_of_bounds("joints", static_cast<double>(joints_of(limits)), between(1.0, most_joints), units::none);
  }
  for (std::size_t joint = 0; joint < joints_of(limits); ++joint) {
    if (auto error = check_limits(joint_of(limits, joint), device.simulated())) {
      return under_joint<Reading>(joint, *std::move(error));
    }
  }
  return std::nullopt;
}

template <class Reading>
Reading GuardedDeviceOf<Reading>::read(const Tick& tick) noexcept {
  const Reading reading = device_->read(tick);
  const bool silent = written_ns_ != now_.deadline_ns;
  now_ = tick;
  if (device_->health() != DeviceHealth::lost) {
    for_each_joint(
        [&tick](DeviceGuard& guard, const DeviceReading& joint) noexcept {
          guard.observe(joint.position_m, tick, joint.age_s, joint.motor_report.velocity_m_per_s);
        },
        guard_, reading);
  }
  if (written_ && silent) {
    if (tick.deadline_ns - written_ns_ > timeout_ns_) {
      for_each_joint([](DeviceGuard& guard) noexcept { guard.release(ReleaseCause::timed_out); }, guard_);
    }
    device_->write(pass());
  }
  return reading;
}

template <class Reading>
void GuardedDeviceOf<Reading>::write(const Command& command) noexcept {
  wanted_ = command;
  device_->write(pass());
  written_ = true;
  written_ns_ = now_.deadline_ns;
}

/// What may reach the actuators of what was wanted last. Where one joint lets go, so do the others.
template <class Reading>
typename GuardedDeviceOf<Reading>::Command GuardedDeviceOf<Reading>::pass() noexcept {
  if constexpr (has_joints<Reading>) {
    if (const ReleaseCause found = cause(); found != ReleaseCause::none) {
      for_each_joint([found](DeviceGuard& guard) noexcept { guard.release(found); }, guard_);
    }
  }
  Command passed = wanted_;
  for_each_joint([this](DeviceGuard& guard, DeviceCommand& joint) noexcept { joint = guard.pass(joint, now_); }, guard_,
                 passed);
  return passed;
}

template Check check_limits(const Device&);
template Check check_limits(const JointDevice&);
template class GuardedDeviceOf<DeviceReading>;
template class GuardedDeviceOf<Joints<DeviceReading>>;

}  // namespace tactus::station
