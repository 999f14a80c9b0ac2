// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>

namespace tactus::mechanics {

/// `value` brought `limit` closer to zero, and to zero if it is nearer than that: value − clamp(value, ±limit).
///
/// The closest point to `value` after friction has done all it can. For `limit >= 0`. A template on the scalar: a block
/// of lanes brings its own `min` and `max`.
template <class Scalar>
constexpr Scalar soft_threshold(Scalar value, Scalar limit) noexcept {
  using std::max;
  using std::min;
  return value - min(max(value, -limit), limit);
}

/// Coulomb friction with exact sticking, as a projection of the velocity (Moreau's time stepping).
///
/// With the velocity v* that the mass would reach in this step without friction, v = v* − clamp(v*, ±dt·f/m): what
/// remains of v* after the largest impulse that friction can give. It is the exact solution of the implicit step
/// m (v − v*) ∈ −dt·f·Sign(v), so a force below `force_N` holds a resting mass at exactly zero, and no step reverses a
/// velocity. The obvious forms are worse: −f·sign(v) chatters about zero, tanh(v/ε) creeps and is stiff, and sign with
/// a special case for sticking is a branch that mispredicts just when it matters.
/// Stable for every step and mass. For masses that are coupled within a step use `soft_threshold` in the sweeps of the
/// plant. No state.
/// Source: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, CISM 302, 1988.
class CoulombFriction {
 public:
  struct Params {
    double force_N = 0.01;
    static constexpr auto fields() {
      return List{field("force_N", &Params::force_N, units::newton, non_negative,
                        "Coulomb friction, static and kinetic (the master's motor: 0.01, paper A, Table I).")};
    }
  };
  struct Input {
    /// Velocity at the end of the step if there were no friction.
    double free_velocity_m_per_s = 0.0;
    /// Mass that friction acts on, greater than zero.
    double mass_kg = 1.0;
  };
  using Output = double;

  static Result<CoulombFriction> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return CoulombFriction(params.force_N * dt.value);
  }

  /// Velocity in m/s at the end of the step, friction included. Real-time safe.
  double step(const Input& input) noexcept {
    return soft_threshold(input.free_velocity_m_per_s, impulse_N_s_ / input.mass_kg);
  }

  void reset() noexcept {}

 private:
  explicit CoulombFriction(double impulse_N_s) : impulse_N_s_(impulse_N_s) {}
  double impulse_N_s_;
};

}  // namespace tactus::mechanics
