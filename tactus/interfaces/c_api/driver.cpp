// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/driver_registry.hpp>
#include <tactus/interfaces/c_api/internal/errors.hpp>
#include <tactus/interfaces/cli/in_process.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/joints.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <string>

namespace tactus::c_api {

namespace {

constexpr std::size_t why_size = 512;
using Why = std::array<char, why_size>;

/// What a function of the driver reported; `name` is that of the function.
Check error_of(std::int32_t status, Why& why, const char* name) {
  if (status == 0) return std::nullopt;
  why.back() = '\0';
  std::string text(why.data());
  if (text.empty()) text = std::string(name) + " of the driver returned " + std::to_string(status);
  return Error{.code = ErrorCode::failed, .parameter = {}, .message = std::move(text), .place = {}};
}

/// A device behind function pointers.
class CalledDriver final : public devices::BlockingDriver {
 public:
  CalledDriver(const tactus_joint_driver& driver, void* device, std::size_t motors)
      : driver_(driver), device_(device), motors_(motors) {}
  CalledDriver(const CalledDriver&) = delete;
  CalledDriver& operator=(const CalledDriver&) = delete;
  ~CalledDriver() override { driver_.release(device_); }

  [[nodiscard]] std::size_t motors() const noexcept override { return motors_; }
  [[nodiscard]] double cycle_s() const noexcept override { return driver_.cycle_s; }
  [[nodiscard]] devices::MotorAbility ability(std::size_t) const noexcept override {
    return {
        .torque_Nm = driver_.torque_limit_Nm > 0.0 ? driver_.torque_limit_Nm : std::numeric_limits<double>::infinity(),
        .velocity_rad_per_s = driver_.velocity_limit_rad_per_s,
        .velocity_step_rad_per_s = driver_.velocity_step_rad_per_s,
        .stiffness_Nm_per_rad = driver_.stiffness_limit_Nm_per_rad,
        .damping_Nms_per_rad = driver_.damping_limit_Nms_per_rad};
  }

  Check open() override {
    Why why{};
    const std::int32_t status = driver_.open(device_, why.data(), why.size());
    return error_of(status, why, "open");
  }

  Check exchange(std::span<const devices::MotorCommand> commands, std::span<devices::MotorReading> readings) override {
    std::array<tactus_motor_command, most_joints> given{};
    for (std::size_t i = 0; i < motors_; ++i) {
      const devices::MotorCommand& one = commands[i];
      given[i] = {.torque_Nm = one.torque_Nm,
                  .law_position_rad = one.law.position_rad,
                  .law_velocity_rad_per_s = one.law.velocity_rad_per_s,
                  .law_stiffness_Nm_per_rad = one.law.stiffness_Nm_per_rad,
                  .law_damping_Nms_per_rad = one.law.damping_Nms_per_rad,
                  .enabled = one.enabled != 0 ? 1 : 0,
                  .reserved = 0};
    }
    Why why{};
    const std::int32_t status =
        driver_.exchange(device_, given.data(), reported_.data(), motors_, why.data(), why.size());
    if (Check error = error_of(status, why, "exchange")) return error;
    for (std::size_t i = 0; i < motors_; ++i) {
      readings[i].position_rad = reported_[i].position_rad;
      readings[i].velocity_rad_per_s = reported_[i].velocity_rad_per_s;
      readings[i].torque_Nm = reported_[i].torque_Nm;
      readings[i].temperature_C = reported_[i].temperature_C;
      readings[i].enabled = reported_[i].enabled != 0 ? 1 : 0;
    }
    return std::nullopt;
  }

  void close() noexcept override { driver_.close(device_); }

 private:
  static constexpr std::array<tactus_motor_reading, most_joints> at_first() {
    std::array<tactus_motor_reading, most_joints> readings{};
    for (auto& reading : readings) reading.temperature_C = std::numeric_limits<double>::quiet_NaN();
    return readings;
  }

  tactus_joint_driver driver_;
  void* device_;
  std::size_t motors_;
  std::array<tactus_motor_reading, most_joints> reported_ = at_first();
};

/// A driver of function pointers has no keys of its own.
class CalledSettings final : public devices::DriverSettings {
 public:
  explicit CalledSettings(const tactus_joint_driver& driver) : driver_(driver) {}
  void append_to(std::vector<Binding>&, std::string_view) override {}
  [[nodiscard]] Result<std::unique_ptr<devices::BlockingDriver>> make(
      const devices::DriverRequest& request) const override {
    Why why{};
    void* device = nullptr;
    const std::int32_t status = driver_.make(driver_.user, request.port.c_str(), request.motors.data(),
                                             request.motors.size(), &device, why.data(), why.size());
    if (const Check error = error_of(status, why, "make")) return *error;
    return std::unique_ptr<devices::BlockingDriver>(
        std::make_unique<CalledDriver>(driver_, device, request.motors.size()));
  }

 private:
  tactus_joint_driver driver_;
};

Check check_numbers(const tactus_joint_driver& driver) {
  constexpr Bounds cycles = between(1e-5, 1.0), none_or_more = between(0.0, 1e6);
  if (!cycles.contain(driver.cycle_s)) return out_of_bounds("cycle_s", driver.cycle_s, cycles, units::second);
  const std::array numbers{std::pair{"torque_limit_Nm", driver.torque_limit_Nm},
                           std::pair{"velocity_limit_rad_per_s", driver.velocity_limit_rad_per_s},
                           std::pair{"velocity_step_rad_per_s", driver.velocity_step_rad_per_s},
                           std::pair{"stiffness_limit_Nm_per_rad", driver.stiffness_limit_Nm_per_rad},
                           std::pair{"damping_limit_Nms_per_rad", driver.damping_limit_Nms_per_rad}};
  for (const auto& [name, value] : numbers) {
    if (!none_or_more.contain(value)) return out_of_bounds(name, value, none_or_more, units::none);
  }
  return std::nullopt;
}

}  // namespace

}  // namespace tactus::c_api

using namespace tactus::c_api;

tactus_status tactus_joint_driver_register(const tactus_joint_driver* driver, tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (!has_known_size(driver)) {
      return bad_argument("`driver` is NULL or of another size: begin with TACTUS_JOINT_DRIVER_INIT", error);
    }
    if (driver->name == nullptr || driver->make == nullptr || driver->open == nullptr || driver->exchange == nullptr ||
        driver->close == nullptr || driver->release == nullptr) {
      return bad_argument("`name` or a function of the driver is NULL: set all of them", error);
    }
    if (const auto wrong = check_numbers(*driver)) return leave(*wrong, error);
    const std::string summary = driver->summary != nullptr ? driver->summary : "";
    const tactus_joint_driver copied = *driver;
    if (tactus::cli::is_in_process()) {
      return leave_text("a command runs in this thread: register the driver when it has ended", TACTUS_FAILED, error);
    }
    const std::lock_guard lock(tactus::cli::one_command_at_a_time());
    const auto refused = tactus::devices::add_driver({.name = driver->name, .summary = summary, .settings = [copied] {
                                                        return std::unique_ptr<tactus::devices::DriverSettings>(
                                                            std::make_unique<CalledSettings>(copied));
                                                      }});
    return refused ? leave(*refused, error) : TACTUS_OK;
  });
}
