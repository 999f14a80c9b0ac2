// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/linear_plant.hpp>
#include <tactus/analysis/stability/state_space.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <complex>

/// The loop of induced master motion, as a linear sampled system.
namespace tactus::stability {

/// Position-force control about rest, in contact: the force that arrives at the master moves its motor, what of that
/// motion cancellation does not take out goes to the slave as a command, and the slave's tip force comes back.
///
///     L(z) = λ μ C(z) (G_i(z) − Ĝ_i(z)) G_se(z) z⁻ᵈ      closed loop: 1 + L = 0
///
/// with C the filters of command and force, G_i the master from motor force to motor position, Ĝ_i the controller's
/// model of it (zero with cancellation off), G_se the servoed slave on the wall from command to tip force. Sampled
/// exactly: plants behind hold and computation delay by matrix exponentials, elements of the sites by stepping them,
/// delays as whole ticks (never Padé). Left out: quantisation, noise, saturation, gates, jitter and loss of the
/// channel, the operator's slow correction. What the actuator on the handle does, with a crossover, moves the motor
/// too.
struct Loop {
  double tick_s = 0.0;
  double force_gain = 1.0;       ///< μ
  double position_scale = 1.0;   ///< λ
  Eigen::Index delay_ticks = 1;  ///< of both ways together, with the tick that every message to the master takes
  StateSpace master;             ///< from the arriving force times μ, in N, to the command times λ, in m
  StateSpace slave;              ///< from the command, in m, to the sampled tip force, in N
  StateSpace induced;            ///< G_i: from the displayed force, in N, to how far the motor gives way, in m
  StateSpace modelled;           ///< Ĝ_i, the same as the controller assumes it

  /// L at the angular frequency `frequency_rad_per_s`, up to π / tick, for the gain `force_gain`.
  [[nodiscard]] std::complex<double> at(double frequency_rad_per_s) const;
  /// The closed loop with the force gain `gain`; its last states are the delay, one for each tick.
  [[nodiscard]] StateSpace closed(double gain) const;
};

/// The loop that `params` describe, the slave's tip on the wall. Errors: parameters that no teleoperator can be made
/// of; `inconsistent` for what has no linear model here, with the reason: other architectures, an estimate in place of
/// the slave's force sensor, an estimate of the grip that adapts; `failed` as in `probe`. Not real-time safe.
Result<Loop> make_loop(const simulation::Teleoperator::Params& params, const Linearisation& linearisation = {});

/// Inputs and outputs of the master's site alone: the measured motor position in m and the arriving force times μ in N
/// make the motor force in N and that of the actuator on the handle, both positive toward the environment, and the
/// command times λ in m.
enum SiteInput : Eigen::Index { measured_in, arrived_force_in, site_inputs };
enum SiteOutput : Eigen::Index { motor_force_out, message_out, handle_force_out, site_outputs };

/// The controllers of both sites, without plants and delays.
struct LinearSites {
  StateSpace master;    ///< as in `SiteInput` and `SiteOutput`
  StateSpace slave;     ///< from the error of the position, in m, to the motor force, in N
  StateSpace modelled;  ///< Ĝ_i, from the motor force in N to the motor position in m
};

/// The sites that `params` describe. Errors: those of `make_loop`.
Result<LinearSites> linear_sites(const simulation::Teleoperator::Params& params,
                                 const Linearisation& linearisation = {});

/// Whole ticks that a message takes, jitter left out.
Eigen::Index ticks_of(const station::Channel::Params& channel, double tick_s);

/// Daniel and McAree's bound on λ μ: moving mass of the master over that of the slave (Int. J. Robotics Research 17(8),
/// 1998, as paper A quotes it).
double mass_ratio(const simulation::Teleoperator::Params& params);

}  // namespace tactus::stability
