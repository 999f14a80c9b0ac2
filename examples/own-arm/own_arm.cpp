// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/plugin.hpp>

#include <chrono>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "stand_in_robot.hpp"

namespace {

using namespace tactus;

/// An arm that is reached by a blocking call once a millisecond.
class OwnArm final : public devices::BlockingDriver {
 public:
  /// The keys of [PAIR.leader] and [PAIR.follower] that only this driver has.
  struct Params {
    double torque_limit_Nm = 5.0;
    std::int64_t fails_after = 0;  // so that you can see what a failure looks like
    std::int64_t blocks_after = 0;
    static constexpr auto fields() {
      return List{field("torque_limit_Nm", &Params::torque_limit_Nm, Unit{"N m", "_Nm"}, positive_up_to(100.0),
                        "Largest torque of a joint."),
                  field("fails_after", &Params::fails_after, between(0.0, 1e9), "Fail after so many cycles; 0: never."),
                  field("blocks_after", &Params::blocks_after, between(0.0, 1e9),
                        "Block for 100 ms after so many cycles; 0: never.")};
    }
  };

  static Result<std::unique_ptr<devices::BlockingDriver>> make(const Params& params,
                                                               const devices::DriverRequest& request) {
    for (const std::int64_t motor : request.motors) {
      if (motor >= 1 && motor <= static_cast<std::int64_t>(StandInRobot::joints)) continue;
      return Error{.code = ErrorCode::out_of_bounds,
                   .parameter = "motors",
                   .message = "motor " + std::to_string(motor) + " does not exist: the arm has motors 1 and 2",
                   .place = {}};
    }
    std::unique_ptr<devices::BlockingDriver> made(new OwnArm(params));
    return made;
  }

  std::size_t motors() const noexcept override { return StandInRobot::joints; }
  devices::MotorAbility ability(std::size_t) const noexcept override {
    return {.torque_Nm = params_.torque_limit_Nm, .velocity_step_rad_per_s = 1e-4};
  }

  Check open() override {
    robot_.connect();
    return std::nullopt;
  }

  Check exchange(std::span<const devices::MotorCommand> commands, std::span<devices::MotorReading> readings) override {
    ++cycles_;
    if (cycles_ == params_.fails_after) throw std::runtime_error("the robot reported a collision");
    if (cycles_ == params_.blocks_after) robot_.hiccup(std::chrono::milliseconds(100));
    std::array<double, StandInRobot::joints> torque_Nm{};
    for (std::size_t i = 0; i < commands.size(); ++i) {
      torque_Nm[i] = commands[i].enabled != 0 ? commands[i].torque_Nm : 0.0;
    }
    const StandInRobot::State state = robot_.cycle(torque_Nm);
    for (std::size_t i = 0; i < readings.size(); ++i) {
      readings[i].position_rad = state.position_rad[i];
      readings[i].velocity_rad_per_s = state.velocity_rad_per_s[i];
      readings[i].torque_Nm = torque_Nm[i];
      readings[i].enabled = commands[i].enabled;
    }
    return std::nullopt;
  }

  void close() noexcept override {}

 private:
  explicit OwnArm(const Params& params) : params_(params) {}

  Params params_;
  StandInRobot robot_;
  std::int64_t cycles_ = 0;
};

Check add_own_arm() { return devices::register_driver<OwnArm>("own-arm", "two joints behind a blocking call"); }

}  // namespace

TACTUS_PLUGIN(add_own_arm)
