// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/devices/plugin/blocking_driver.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

namespace tactus::devices {

/// A thread that runs the cycles of a `BlockingDriver`, and exchanges newest values with the servo thread.
class BlockingLink final : public MotorLink {
 public:
  /// Starts the thread, which opens the driver. `silence_s`: a servo thread that sends no command for so long loses the
  /// torque of all motors. Errors: a number of motors or a cycle out of bounds; `failed` where the system gives no
  /// thread.
  static Result<std::unique_ptr<BlockingLink>> start(std::unique_ptr<BlockingDriver> driver, double silence_s);
  BlockingLink(const BlockingLink&) = delete;
  BlockingLink& operator=(const BlockingLink&) = delete;
  ~BlockingLink() override;

  [[nodiscard]] std::size_t motors() const noexcept override;
  void command(const BusCommands& commands) noexcept override;
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept override;
  [[nodiscard]] bool running() const noexcept override;
  /// Returns after 2 s at the latest. A driver that is still blocked then is left behind with its thread.
  void stop() override;
  Check wait_until_asked(Seconds longest) override;
  [[nodiscard]] MotorSheet sheet(std::size_t motor) const override;
  /// A driver that is still blocked counts as one whose motors have power.
  [[nodiscard]] std::vector<PoweredMotor> powered_motors() const override;
  [[nodiscard]] Check problem() const override;

 private:
  class Shared;
  explicit BlockingLink(std::shared_ptr<Shared> shared);

  std::shared_ptr<Shared> shared_;  ///< with the thread, which may outlive this object while the driver blocks
  std::thread thread_;
};

}  // namespace tactus::devices
