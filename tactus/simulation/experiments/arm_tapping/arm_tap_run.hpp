// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <cstddef>

namespace tactus::experiments {

/// One tap through two simulated arms while it continues: who steps it has the clock. Each tick, the sites, then the
/// arms, until it is `over`.
class ArmTapRun {
 public:
  /// Of a setup and a tap that outlive it. Errors: those of `ArmPair::make`.
  static Result<ArmTapRun> make(const ArmPairSetup& setup, const ArmTap& tap);

  /// The sites' part of a tick. Real-time safe.
  void step_sites(const station::Tick& tick) noexcept { pair_.step_sites(tick); }
  /// Operator and arms, until the next tick; for each tick that the sites missed as well. Not once it is over.
  /// Real-time safe.
  void step_arms();

  /// A while after the first touch; where nothing was touched in time; or where an arm ran away.
  [[nodiscard]] bool over() const noexcept { return diverged_ || trace_.records.size() >= last_; }
  [[nodiscard]] bool diverged() const noexcept { return diverged_; }
  /// How the contact went. Once it is over.
  [[nodiscard]] ArmContact contact() const;
  [[nodiscard]] const ArmPair& pair() const noexcept { return pair_; }
  /// As far as it has come.
  [[nodiscard]] const ArmTrace& trace() const noexcept { return trace_; }

 private:
  ArmTapRun(const ArmPairSetup& setup, const ArmTap& tap, ArmPair pair);

  const ArmPairSetup* setup_;
  const ArmTap* tap_;
  ArmPair pair_;
  ArmTrace trace_;
  std::size_t first_touch_ = 0;
  bool touched_ = false;
  bool diverged_ = false;
  std::size_t last_;  ///< with so many ticks it is over
};

}  // namespace tactus::experiments
