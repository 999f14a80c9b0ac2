// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/support_check.hpp>

#include <algorithm>

namespace tactus::control {

/// What the holding law of a joint follows from. None of it is a number of the device's model, which may be wrong.
struct HoldingSource {
  double own_damping_N_s_per_m = 0.0;    ///< that its drive runs while the site is coupled
  double damping_limit_N_s_per_m = 0.0;  ///< that it may run; 0: it runs no law
  double force_limit_N = 100.0;          ///< of the motor
  double trial_force_N = 0.0;            ///< with which the motor is tried; 0: it is not
};

/// `asked` with the holding law of a joint, which `SupportCheck` describes.
///
/// The damper is that of the coupling, or more, within what the drive allows, so that the trial of the motor moves the
/// joint at three quarters of `most_m_per_s` at most. The trial's force bends the spring by 0.6 of `most_m`; it is
/// softer where it would exceed 1/20 ms of the damper, or an eighth of the servo rate if that is less, which keeps it
/// stable over the bus for any inertia; and where it would take more than half of the force limit at `most_m`.
inline SupportCheck::Params with_holding_law(SupportCheck::Params asked, const HoldingSource& from, Seconds dt) {
  constexpr double shortest_lag_s = 0.02, ticks_of_lag = 8.0, speed_share = 0.75, travel_share = 0.6, force_share = 0.5;
  const double lag_s = std::max(shortest_lag_s, ticks_of_lag * dt.value);
  const double for_trial = from.trial_force_N / (speed_share * asked.most_m_per_s);
  const double damping = std::min(std::max(from.own_damping_N_s_per_m, for_trial), from.damping_limit_N_s_per_m);
  double stiffness = std::min(damping / lag_s, force_share * from.force_limit_N / asked.most_m);
  if (from.trial_force_N > 0.0) stiffness = std::min(stiffness, from.trial_force_N / (travel_share * asked.most_m));
  asked.stiffness_N_per_m = stiffness;
  asked.damping_N_s_per_m = damping;
  asked.least_force_N = from.trial_force_N;
  return asked;
}

}  // namespace tactus::control
