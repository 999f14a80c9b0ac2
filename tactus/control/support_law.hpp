#pragma once

#include <tactus/control/support_check.hpp>

#include <algorithm>

namespace tactus::control {

/// What the holding law of a joint follows from. None of it is a number of the device's model, which may be wrong.
struct HoldingSource {
  double own_damping_N_s_per_m = 0.0;    ///< that its drive runs while the site is coupled
  double damping_limit_N_s_per_m = 0.0;  ///< that it may run; 0: it runs no law
  double force_limit_N = 100.0;          ///< of the motor
  double trial_force_N = 0.0;            ///< with which the motor is tried; 0: it is not
  double trial_least_m = 1e-4;           ///< by which that must move the joint
};

/// `asked` with the holding law of a joint, which `SupportCheck` describes.
///
/// The spring has 1/20 ms of the damper, or an eighth of the servo rate if that is less, and so is stable over the bus
/// for any inertia. The damper is that of the coupling, or more where the trial would move the joint by more than half
/// of `most_m`, within what the drive allows. Both are less where the spring would take more than half of the force
/// limit at `most_m`, or the trial's force would bend it by less than eight times `trial_least_m`: of that friction and
/// the lag of the damper leave about half, each way.
inline SupportCheck::Params with_holding_law(SupportCheck::Params asked, const HoldingSource& from, Seconds dt) {
  constexpr double shortest_lag_s = 0.02, ticks_of_lag = 8.0, trial_margin = 8.0, travel_share = 0.5, force_share = 0.5;
  const double lag_s = std::max(shortest_lag_s, ticks_of_lag * dt.value);
  double stiffness = std::max(from.own_damping_N_s_per_m / lag_s, from.trial_force_N / (travel_share * asked.most_m));
  stiffness =
      std::min({stiffness, from.damping_limit_N_s_per_m / lag_s, force_share * from.force_limit_N / asked.most_m});
  if (from.trial_force_N > 0.0) {
    stiffness = std::min(stiffness, from.trial_force_N / (trial_margin * from.trial_least_m));
  }
  asked.stiffness_N_per_m = stiffness;
  asked.damping_N_s_per_m = lag_s * stiffness;
  asked.least_force_N = from.trial_force_N;
  return asked;
}

}  // namespace tactus::control
