// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::devices::inverse3 {

struct LinkParams {
  std::string address = "127.0.0.1:10001";
  std::string device;              ///< its identifier, as 049D; empty: the first that the service reports
  std::vector<std::int64_t> axes;  ///< of each joint: 1 is x, 2 is y, 3 is z
  double shortest_cycle_s = 0.001;
  double silence_s = 0.05;  ///< of the servo tick, until the force ends
};
/// Errors: `syntax` for the address, under `port`; `out_of_bounds`, `inconsistent` under `motors` and `motors[i].id`.
Check check(const LinkParams& params);

/// An Inverse3 behind Haply's Inverse Service, by a thread of its own: one message for each state, as fast as the
/// service answers and at most once a cycle. Axes are in m and N. An axis that no joint has gets no force.
///
/// A tick without force sends a message without a command, which ends the force, until the device has reported three
/// times in a row that it is idle; then the same keeps its state fresh. A device that still gives a force after 0.1 s
/// has the fault `stays_on` for good, and is then spoken to every 150 ms alone, so that the service may end the force
/// for want of messages. One that is idle for 0.1 s under commands of force has the fault `refused` until none is asked
/// for.
///
/// There is no force before the device is calibrated. The service ends a force by itself when messages stop, so a
/// program that was killed leaves none. Where the connection ends, it is made again, for ever; meanwhile readings grow
/// old. An invalid message is left out. Not tried on hardware.
class Inverse3Link final : public MotorLink {
 public:
  /// Errors: those of `check`; `failed` where the system gives no thread.
  static Result<std::unique_ptr<Inverse3Link>> start(const LinkParams& params);
  Inverse3Link(const Inverse3Link&) = delete;
  Inverse3Link& operator=(const Inverse3Link&) = delete;
  ~Inverse3Link() override;

  [[nodiscard]] std::size_t motors() const noexcept override;
  void command(const BusCommands& commands) noexcept override;
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept override;
  [[nodiscard]] bool running() const noexcept override;
  void stop() override;
  Check wait_until_asked(Seconds longest) override;
  [[nodiscard]] MotorSheet sheet(std::size_t motor) const override;
  [[nodiscard]] std::vector<PoweredMotor> powered_motors() const override;

 private:
  class Worker;
  explicit Inverse3Link(std::unique_ptr<Worker> worker);
  std::unique_ptr<Worker> worker_;
};

}  // namespace tactus::devices::inverse3
