#pragma once

#include <tactus/core/joints.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/core/result.hpp>
#include <tactus/devices/motor_bus.hpp>
#include <tactus/runtime/shared_slots.hpp>
#include <tactus/wire/port.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <thread>

namespace tactus::devices {

/// All motors of a bus after one of its cycles.
struct BusReadings {
  std::array<MotorReading, most_joints> motors{};
  BusState state = BusState::asking;
  std::int64_t cycles = 0;
  std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC, when the cycle ended
};

/// What a tick wants of all motors.
struct BusCommands {
  std::array<MotorCommand, most_joints> motors{};
  std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC, of the tick
};

/// A thread that drives a bus of motors at its port, and exchanges the newest readings and commands with a servo tick,
/// which never waits for it.
///
/// Commands that are older than the silence allowed take the power from all motors; it does not come back by itself:
/// commands that enable nothing must come first. When it is destroyed, or told to stop, the motors lose their power
/// before it ends, as far as they answer.
class BusThread {
 public:
  struct Params {
    double silence_s = 0.05;
    static constexpr auto fields() {
      return List{field("silence_s", &Params::silence_s, units::second, between(0.001, 10.0),
                        "The longest silence of the servo tick before the motors lose their power.")};
    }
  };

  /// Errors: parameters out of bounds; more motors than joints; `failed` where the system gives no thread.
  static Result<std::unique_ptr<BusThread>> start(std::unique_ptr<MotorBus> bus, wire::Port port, const Params& params);
  BusThread(const BusThread&) = delete;
  BusThread& operator=(const BusThread&) = delete;
  ~BusThread();

  [[nodiscard]] std::size_t motors() const noexcept { return motors_; }
  /// One thread, the servo's. Wait-free.
  void command(const BusCommands& commands) noexcept { commands_.publish(commands); }
  /// None before it began. Any thread. Wait-free.
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept { return readings_.newest(); }
  /// False once the port was closed or it was stopped. Any thread. Wait-free.
  [[nodiscard]] bool running() const noexcept { return running_.load(std::memory_order_acquire); }

  /// Ends it; the motors lose their power first. Not real-time safe, as all that follows.
  void stop();
  /// Waits until the motors were asked, so long at most. Errors: what is wrong with them, or with the port.
  Check wait_until_asked(Seconds longest);
  /// Once it is not running.
  [[nodiscard]] const MotorBus& bus() const noexcept { return *bus_; }

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
