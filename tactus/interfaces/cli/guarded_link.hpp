// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/interfaces/cli/guard_page.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tactus::cli {

/// The link to motors that a guard process watches. A command counts as a beat if the bus has ended a cycle since the
/// beat before, so the beats stop when the servo thread stops, when the bus thread stops, and when the program stops.
///
/// While the guard is gone, no motor is commanded to have power and readings state that the guard is gone. After the
/// guard has switched the motors off, the same holds until a command enables nothing and no motor reports power; then
/// the motors can be armed again.
class GuardedLink final : public devices::MotorLink {
 public:
  /// The page must outlive it.
  GuardedLink(std::unique_ptr<devices::MotorLink> link, GuardPage& page) : link_(std::move(link)), page_(&page) {}

  [[nodiscard]] std::size_t motors() const noexcept override { return link_->motors(); }
  void command(const devices::BusCommands& commands) noexcept override;
  [[nodiscard]] std::optional<devices::BusReadings> newest() const noexcept override;
  [[nodiscard]] bool running() const noexcept override { return link_->running(); }
  /// The guard has nothing to watch after it.
  void stop() override;
  Check wait_until_asked(Seconds longest) override { return link_->wait_until_asked(longest); }
  [[nodiscard]] devices::MotorSheet sheet(std::size_t motor) const override { return link_->sheet(motor); }
  [[nodiscard]] std::vector<devices::PoweredMotor> powered_motors() const override { return link_->powered_motors(); }
  [[nodiscard]] Check problem() const override { return link_->problem(); }

 private:
  [[nodiscard]] devices::GuardState state() const noexcept;

  std::unique_ptr<devices::MotorLink> link_;
  GuardPage* page_;
  BeatWatch guard_{guard_timeout_ns, guard_timeout_ns / 10};
  std::int64_t cycles_ = 0;
  bool guard_silent_ = false;  ///< of the servo thread, as is all above
};

}  // namespace tactus::cli
