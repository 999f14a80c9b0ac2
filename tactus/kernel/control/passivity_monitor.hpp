// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cstdint>

namespace tactus::control {

/// An account of the energy that a motor gives to whatever it moves. It knows the force that was really applied and the
/// measured position, and nothing of the controller.
///
///     E(k) = max(E(k−1) + F(k−1)·(x(k) − x(k−1)), −credit) − drain·T while positive
///
/// The force is held until the next one, so F·Δx is the work that was done, exactly up to the encoder's step, however
/// many ticks have passed. What the device
/// gave to the motor counts as credit, up to a bound: a wall gives back what it took, but a long press must not pay for
/// a long instability. A machine may keep giving a small power, for friction that it overcomes or for an environment
/// that moves by itself: that is the drain.
///
/// Above `damp_above_J` the monitor asks for damping, growing with the account; above `hold_above_J` it latches.
/// Source: B. Hannaford and J.-H. Ryu, Time-domain passivity control of haptic interfaces, IEEE Trans. Robotics and
/// Automation 18(1), 2002, whose observer this is, with a bounded credit and a drain.
class PassivityMonitor {
 public:
  struct Params {
    double damp_above_J = 20.0;
    double hold_above_J = 40.0;
    double credit_J = 0.1;
    double drain_W = 10.0;
    double damping_N_s_per_m = 3.0;
    static constexpr auto fields() {
      return List{
          field("damp_above_J", &Params::damp_above_J, units::joule, positive_up_to(100.0),
                "Delivered energy above which the gate adds damping."),
          field("hold_above_J", &Params::hold_above_J, units::joule, positive_up_to(200.0),
                "Delivered energy above which the motor acts as a damper only, until it is armed again. Must be "
                "greater than damp_above_J."),
          field("credit_J", &Params::credit_J, units::joule, between(0.0, 100.0),
                "Largest amount of absorbed energy that is credited against energy delivered later."),
          field("drain_W", &Params::drain_W, units::watt, between(0.0, 50.0),
                "Power that the motor may deliver continuously."),
          field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, positive_up_to(1000.0),
                "Damping at and above hold_above_J; from damp_above_J to there it increases from zero. Must be stable "
                "on the device at its servo rate.")};
    }
  };
  struct Input {
    double acted_N = 0.0;            ///< force since the reading before
    double position_m = 0.0;         ///< measured, in the direction of the force
    std::int64_t elapsed_ticks = 1;  ///< since the reading before
  };
  /// The damping in N s/m to add.
  using Output = double;

  /// Errors: `inconsistent` for a hold that comes before the damping.
  static Result<PassivityMonitor> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    if (params.hold_above_J <= params.damp_above_J) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "hold_above_J",
                   .message = rounded_number(params.hold_above_J) + " J must be more than damp_above_J, " +
                              rounded_number(params.damp_above_J) + " J: raise it or lower damp_above_J",
                   .place = {}};
    }
    return PassivityMonitor(params, dt);
  }

  /// Enters the work since the reading before. Real-time safe.
  double step(const Input& input) noexcept {
    if (started_) given_J_ = std::max(given_J_ + input.acted_N * (input.position_m - position_m_), -params_.credit_J);
    if (given_J_ > 0.0) given_J_ = std::max(given_J_ - drain_J_ * static_cast<double>(input.elapsed_ticks), 0.0);
    started_ = true;
    position_m_ = input.position_m;
    held_ = held_ || given_J_ > params_.hold_above_J;
    if (held_) return params_.damping_N_s_per_m;
    const double share = (given_J_ - params_.damp_above_J) / (params_.hold_above_J - params_.damp_above_J);
    return params_.damping_N_s_per_m * std::clamp(share, 0.0, 1.0);
  }

  /// An empty account, nothing latched.
  void reset() noexcept {
    given_J_ = 0.0;
    position_m_ = 0.0;
    started_ = held_ = false;
  }

  [[nodiscard]] bool held() const noexcept { return held_; }
  [[nodiscard]] double given_J() const noexcept { return given_J_; }

 private:
  PassivityMonitor(const Params& params, Seconds dt) : params_(params), drain_J_(params.drain_W * dt.value) {}

  Params params_;
  double drain_J_;  ///< in a tick
  double given_J_ = 0.0;
  double position_m_ = 0.0;
  bool started_ = false;
  bool held_ = false;
};

}  // namespace tactus::control
