// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <optional>

namespace tactus::control {

/// Derivative feedback at the master: a force −B v against the motion of its own motor, v the low-passed derivative of
/// the measured position (Kuchenbecker and Niemeyer, "Induced Master Motion in Force-Reflecting Teleoperation", eq. 4).
///
///     x_m = x_int + G_ind(G_se(x_m) + B s x_m)
///
/// It makes G_ind smaller for everything that moves the motor, the operator included, who feels B v in free motion too.
/// The filter is needed because an encoder that counts Δ per tick reads as Δ/dt, and it bounds B: with its lag and the
/// tick's, strong damping of a light motor oscillates by itself. Nothing here refuses that; the safety gate bounds it.
///
/// The first sample after `make` or `reset` gives no force. With B = 0 there is no filter and the force is exactly 0.
class LocalDamping {
 public:
  struct Params {
    double damping_N_s_per_m = 0.0;
    signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
    static constexpr auto fields() {
      return List{field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre,
                        between(0.0, 1e3), "Force against the motor per velocity of the motor; 0 is off."),
                  field("velocity", &Params::velocity, "Filter of the motor's velocity.")};
    }
  };
  /// Measured position of the motor, in m.
  using Input = double;
  /// Force on the motor, in N, of the other sign than its velocity.
  using Output = double;

  static constexpr int linear_states = 1;
  static constexpr std::optional<Unfit> not_on_lanes(const Params& params) {
    if (params.damping_N_s_per_m == 0.0) return {};
    return Unfit{"damping_N_s_per_m", "write 0"};
  }

  static Result<LocalDamping> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    LocalDamping damping;
    if (params.damping_N_s_per_m == 0.0) return damping;
    const auto velocity = signal::FilteredDerivative::make(params.velocity, dt);
    if (!velocity) return under("velocity", velocity.error());
    damping.damping_N_s_per_m_ = params.damping_N_s_per_m;
    damping.velocity_ = *velocity;
    return damping;
  }

  /// The force for this tick. Real-time safe.
  double step(double position_m) noexcept {
    return velocity_ ? -damping_N_s_per_m_ * velocity_->step(position_m) : 0.0;
  }

  void reset() noexcept {
    if (velocity_) velocity_->reset();
  }

 private:
  LocalDamping() = default;
  double damping_N_s_per_m_ = 0.0;
  std::optional<signal::FilteredDerivative> velocity_;
};

}  // namespace tactus::control
