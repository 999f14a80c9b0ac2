// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <optional>

/// How old the readings of the other arm may be, where each is pulled to the other's position by its own drives.
///
///     leader:    M₁ q̈₁ + B₁ q̇₁ + K₁ q₁ + Kp (q₁ − q₂(t − T)) + Kd (q̇₁ − σ q̇₂(t − T)) = 0 ,   and the follower alike.
///
/// A drive's own part knows no delay; the other's part is T old. With C = Kp + σ Kd s and L = M s² + (B + Kd) s + K +
/// Kp of each arm, the loop L₁ q₁ = C e^(−sT) q₂, L₂ q₂ = C e^(−sT) q₁ is at the edge where an eigenvalue μ of C⁻¹ L₂
/// C⁻¹ L₁ at jω has the size 1 and T = −arg μ/(2ω). Linear: no friction that sticks, no play, no torque limit.
namespace tactus::arm_control {

using arm::JointMatrix;
using arm::JointVector;

/// What the drives do, alike in both arms. In N m/rad and N m s/rad; σ is `velocity_share`, 0 to 1: which share of the
/// other's velocity a drive is asked for. At 0 it damps towards rest.
struct PositionCoupling {
  JointVector stiffness;
  JointVector damping;
  double velocity_share = 1.0;
};

/// An arm at a pose, with what else holds it: a hand, friction. kg m², N m s/rad, N m/rad.
struct CoupledArm {
  JointMatrix inertia;
  JointMatrix damping;
  JointMatrix stiffness;
};

/// How fast motion grows, in 1/s, where nothing is old but a host reads the leader's velocities `scale` times too large
/// and reports its drives velocities by as much too small (`arm_plants::MotorParams::velocity_scale`): the follower is
/// asked for σ·scale·q̇₁, the leader for σ·q̇₂/scale. The largest real part of the loop's poles, so below 0, but for what
/// nothing holds, where all dies out. `scale` is of one joint each, positive. Not real-time safe.
///
/// Two alike joints that move together are damped by Kd·(2 − σ (scale + 1/scale)) between them, which no stiffness
/// changes: with σ = 1 every scale but 1 drives them, and more damping of the drives drives them more. (What is T old
/// adds 2 Kp T to that, while it is slow.)
double growth_per_s(const CoupledArm& leader, const CoupledArm& follower, const PositionCoupling& coupling,
                    const JointVector& scale);

/// Where a coupling begins to oscillate.
struct DelayLimit {
  double delay_s = 0.0;  ///< one way, the mean of both ways
  double frequency_Hz = 0.0;
  int joint = 0;  ///< from 0: that of which the leader's oscillation has most, by the energy in the drives' springs
};

/// The smallest delay with which two arms oscillate, searched between 0.2 and 300 Hz; none where they do with no delay
/// up to `longest_s`. The loop without delay is stable, as the drives' parts are passive. All matrices are of one size.
/// Not real-time safe.
std::optional<DelayLimit> delay_limit(const CoupledArm& leader, const CoupledArm& follower,
                                      const PositionCoupling& coupling, double longest_s = 1.0);

/// The same of two alike joints without friction in closed form: they oscillate at ω = √(2 Kp J − (1 − σ²) Kd²)/J, the
/// one against the other; σ = 1 gives T = 2/ω·arctan(ω Kd/Kp). None where (1 − σ²) Kd² ≥ 2 Kp J: then they do with no
/// delay at all. Arguments in N m/rad, N m s/rad and kg m², the first and last positive.
std::optional<DelayLimit> delay_limit_of_joint(double stiffness, double damping, double inertia_kg_m2,
                                               double velocity_share = 1.0);

}  // namespace tactus::arm_control
