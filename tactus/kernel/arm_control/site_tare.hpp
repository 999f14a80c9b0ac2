// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/tare.hpp>
#include <tactus/kernel/control/tare_report.hpp>

#include <cstdint>

namespace tactus::arm_control {

/// The tare of an arm under its site, on request, and what it found: torque in N m that is added to gravity
/// compensation. After the motion of `Tare` its result is judged, and comes in within one more cycle, in no step. What
/// is refused, or stopped on its way, leaves what acted before.
///
/// A joint that travelled less than half of the amplitude is blocked, or the tool touches something: its mean is
/// nobody's weight. A payload or a wrong mass does not lack more than `most_share` of a joint's effort limit. What it
/// cannot distinguish from weight: a force that is constant over the motion, as of a hand that leans on it, of a cable
/// that pulls, or of something soft that is touched; and an offset of the drive's own torque, which it corrects too.
class SiteTare {
 public:
  /// `acting` acts from the start. Errors: those of `Tare::make`. Without cycles in `params` it averages two.
  static Result<SiteTare> make(Tare::Params params, const arm::Chain::Params& arm, const arm::Chain& model,
                               const Tare::Drives& drives, const JointVector& acting, Seconds dt);

  void begin() noexcept;
  void stop() noexcept;

  [[nodiscard]] bool moves() const noexcept { return report_.state == control::TareState::under_way && !comes_in_; }
  /// While it moves the joints, and while that fades: then `step` or `away_rad` once a tick.
  [[nodiscard]] bool acts() const noexcept { return moves() || limit_share_ < 1.0; }
  /// Before the first step of one: what it uses instead of the drives as made.
  [[nodiscard]] bool starts() const noexcept { return moves() && tare_.starts(); }
  void use(const Tare::Drives& drives) noexcept { tare_.use(drives); }
  /// What moves the joints: positions to which their drives pull, by `drives`, about where they were. It comes and goes
  /// within a cycle each. Real-time safe.
  ArmCommand step(const ArmReading& reading) noexcept;
  /// The same for drives that pull already: how far each goes beyond its command, in rad.
  double away_rad(const ArmReading& reading) noexcept {
    step(reading);
    return firmness() * tare_.away_rad();
  }
  /// The share of limits at the tool that acts: 1, and 0 while it moves, for what is limited there is too soft to
  /// overcome friction at each joint. It changes within a cycle. Real-time safe.
  [[nodiscard]] double limit_share() const noexcept { return limit_share_; }
  /// The torque that acts at this tick. Once a tick, after `step`. Real-time safe.
  const JointVector& lacking_N_m() noexcept;

  [[nodiscard]] const control::TareReport& report() const noexcept { return report_; }
  /// What acts, or comes in.
  [[nodiscard]] const JointVector& found_N_m() const noexcept { return found_; }

 private:
  SiteTare(const Tare& tare, const JointVector& most_N_m, const JointVector& acting)
      : tare_(tare), most_N_m_(most_N_m), acting_(acting), found_(acting), step_(acting) {}
  void judge() noexcept;
  [[nodiscard]] double firmness() const noexcept { return 1.0 - limit_share_; }

  Tare tare_;
  JointVector most_N_m_;
  JointVector acting_;
  JointVector found_;
  JointVector step_;  ///< of what acts, in a tick in which the result comes in
  double limit_share_ = 1.0;
  std::int64_t ticks_left_ = 0;
  bool comes_in_ = false;
  control::TareReport report_;
};

}  // namespace tactus::arm_control
