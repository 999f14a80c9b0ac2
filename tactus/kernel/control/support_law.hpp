// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/sign_probe.hpp>
#include <tactus/kernel/control/support_check.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::control {

/// What the holding law of a joint follows from. None of it but the friction, which only widens a bound, is a number of
/// the device's model, which may be wrong.
struct HoldingSource {
  double own_damping_N_s_per_m = 0.0;    ///< that its drive runs while the site is coupled
  double damping_limit_N_s_per_m = 0.0;  ///< that it may run; 0: it runs no law
  double force_limit_N = 100.0;          ///< of the motor
  double trial_force_N = 0.0;            ///< with which the motor is tried; 0: it is not
  double friction_N = 0.0;               ///< Coulomb, at the joint
};

/// `asked` with the holding law of a joint, which `SupportCheck` describes.
///
/// The damper is that of the coupling, or more, within what the drive allows, so that the trial of the motor moves the
/// joint at three quarters of `most_m_per_s` at most. The trial's force bends the spring by 0.6 of `most_m`; it is
/// softer where it would exceed 1/20 ms of the damper, or an eighth of the servo rate if that is less, which keeps it
/// stable over the bus for any inertia; and where it would take more than half of the force limit at `most_m`.
///
/// Whatever the weight, the support may be wrong by the trial's force, and by a tenth of the force limit and the
/// friction, which keeps what a hand left in the spring, at most. Two
/// arms share the trial's force and not their motors: what tries the larger one is all that a motor of the smaller one
/// can give, and a support that may be wrong by so much is not judged at all.
inline SupportCheck::Params with_holding_law(SupportCheck::Params asked, const HoldingSource& from, Seconds dt) {
  constexpr double shortest_lag_s = 0.02, ticks_of_lag = 8.0, speed_share = 0.75, travel_share = 0.6, force_share = 0.5,
                   wrong_share = 0.1;
  const double lag_s = std::max(shortest_lag_s, ticks_of_lag * dt.value);
  const double for_trial = from.trial_force_N / (speed_share * asked.most_m_per_s);
  const double damping = std::min(std::max(from.own_damping_N_s_per_m, for_trial), from.damping_limit_N_s_per_m);
  double stiffness = std::min(damping / lag_s, force_share * from.force_limit_N / asked.most_m);
  if (from.trial_force_N > 0.0) stiffness = std::min(stiffness, from.trial_force_N / (travel_share * asked.most_m));
  asked.stiffness_N_per_m = stiffness;
  asked.damping_N_s_per_m = damping;
  asked.trial_force_N = from.trial_force_N;
  asked.least_force_N = std::min(from.trial_force_N, wrong_share * from.force_limit_N + from.friction_N);
  return asked;
}

/// `asked` with a first force that moves no joint which `held` damps beyond what is judged, whatever its mass and
/// however little it rubs; the force is doubled up to the one asked for while the joint does not move both ways.
///
/// Under a lobe of length L = duration_s/5 and peak F, a mass with the damper B reaches at most F/B, and goes
/// F·L/(2·B). The first force keeps the former within three quarters of `most_m_per_s` and the latter within three
/// quarters of `most_m`. A repeated one exceeds what rubs at the joint by little more than the friction itself. The
/// trial is shortened, to 0.2 s at most, so that the force asked for goes no farther than half of `most_m`: friction
/// that bears part of the weight makes each half go farther one way than back. It stays long enough for a quarter of
/// that force to move `inertia`, the largest of all poses, by `least_m`. That is a number of the model: where it is too
/// large the trial is as long as was asked for, which makes the first force smaller, and where it is too small the
/// joint may not move. Without damper all stays as it is.
inline SignProbe::Params with_gentle_trial(SignProbe::Params asked, const SupportCheck::Params& held, double inertia) {
  constexpr double share = 0.75, share_of_repeated = 0.5, lobes = 5.0, shortest_s = 0.2;
  const double damping = held.damping_N_s_per_m;
  if (damping == 0.0 || asked.force_N == 0.0) return asked;
  asked.most_force_N = std::max(asked.force_N, asked.most_force_N);
  const double wanted_s = 2.0 * lobes * share_of_repeated * held.most_m * damping / asked.most_force_N;
  const double for_inertia_s = std::sqrt(4.0 * 50.0 * asked.least_m * inertia / asked.most_force_N);
  asked.duration_s = std::min(asked.duration_s, std::max({wanted_s, for_inertia_s, shortest_s}));
  const double half_lobe_s = 0.5 * asked.duration_s / lobes;
  const double speed_m_per_s = share * std::min(held.most_m_per_s, held.most_m / half_lobe_s);
  asked.force_N = std::min(asked.force_N, speed_m_per_s * damping);
  return asked;
}

}  // namespace tactus::control
