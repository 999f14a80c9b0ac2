// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::cli {

/// What `tactus rehearse` adds to a run of a rig.
struct Rehearsal {
  std::vector<std::string> faults;  ///< `SIDE:FAULT`, as `follower:silence:2@5`
  /// How far, in rad, and from when, in s, a simulated hand moves the joints of an emulated leader arm.
  double led_reach_rad = 0.3;
  double led_after_s = 10.0;
  /// How a simulated hand taps with the tool of an emulated leader arm, instead of that; and what the tool of an
  /// emulated follower arm meets.
  std::optional<real_time::EmulatedArm::Tapping> tapping = {};
  std::optional<real_time::EmulatedArm::Surface> surface = {};
};

/// Emulated motors in place of those of a rig: the motors of a side on a pseudo-terminal, or Haply's service on a port
/// of the loopback, each driven by a thread of its own at the real clock. They end with the object.
///
/// Each motor starts where its joint is at 0, or in the middle of the range that leader and follower share if 0 is
/// outside of that. With `arms` the motors of each side move that arm in MuJoCo, which a simulated hand holds at
/// `start_rad` until the motors compensate its weight.
class EmulatedRig {
 public:
  /// Starts the motors of the sides that are driven, `only` one or both, and writes their ports into `pair`. Errors:
  /// `inconsistent` for a bus or a model that tactus does not emulate, located in the rig's file; `syntax` and
  /// `out_of_bounds` for a fault; `failed` for a pseudo-terminal or thread that the system does not give.
  static Result<EmulatedRig> start(const devices::Rig& rig, devices::RigPair& pair,
                                   std::optional<control::SiteRole> only, const station::DescribedArms* arms,
                                   const Rehearsal& rehearsal);
  EmulatedRig(EmulatedRig&&) noexcept;
  EmulatedRig& operator=(EmulatedRig&&) = delete;
  ~EmulatedRig();

  /// One line for each side: what is emulated, and at which port.
  [[nodiscard]] const std::string& description() const noexcept { return description_; }

 private:
  class Side;
  EmulatedRig();

  std::vector<std::unique_ptr<Side>> sides_;
  std::string description_;
};

}  // namespace tactus::cli
