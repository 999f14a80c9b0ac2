// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device_guard.hpp>
#include <tactus/kernel/station/site_pair.hpp>

#include <array>
#include <memory>
#include <utility>

namespace tactus::station {

/// Both sites of a teleoperator on one computer, each with its device: what a servo thread steps.
///
/// Where a device can do less than its safety gate lets through, the gate is tightened to that: what a site assumes to
/// be applied then is. A device that is not simulated is behind a `GuardedDevice`, and is refused where it states
/// no limits of its own, where a limit of its gates was never chosen, and by sites without supervision.
template <class Pair>
class DevicePair {
 public:
  using Output = typename Pair::Output;
  using Request = typename Pair::Request;
  using Params = typename Pair::Params;
  using Lengths = typename Pair::Lengths;  ///< in m
  using Reading = Each<Lengths, DeviceReading>;
  using Device = DeviceOf<Reading>;

  /// For devices that outlive it, at rest with the slave at `slave_start_m`. Errors name `control`, `channel`, `master`
  /// and `slave`, the last two where a limit of a device is no limit.
  static Result<DevicePair> make(const Params& control, const LinkParams& channel, Seconds tick,
                                 const Lengths& slave_start_m, Device& master, Device& slave);

  /// Of sites that were made elsewhere, as those of arms, with gates that somebody has chosen and that are within what
  /// the devices allow (`tightened`). Errors name `master` and `slave`: of other numbers of joints, too.
  static Result<DevicePair> around(Pair sites, Device& master, Device& slave);

  /// One tick. `request` is what the operator presses, at both sites, or, without supervision, the share of the force
  /// that is let in. Real-time safe as far as the devices are.
  Output step(const Tick& tick, const Request& request) noexcept {
    return sites_.step(*master_, *slave_, tick, request);
  }
  /// One tick of sites that want no force any more: what a loop does from its end on, tick by tick, until it is
  /// `at_rest`. The force falls at the gates' rate limits or, under supervision, as in hold. Real-time safe as far as
  /// the devices are.
  Output step_to_rest(const Tick& tick) noexcept { return step(tick, leaving()); }
  /// No site commanded a force at the latest tick.
  [[nodiscard]] bool at_rest() const noexcept { return sites_.at_rest(); }
  /// Commands no force at once, whatever it was: for an end that cannot wait. Real-time safe as far as the devices are.
  void release() noexcept {
    const auto nothing = same_for_each(joints_, DeviceCommand{.enabled = false});
    master_->write(nothing);
    slave_->write(nothing);
  }
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept { return sites_.healthy(); }
  [[nodiscard]] const Pair& sites() const noexcept { return sites_; }

 private:
  static constexpr bool supervised = std::is_same_v<Request, control::SiteRequests>;
  using Guards = std::array<std::unique_ptr<GuardedDeviceOf<Reading>>, 2>;
  DevicePair(Pair sites, Guards guards, const Lengths& joints, Device& master, Device& slave)
      : sites_(std::move(sites)),
        guards_(std::move(guards)),
        joints_(joints),
        master_(guards_[0] ? guards_[0].get() : &master),
        slave_(guards_[1] ? guards_[1].get() : &slave) {}
  static Request leaving() noexcept {
    if constexpr (supervised) {
      return {.leave = true};
    } else {
      return 0.0;
    }
  }

  Pair sites_;
  Guards guards_;   ///< before devices that are not simulated
  Lengths joints_;  ///< as many as the devices have
  Device* master_;
  Device* slave_;
};

/// With an operator who arms it and holds a dead-man switch.
using LocalTeleoperator = DevicePair<SupervisedPair>;
/// As in the papers, at work from the first tick on. For simulated devices only.
using BareTeleoperator = DevicePair<BarePair>;
/// Both with devices of several joints.
using JointLocalTeleoperator = DevicePair<JointSupervisedPair>;
using JointBareTeleoperator = DevicePair<JointBarePair>;

}  // namespace tactus::station
