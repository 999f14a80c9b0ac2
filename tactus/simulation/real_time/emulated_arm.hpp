// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/damiao/motor.hpp>
#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/arm_plants/arm_plant.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>

namespace tactus::real_time {

/// An arm with its weight behind emulated motors, motor 1 at the joint of its base: links, rotors and friction in
/// MuJoCo (`arm_plants::ArmPlant`), which is other code than the controller's model of an arm. Without torque it falls.
///
/// It begins at rest where it hangs; or where a hand holds it, which releases it for good once the motors compensate
/// gravity: when no joint would move by more than its friction allows. A hand that waits for ever reports that whoever
/// drives the motors has the model of another arm.
///
/// It may then be led: a hand that pulls each joint like a spring, with a damper, to a path of two sines about where
/// the arm was held, other frequencies at each joint (0.2 to 0.5 Hz, and 2.3 times that). Or it may tap: a hand
/// (400 N/m, 30 N s/m) moves the tool straight down and up again. The tool may meet a level surface below it. So the
/// leader of an emulated pair taps, and its follower touches something.
class EmulatedArm final : public emulation::damiao::Mechanism {
 public:
  /// The hand that leads it.
  struct Led {
    double reach_rad = 0.3;  ///< of the path, either way, at each joint
    double after_s = 0.0;    ///< since the motors compensate gravity; until then it is not felt, and comes in over 2 s
  };
  /// The hand that taps with its tool.
  struct Tapping {
    double depth_m = 0.04;  ///< down from where the tool is then
    double period_s = 2.0;  ///< from tap to tap; the tool is away for half of it, 1 s at most
    double after_s = 0.0;   ///< as of `Led`
  };
  /// What the tool meets.
  struct Surface {
    double gap_m = 0.02;  ///< below the tool where the arm begins
    double stiffness_N_per_m = 20'000.0;
    double damping_N_s_per_m = 20.0;
  };
  struct Settings {
    /// Links, armature, Coulomb and viscous friction, gravity.
    arm::Chain::Params chain;
    std::optional<arm::JointVector> held_at = {};  ///< in rad; none: it hangs
    std::optional<Led> led = {};                   ///< none: nobody leads it
    std::optional<Tapping> tapping = {};           ///< none: nobody taps
    std::optional<Surface> surface = {};           ///< none: the tool meets nothing
    arm::Vector3 tool_m = arm::Vector3::Zero();    ///< on the last link
    /// What acts on the tool from outside while nobody holds the arm; none: nothing. Called each 100 µs.
    std::function<arm_plants::ToolForce(const arm_plants::ToolState&)> touched = {};
  };
  /// Errors: those of `arm_plants::ArmPlant::make` and of `mechanics::Environment::make`.
  static Result<std::unique_ptr<EmulatedArm>> make(const Settings& settings);
  ~EmulatedArm() override;

  [[nodiscard]] std::size_t motors() const noexcept override;
  [[nodiscard]] double position_rad(std::size_t motor) const noexcept override;
  [[nodiscard]] double velocity_rad_per_s(std::size_t motor) const noexcept override;
  void step(std::span<const double> torque_Nm) noexcept override;
  [[nodiscard]] arm_plants::ToolState tool() const;
  /// Force of the surface on the tool in N, at the latest step.
  [[nodiscard]] double contact_N() const noexcept;
  /// Whether a hand still holds it.
  [[nodiscard]] bool held() const noexcept;

 private:
  struct Body;
  explicit EmulatedArm(std::unique_ptr<Body> body);
  std::unique_ptr<Body> body_;
};

}  // namespace tactus::real_time
