// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/state_space.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

/// How far two arms that feel contact are from instability: their loop, linear and sampled, about a pose in contact.
namespace tactus::arm_stability {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// What holds an arm alongside its weight: at its tool along the axes of the base, forces in the upper three rows and
/// moments in the lower, and at its motors. All are without delay.
struct Holding {
  Matrix6 stiffness = Matrix6::Zero();  ///< N/m and N m/rad
  Matrix6 damping = Matrix6::Zero();    ///< N s/m and N m s/rad
  Eigen::VectorXd drive_stiffness;      ///< of each drive's own law, N m/rad
  Eigen::VectorXd drive_damping;        ///< N m s/rad
  Eigen::VectorXd rubbing;              ///< what stands for the friction of each motor, N m s/rad
};

/// An arm for small motions about rest at `position`, in continuous time: torques of the motors in, and out positions
/// of the motors, velocities of the motors, positions of the links, velocities of the links, `joints` of each; of rigid
/// joints motor and link are one. Of `arm` are taken masses, armature, the mass that the tool carries, stiffness and
/// damping of the joints, and how the weight changes with the pose; not steps, limits, play and friction, for which
/// `holding.rubbing` is. The curvature that a steady contact force adds is left out. Not real-time safe.
///
/// No part of it is the controller's: `tests/arm_stability` holds it against differences of MuJoCo's arm. Errors: those
/// of `arm::Chain::make`.
Result<stability::StateSpace> linear_arm(const arm_plants::ArmPlant::Params& arm, const arm::JointVector& position,
                                         const Holding& holding);

/// How the torque that holds the arm still changes with its position: row of a joint, column of a position. N m/rad.
Eigen::MatrixXd weight_slope(const arm::Chain& chain, const arm::JointVector& position);

}  // namespace tactus::arm_stability
