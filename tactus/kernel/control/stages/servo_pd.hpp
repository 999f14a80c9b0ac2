// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

namespace tactus::control {

/// Proportional and derivative feedback of a position error: F = k_p e + k_d ė, the rate low-passed.
class ServoPd {
 public:
  struct Params {
    double proportional_N_per_m = 100.0;
    double derivative_N_s_per_m = 0.65;
    signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
    static constexpr auto fields() {
      return List{field("proportional_N_per_m", &Params::proportional_N_per_m, units::newton_per_metre,
                        between(0.0, 1e5), "Force per position error."),
                  field("derivative_N_s_per_m", &Params::derivative_N_s_per_m, units::newton_second_per_metre,
                        between(0.0, 1e3), "Force per rate of the position error."),
                  field("velocity", &Params::velocity, "Filter of the rate of the position error.")};
    }
  };
  /// Wanted less measured position, in m.
  using Input = double;
  using Output = double;

  static constexpr int linear_states = 1;
  static constexpr std::optional<Unfit> not_on_lanes(const Params&) { return {}; }

  static Result<ServoPd> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const auto rate = signal::FilteredDerivative::make(params.velocity, dt);
    if (!rate) return under("velocity", rate.error());
    return ServoPd(params, *rate);
  }

  /// Force in N that takes the error away. Real-time safe.
  double step(double error_m) noexcept {
    return proportional_N_per_m_ * error_m + derivative_N_s_per_m_ * rate_.step(error_m);
  }
  void reset() noexcept { rate_.reset(); }

  [[nodiscard]] const signal::FilteredDerivative& rate() const noexcept { return rate_; }

 private:
  ServoPd(const Params& params, const signal::FilteredDerivative& rate)
      : proportional_N_per_m_(params.proportional_N_per_m),
        derivative_N_s_per_m_(params.derivative_N_s_per_m),
        rate_(rate) {}

  double proportional_N_per_m_;
  double derivative_N_s_per_m_;
  signal::FilteredDerivative rate_;
};

}  // namespace tactus::control
