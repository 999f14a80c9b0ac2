// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig_loop.hpp>
#include <tactus/kernel/station/device_guard.hpp>
#include <tactus/runtime/servo/site_link.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

#include <memory>
#include <optional>

namespace tactus::devices {

/// One site of several joints, of either role.
using JointSite = runtime::JointSupervisedSite;

/// Whether the slave of these parameters reports where its motors are, so that its master can see how far it is.
bool tells_its_place(const Joints<control::ControlParams>& control, Seconds tick);

/// One side of a pair on this computer, the other side being elsewhere: the link, a supervised site of several joints
/// and its motors. The step of a servo thread. Does not allocate, lock or block, as far as the device does not.
///
/// It arms as `RigLoop` does. No motor has power until somebody arms at the leader's; that has no effect while the
/// follower reports a joint that is farther from its leader than it may be, does not respond, or works by other
/// parameters. The leader then holds still and arms; the follower detects that, holds still and follows the arming, but
/// not from a place that is farther from where it is commanded to be than it may be.
class RigSiteLoop {
 public:
  struct Params {
    RigLoop::Params pair;
    /// Of each joint: at the leader how far the follower goes for what it goes; 1 at the follower.
    Joints<double> scales;
    double longest_age_s = 0.0;  ///< of packets, as the site's supervision has it
    double timeout_s = 0.0;      ///< of its watchdog
  };
  /// What outlives it: the exchange and the device. `endpoint` is that whose session the site has. `control` is of
  /// joints that are driven each by itself, for the guard before the device; without it whoever made the site answers
  /// for its gates. `motors` compares an arm's motors with what they are commanded. Errors: those of
  /// `make_device_guard`; `inconsistent` for other numbers of joints.
  static Result<RigSiteLoop> make(JointSite site, link::JointEndpoint endpoint, Seconds tick, const Params& params,
                                  runtime::SiteExchange& exchange, MotorBusDevice& device,
                                  const std::optional<Joints<control::ControlParams>>& control,
                                  const std::optional<arm_control::MotorWatch>& motors = std::nullopt);

  /// Every tick from now on goes there too. Before the first tick.
  void leave_in(runtime::JointStreams& streams) { streams_ = &streams; }
  /// One tick; false once the site was to end and has no force any more.
  bool operator()(const station::Tick& tick) noexcept;
  /// After the last tick.
  [[nodiscard]] const RigTotals& totals() const noexcept { return totals_; }
  /// The second that had begun, as it was when the sites were to end: what an arm does that is released then is no
  /// fault of the run. After the last tick.
  [[nodiscard]] const RigSecond& last() const noexcept { return at_end_ ? *at_end_ : second_; }
  [[nodiscard]] runtime::LinkTotals link_totals() const { return link_.totals(); }
  /// The seconds that ended, as they end; of the other side its state as it reports it, and no more. One other thread.
  [[nodiscard]] std::optional<RigSecond> next_second() noexcept { return next_of(*shared_); }

 private:
  RigSiteLoop(JointSite site, link::JointEndpoint endpoint, Seconds tick, const Params& params,
              runtime::SiteExchange& exchange, MotorBusDevice& device, std::unique_ptr<station::WatchedArm> watched,
              std::unique_ptr<station::GuardedJointDevice> guard);
  [[nodiscard]] bool leads() const noexcept { return site_.index() == 0; }
  [[nodiscard]] bool may_align() const noexcept;
  [[nodiscard]] control::SiteRequests asked(const control::SiteRequests& pressed) noexcept;
  void judge_distance() noexcept;
  template <class Site>
  void step(Site& site, const station::Tick& tick, const control::SiteRequests& pressed) noexcept;
  void end_second() noexcept;

  runtime::SiteConsole console_;
  Params params_;
  JointSite site_;
  runtime::JointSiteLink link_;
  MotorBusDevice* device_;
  std::unique_ptr<station::WatchedArm> watched_;        ///< before the device; or none
  std::unique_ptr<station::GuardedJointDevice> guard_;  ///< before the device
  station::JointDevice* driven_;                        ///< the guard
  runtime::JointStreams* streams_ = nullptr;
  std::shared_ptr<RigSeconds> shared_ = std::make_shared<RigSeconds>();
  Joints<station::DeviceReading> read_;
  Joints<double> told_;  ///< places, by the other site
  control::SiteState own_ = control::SiteState::configure, other_ = control::SiteState::configure;
  std::optional<RigSecond> at_end_;
  RigSecond second_;
  RigTotals totals_;
  bool seen_ = false;       ///< the device was read
  bool arming_ = false;     ///< asked for where the site had not been aligned yet
  bool disagrees_ = false;  ///< the other site works by other parameters
  bool gives_force_ = false;
};

}  // namespace tactus::devices
