// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/arm/physical_arm.hpp>
#include <tactus/kernel/core/result.hpp>

#include <memory>

/// Simulated arms, in MuJoCo: other code than the controller's model of an arm (`tactus/arm`).
namespace tactus::arm_plants {

using arm::ArmCommand;
using arm::ArmReading;
using arm::JointVector;
using arm::MotorParams;
using arm::Vector3;

/// An end stop is a spring with a damper that a link meets at its joint's limit. Against what a torque on that link
/// accelerates, where the arm begins and its other joints are free, it swings at this frequency with this damping
/// ratio. So an OpenArm-class arm has stops of 28 kN m/rad and 71 N m s/rad at joint 1, 470 N m/rad and 1.2 N m s/rad
/// at joint 5.
inline constexpr double end_stop_rad_per_s = 400.0;
inline constexpr double end_stop_damping_ratio = 0.5;

/// Where the tool is and how it moves, along the axes of the base.
struct ToolState {
  Vector3 position_m;
  arm::Matrix3 rotation;  ///< of the last link
  Vector3 velocity_m_per_s;
  Vector3 turning_rad_per_s;
};

/// What acts on the tool at its point.
struct ToolForce {
  Vector3 force_N = Vector3::Zero();
  Vector3 moment_N_m = Vector3::Zero();
};

/// A serial arm with its motors, as the world has it: rigid links, Coulomb friction that sticks and viscous friction at
/// the motor, rigid or elastic joints, end stops. MuJoCo steps it (semi-implicit Euler: velocities first, viscous
/// friction implicitly); forces on the tool and of end stops are located forces of ours, taken at the beginning of a
/// step.
///
/// A value: a copy runs on its own, with equal bits under equal input. A step does not allocate.
/// Source of the engine: E. Todorov, T. Erez, Y. Tassa, MuJoCo: A physics engine for model-based control, IROS 2012.
class ArmPlant {
 public:
  using Params = arm::PhysicalArm;

  /// At rest, with its links at `position`: springs of elastic joints are bent by what the links weigh, and play lies
  /// on the flank that bears it. Errors: those of `Chain::make`; `inconsistent` for other numbers of motors or
  /// positions than of joints and for friction that it does not have; `failed` where MuJoCo refuses the arm.
  static Result<ArmPlant> make(const Params& params, const JointVector& position);

  ArmPlant(const ArmPlant& other);
  ArmPlant(ArmPlant&& other) noexcept;
  ArmPlant& operator=(ArmPlant other) noexcept;
  ~ArmPlant();

  /// What the drives report now, in their steps.
  [[nodiscard]] ArmReading read() const;
  /// The drives obey from now on.
  void write(const ArmCommand& command);
  [[nodiscard]] ToolState tool() const;
  /// One step of `Params::step_s` under the drives' law and a force on the tool.
  void step(const ToolForce& on_tool);

  /// Not measured by any motor: of the links, in rad and rad/s.
  [[nodiscard]] JointVector link_position() const;
  [[nodiscard]] JointVector link_velocity() const;
  /// Torque on each link that bears what it weighs where it is, in N m, of an arm that rests.
  [[nodiscard]] JointVector bearing_torque() const;
  /// Torque of a force at the tool on each link, in N m.
  [[nodiscard]] JointVector torque_of(const ToolForce& on_tool) const;
  /// Kinetic and potential energy in J, that of elastic joints and end stops included, the latter less an unknown
  /// constant.
  [[nodiscard]] double energy_J() const;
  /// False once a number was not finite or ran away.
  [[nodiscard]] bool healthy() const;

 private:
  struct Engine;
  explicit ArmPlant(std::unique_ptr<Engine> engine);
  std::unique_ptr<Engine> engine_;
};

}  // namespace tactus::arm_plants
