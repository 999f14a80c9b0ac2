// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Force on the slave without a force sensor: what every estimator shares.
///
/// One axis in coherent SI units: N and m, or N m and rad. An estimator is an `Element` from `SlaveMotionSample` to
/// `ForceEstimate`; it steps once per servo tick and is causal.
namespace tactus::control {

/// What is known of the slave at one instant.
struct SlaveMotionSample {
  double command = 0.0;   ///< control signal in the actuator's unit; the actuator's force when its gain is 1
  double position = 0.0;  ///< measured, at the same instant
};

/// The sign of every estimator: the force of the environment ON the slave, positive toward +x. A slave that presses
/// onto a wall ahead of it feels a negative force. Paper B feeds back the opposite, K_a·(u − û).
struct ForceEstimate {
  double force = 0.0;  ///< N, or N m about a lever's axis
};

}  // namespace tactus::control
