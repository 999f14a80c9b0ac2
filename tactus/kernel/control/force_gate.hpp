// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tactus::control {

/// What made a gate close. A fault is latched; a limit that merely clips is not a fault.
enum class GateFault {
  none,
  not_finite,
  encoder_jump,
  encoder_frozen,
  workspace,
  velocity,
  energy,
  reversed,
  contradicted
};
constexpr auto enumerators(GateFault) {
  return std::array{Enumerator{GateFault::none, "none"},
                    Enumerator{GateFault::not_finite, "not-finite"},
                    Enumerator{GateFault::encoder_jump, "encoder-jump"},
                    Enumerator{GateFault::encoder_frozen, "encoder-frozen"},
                    Enumerator{GateFault::workspace, "workspace"},
                    Enumerator{GateFault::velocity, "velocity"},
                    Enumerator{GateFault::energy, "energy"},
                    Enumerator{GateFault::reversed, "reversed"},
                    Enumerator{GateFault::contradicted, "encoder-contradicted"}};
}

/// What changes the command right now: a different thing from a fault. Where several do, the first of energy,
/// workspace, velocity, thermal, force, rate.
enum class ActiveLimit { none, energy, workspace, velocity, force, rate, thermal };
constexpr auto enumerators(ActiveLimit) {
  return std::array{Enumerator{ActiveLimit::none, "none"},           Enumerator{ActiveLimit::energy, "energy"},
                    Enumerator{ActiveLimit::workspace, "workspace"}, Enumerator{ActiveLimit::velocity, "velocity"},
                    Enumerator{ActiveLimit::force, "force"},         Enumerator{ActiveLimit::rate, "rate"},
                    Enumerator{ActiveLimit::thermal, "thermal"}};
}

/// The longest time that a force may take to fall to zero once it must.
inline constexpr double longest_stop_s = 0.25;
inline constexpr const char* stop_time_doc =
    "Longest time for the force to fall to zero when the site stops. It applies if the rate limit would take longer.";

/// The very last stage before an actuator: a finite force, within its limit, that changes no faster than its rate
/// limit.
///
/// A stop has a limit of its own. While the site stops, or after a fault, a force may fall toward zero as fast as
/// `force_limit_N` over `stop_time_s` where the rate limit is slower: a low rate limit, which makes a force grow
/// gently, must not keep it pressing. So a force is zero at the latest `stop_time_s` after the command is.
///
/// The order matters: a command that is not finite is caught before any limiter could turn it into a number, latches
/// the fault, and from then on the output falls to zero and stays there until `reset`. There is no parameter that
/// switches the gate off: all limits have an upper bound, so a configuration can only tighten it.
class ForceGate {
 public:
  struct Params {
    double force_limit_N = 10.0;
    double rate_limit_N_per_s = 1e5;
    double stop_time_s = longest_stop_s;
    static constexpr auto fields() {
      return List{
          field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                "Largest force in either direction that reaches the motor."),
          field("rate_limit_N_per_s", &Params::rate_limit_N_per_s, units::newton_per_second, positive_up_to(1e6),
                "Largest rate of change of the force that reaches the motor."),
          field("stop_time_s", &Params::stop_time_s, units::second, positive_up_to(longest_stop_s), stop_time_doc)};
    }
  };
  using Input = double;
  using Output = double;

  static Result<ForceGate> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return ForceGate(params.force_limit_N, params.rate_limit_N_per_s * dt.value,
                     params.force_limit_N / params.stop_time_s * dt.value);
  }

  /// The force in N that may reach the motor instead of `command_N`. Always finite. While the site `stops` the force
  /// falls by the time that passed, `elapsed_ticks`; missed ticks earn no other change. Real-time safe.
  double step(double command_N, bool stops = false, std::int64_t elapsed_ticks = 1) noexcept {
    if (!std::isfinite(command_N)) fault_ = GateFault::not_finite;
    const double wanted = fault_ == GateFault::none ? std::clamp(command_N, -force_limit_N_, force_limit_N_) : 0.0;
    double lowest = passed_N_ - largest_step_N_, highest = passed_N_ + largest_step_N_;
    if (stops || fault_ != GateFault::none) {
      // Where the rate limit is the faster one, a late tick earns nothing: it would be a step above that limit.
      const std::int64_t counted = largest_fall_N_ > largest_step_N_ ? std::max<std::int64_t>(elapsed_ticks, 1) : 1;
      const double fall_N = largest_fall_N_ * static_cast<double>(counted);
      if (passed_N_ > 0.0) lowest = std::min(lowest, std::max(passed_N_ - fall_N, 0.0));
      if (passed_N_ < 0.0) highest = std::max(highest, std::min(passed_N_ + fall_N, 0.0));
    }
    const double allowed = std::clamp(wanted, lowest, highest);
    limit_ = ActiveLimit::none;
    if (fault_ == GateFault::none) {
      if (allowed != wanted) limit_ = ActiveLimit::rate;
      if (wanted != command_N) limit_ = ActiveLimit::force;
    }
    return passed_N_ = allowed;
  }

  /// No fault and no force, as made.
  void reset() noexcept {
    passed_N_ = 0.0;
    rearm();
  }
  /// No fault any more; the force continues from where it is, so re-arming makes no step above the rate limit.
  void rearm() noexcept {
    fault_ = GateFault::none;
    limit_ = ActiveLimit::none;
  }

  [[nodiscard]] GateFault fault() const noexcept { return fault_; }
  [[nodiscard]] ActiveLimit limit() const noexcept { return limit_; }
  /// What passed last.
  [[nodiscard]] double passed_N() const noexcept { return passed_N_; }

 private:
  ForceGate(double force_limit_N, double largest_step_N, double largest_fall_N)
      : force_limit_N_(force_limit_N), largest_step_N_(largest_step_N), largest_fall_N_(largest_fall_N) {}

  double force_limit_N_;
  double largest_step_N_;
  double largest_fall_N_;  ///< toward zero in a tick, while it stops
  double passed_N_ = 0.0;
  GateFault fault_ = GateFault::none;
  ActiveLimit limit_ = ActiveLimit::none;
};

}  // namespace tactus::control
