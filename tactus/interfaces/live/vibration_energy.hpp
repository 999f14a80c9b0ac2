// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

namespace tactus::live {

/// Energy that the master's motor has given to the handle by vibration: E = −∫ F_h dx_h in J, where F_h is the
/// displayed force in N, positive where it pushes the hand back, and x_h the position at the motor in m; both above 15
/// Hz, as the verdict has it. A motor that shakes the handle gives energy; one that damps it takes energy.
///
/// Not the whole ∫ F dx: pressing slowly into a wall stores a few mJ and moving out gives them back, which hides what a
/// ringing loop generates. Not the force of the hand: it acts at the handle, and the linkage moves in between.
class VibrationEnergy {
 public:
  static Result<VibrationEnergy> make(Seconds dt);

  /// One tick: the position that was measured in it, and the force that is displayed from then on. Real-time safe.
  void step(double displayed_force_N, double position_m) noexcept;
  /// Counts from zero again; the vibration continues.
  void begin() noexcept { energy_J_ = 0.0; }
  /// As new, at rest in a position.
  void reset(double position_m) noexcept;

  [[nodiscard]] double energy_J() const noexcept { return energy_J_; }

 private:
  explicit VibrationEnergy(const signal::SecondOrderFilter& high_pass) : force_(high_pass), position_(high_pass) {}

  signal::SecondOrderFilter force_;
  signal::SecondOrderFilter position_;
  double force_N_ = 0.0;
  double position_m_ = 0.0;
  double energy_J_ = 0.0;
};

}  // namespace tactus::live
