#pragma once

#include <tactus/core/element.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>
#include <array>

namespace tactus::control {

/// What made the gate close. A fault is latched; a limit that merely clips is not a fault.
enum class GateFault { none, not_finite };
constexpr auto enumerators(GateFault) {
  return std::array{Enumerator{GateFault::none, "none"}, Enumerator{GateFault::not_finite, "not-finite"}};
}

/// The last thing before a motor: a finite force, within its limit, that changes no faster than its rate limit.
///
/// The order matters: a command that is not finite is caught before any limiter could turn it into a number, latches
/// the fault, and from then on the output falls to zero at the rate limit and stays there until `reset`. There is no
/// parameter that switches the gate off: both limits have an upper bound, so a configuration can only tighten it.
class SafetyGate {
 public:
  struct Params {
    double force_limit_N = 10.0;
    double rate_limit_N_per_s = 1e5;
    static constexpr auto fields() {
      return std::tuple{field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                              "Largest force either way that reaches the motor."),
                        field("rate_limit_N_per_s", &Params::rate_limit_N_per_s, units::newton_per_second,
                              positive_up_to(1e6), "Fastest change of the force that reaches the motor.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<SafetyGate> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    return SafetyGate(params.force_limit_N, params.rate_limit_N_per_s * dt.value);
  }

  /// The force in N that may reach the motor instead of `command_N`. Always finite. Real-time safe.
  double step(double command_N) noexcept {
    const bool finite = command_N - command_N == 0.0;
    if (!finite) fault_ = GateFault::not_finite;
    const double wanted = fault_ == GateFault::none ? std::clamp(command_N, -force_limit_N_, force_limit_N_) : 0.0;
    passed_N_ = std::clamp(wanted, passed_N_ - largest_step_N_, passed_N_ + largest_step_N_);
    return passed_N_;
  }

  /// Re-arms: no fault, no force.
  void reset() noexcept {
    passed_N_ = 0.0;
    fault_ = GateFault::none;
  }

  [[nodiscard]] GateFault fault() const noexcept { return fault_; }

 private:
  SafetyGate(double force_limit_N, double largest_step_N)
      : force_limit_N_(force_limit_N), largest_step_N_(largest_step_N) {}

  double force_limit_N_;
  double largest_step_N_;
  double passed_N_ = 0.0;
  GateFault fault_ = GateFault::none;
};

}  // namespace tactus::control
