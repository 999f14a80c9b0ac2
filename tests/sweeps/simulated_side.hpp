// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tests/sweeps/position_bench.hpp>

namespace tactus::sweeps {

/// The motors of one side of a rig and the joints that they move, in virtual time, as a bus reports them: in steps, a
/// bus cycle late, now and then later.
///
/// The joints of an arm are MuJoCo's. Any other one is a mass with Coulomb friction. A hand pulls each joint of a
/// leader, like a spring that swings at 4 Hz, along a path of its own: there and back at up to 2 rad/s (0.2 m/s of an
/// axis). It takes an arm only once it begins its path.
class SimulatedSide final : public devices::MotorLink {
 public:
  SimulatedSide(const devices::RigSide& side, const station::DescribedArm* arm, bool is_led, bool meets_stops,
                const signal::Random& random);

  [[nodiscard]] std::size_t motors() const noexcept override { return joints_.size(); }
  void command(const devices::BusCommands& commands) noexcept override { commanded_ = commands; }
  [[nodiscard]] std::optional<devices::BusReadings> newest() const noexcept override { return newest_; }
  [[nodiscard]] bool running() const noexcept override { return true; }
  void stop() override {}
  Check wait_until_asked(Seconds) override { return std::nullopt; }
  [[nodiscard]] devices::MotorSheet sheet(std::size_t) const override { return {}; }
  [[nodiscard]] std::vector<devices::PoweredMotor> powered_motors() const override { return {}; }

  /// Up to this instant: the joints, then what the bus has of them.
  void advance(std::int64_t now_ns, double tick_s);
  /// Until so much of its weight is borne by its motors, all of it, an arm stands on something; of one that has no
  /// weight nothing.
  void is_supported_by(double share, bool has_weight) noexcept;
  /// The hand begins its path.
  void begins_to_move() noexcept { moves_ = true; }
  /// From now on the position of a joint is wrong.
  void spoil(std::size_t joint, PositionFault fault) noexcept;
  /// How far that joint has been from where it was then, in rad of its motor.
  [[nodiscard]] double travelled_rad() const noexcept { return travelled_rad_; }

 private:
  struct Joint {
    devices::MotorJoint is;
    bool slides = false;
    double inertia = 0.0, friction = 0.0;
    double reach = 0.0, rad_per_s = 0.0;  ///< of the hand's path: its amplitude, and its frequency
    double stop = 1e9;                    ///< where it meets one
    double position = 0.0, velocity = 0.0, torque = 0.0;
    double reported_velocity = 0.0;  ///< filtered by its drive
    std::int64_t answers = 0;
    devices::MotorCommand acts;  ///< what its motor obeys
  };
  void step_joints(double step_s);
  void measure(std::int64_t now_ns);
  /// A position as a motor has it, in its steps.
  [[nodiscard]] double counted(const Joint& joint, double position, bool noisy);
  /// What the motor of the spoiled joint reports as its position.
  [[nodiscard]] double wrong_position(const Joint& joint);
  /// Of hand and stop on a joint that is there.
  [[nodiscard]] double from_outside(const Joint& joint, double position, double velocity) const noexcept;

  std::vector<Joint> joints_;
  std::optional<arm_plants::ArmPlant> arm_;
  arm::JointVector began_at_;
  std::size_t of_arm_ = 0;
  bool is_led_;
  signal::Random random_;
  double cycle_s_ = 0.002, filter_s_ = 0.002, position_step_ = 0.0004;
  devices::BusCommands commanded_{}, on_the_way_{};
  std::optional<devices::BusReadings> newest_;
  std::int64_t next_cycle_ns_ = 0;
  double path_s_ = 0.0;
  bool moves_ = false, stands_ = true;
  PositionFault fault_ = PositionFault::none;
  std::size_t spoiled_ = 0;
  double spoiled_at_ = 0.0, scale_ = 1.0, late_s_ = 0.0, travelled_rad_ = 0.0;
  std::optional<double> frozen_rad_;
  std::vector<double> history_;  ///< of the spoiled joint, at each measurement since
};

}  // namespace tactus::sweeps
