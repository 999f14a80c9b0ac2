// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/wire/port.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/shared_slots.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

namespace tactus::devices {

/// A thread that drives a bus of motors at its port.
class BusThread final : public MotorLink {
 public:
  struct Params {
    double silence_s = 0.05;
    static constexpr auto fields() {
      return List{field("silence_s", &Params::silence_s, units::second, between(0.001, 10.0),
                        "Timeout of the servo thread, after which the motors lose their power.")};
    }
  };

  /// Errors: parameters out of bounds; more motors than joints; `failed` where the system gives no thread.
  static Result<std::unique_ptr<BusThread>> start(std::unique_ptr<MotorBus> bus, wire::Port port, const Params& params);
  BusThread(const BusThread&) = delete;
  BusThread& operator=(const BusThread&) = delete;
  ~BusThread() override;

  [[nodiscard]] std::size_t motors() const noexcept override { return motors_; }
  void command(const BusCommands& commands) noexcept override { commands_.publish(commands); }
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept override { return readings_.newest(); }
  [[nodiscard]] bool running() const noexcept override { return running_.load(std::memory_order_acquire); }
  void stop() override;
  Check wait_until_asked(Seconds longest) override;
  [[nodiscard]] MotorSheet sheet(std::size_t motor) const override { return bus_->sheet(motor); }
  [[nodiscard]] std::vector<PoweredMotor> powered_motors() const override;
  [[nodiscard]] Check problem() const override { return running() ? Check() : failed_; }

 private:
  class Exchange;
  BusThread(std::unique_ptr<MotorBus> bus, wire::Port port, const Params& params);
  void run() noexcept;

  std::unique_ptr<MotorBus> bus_;
  wire::Port port_;
  std::int64_t silence_ns_;
  std::size_t motors_;
  runtime::SharedSlots<BusReadings, 8> readings_{};
  runtime::SharedSlots<BusCommands, 8> commands_{};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> running_{true};
  Check failed_;  ///< written before `running_` is false
  std::thread thread_;
};

}  // namespace tactus::devices
