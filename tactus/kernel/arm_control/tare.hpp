// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <cstdint>

namespace tactus::arm_control {

using arm::ArmCommand;
using arm::ArmReading;
using arm::JointVector;

/// Finds the torque that a model of gravity lacks, of an arm that nobody holds and that touches nothing: for an unknown
/// payload, masses that are wrong, or a motor that gives more or less torque than its drive assumes.
///
/// The drives hold the arm about where it was at first, by their own law and under gravity compensation, and move each
/// joint to and fro by a sine. Over whole cycles, after one that comes in slowly, the mean of
///
///     torque that the drives report − gravity(q)
///
/// is what the model lacks: inertia, viscous and Coulomb friction are as large one way as the other. An arm that only
/// rests would hide up to its Coulomb friction. So the sine must overcome friction and play: stiffness·amplitude well
/// above Coulomb's torque, and an amplitude above the play. The answer is for this pose; it is in the drives' own
/// torque, as compensation and observers count.
class Tare {
 public:
  struct Params {
    std::int64_t cycles = 0;
    double amplitude_rad = 0.02;
    double frequency_Hz = 1.0;
    double most_share = 0.3;
    static constexpr auto fields() {
      return List{field("cycles", &Params::cycles, between(0, 20),
                        "Cycles of motion that are averaged, after one in which the motion ramps in. 0: no tare with "
                        "simulated taps; on a rig two cycles are averaged."),
                  field("amplitude_rad", &Params::amplitude_rad, arm::units::radian, positive_up_to(0.1),
                        "Amplitude of the motion of each joint; in m for a sliding joint."),
                  field("frequency_Hz", &Params::frequency_Hz, tactus::units::hertz, between(0.1, 5.0),
                        "Frequency of this motion."),
                  field("most_share", &Params::most_share, tactus::units::none, positive_up_to(1.0),
                        "Largest error of a joint's gravity compensation, as a share of the joint's effort limit; a "
                        "larger one is refused.")};
    }
  };
  /// Of the drives while it lasts.
  struct Drives {
    JointVector stiffness_N_m_per_rad;
    JointVector damping_N_m_s_per_rad;
  };

  /// Errors: a number out of bounds.
  static Result<Tare> make(const Params& params, const arm::Chain& model, const Drives& drives, Seconds dt);

  /// One tick. Real-time safe.
  ArmCommand step(const ArmReading& reading) noexcept;
  [[nodiscard]] bool done() const noexcept { return tick_ >= last_; }
  /// In N m, once it is done; positive where the motors must give more than the model has them give.
  [[nodiscard]] JointVector lacking_N_m() const noexcept { return sum_ / static_cast<double>(last_ - first_); }
  /// How far each joint went to either side in the cycles that are averaged, over `amplitude_rad`. Without play and
  /// friction, and with stiff drives, 1.
  [[nodiscard]] JointVector travel() const noexcept { return (highest_ - lowest_) / (2.0 * amplitude_rad_); }
  /// Of the latest tick, how far the drives pull each joint from where it was, in rad.
  [[nodiscard]] double away_rad() const noexcept { return away_rad_; }
  /// Ticks of one cycle.
  [[nodiscard]] std::int64_t cycle_ticks() const noexcept { return first_; }
  /// As made: the next step is its first.
  void restart() noexcept;
  /// Before its first step.
  [[nodiscard]] bool starts() const noexcept { return tick_ == 0; }
  /// Instead of the drives as made.
  void use(const Drives& drives) noexcept { drives_ = drives; }

 private:
  Tare(const Params& params, const arm::Chain& model, const Drives& drives, Seconds dt);

  arm::Chain model_;
  Drives drives_;
  double amplitude_rad_;
  double turn_rad_;  ///< of the sine, in a tick
  std::int64_t first_;
  std::int64_t last_;
  std::int64_t tick_ = 0;
  double away_rad_ = 0.0;
  JointVector start_;
  JointVector sum_;
  JointVector lowest_, highest_;  ///< in the cycles that are averaged
};

}  // namespace tactus::arm_control
