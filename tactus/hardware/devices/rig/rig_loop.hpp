// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/devices/rig/rig_second.hpp>
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/kernel/station/watched_arm.hpp>
#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/runtime/servo/site_console.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace tactus::devices {

/// A leader and a follower of several joints on one computer, supervised: the step of a servo thread. No motor has
/// power until somebody arms, and nobody can while a joint of the follower is farther from its leader than it may be;
/// an arming that comes before the first readings waits for them, for a second at most.
/// Then both hold still, test the sign of each motor, the coupling comes in over `blend_s`, and the follower goes to
/// where its leader is at no more than `silence.catch_up_m_per_s`. Does not allocate, lock or block, as far as the
/// devices do not.
class RigLoop {
 public:
  struct Params {
    double farthest = 0.3;                ///< rad or m, of each joint: beyond it nobody can arm
    double listen_before_arming_s = 0.0;  ///< as `SiteConsole`: as long as the watchdog waits
    double duration_s = 0.0;
    bool arm_at_once = false;
  };
  /// What outlives it: the exchange, and the devices.
  static Result<RigLoop> make(const Joints<control::ControlParams>& control, const station::LinkParams& channel,
                              Seconds tick, const Params& params, runtime::SiteExchange& exchange,
                              MotorBusDevice& leader, MotorBusDevice& follower);

  /// The motors of two arms, each compared with what it is commanded.
  struct Watches {
    arm_control::MotorWatch leader, follower;
  };
  /// The same with sites that were made elsewhere, as those of arms (`arm_sites`): their joints are scaled by none.
  static Result<RigLoop> around(station::JointSupervisedPair sites, Seconds tick, const Params& params,
                                runtime::SiteExchange& exchange, MotorBusDevice& leader, MotorBusDevice& follower,
                                const std::optional<Watches>& watches = std::nullopt);

  /// Every tick from now on goes there too. Before the first tick.
  void leave_in(runtime::JointStreams& streams) { streams_ = &streams; }
  /// One tick; false once the sites were to end and have no force any more.
  bool operator()(const station::Tick& tick) noexcept;
  /// To look at, between ticks.
  [[nodiscard]] const station::JointSupervisedPair& sites() const noexcept { return pair_.sites(); }
  /// After the last tick.
  [[nodiscard]] const RigTotals& totals() const noexcept { return totals_; }
  /// The second that had begun, as it was when the sites were to end: what an arm does that is released then is no
  /// fault of the run. After the last tick.
  [[nodiscard]] const RigSecond& last() const noexcept { return at_end_ ? *at_end_ : second_; }
  /// The seconds that ended, as they end. One other thread.
  [[nodiscard]] std::optional<RigSecond> next_second() noexcept { return next_of(*shared_); }

 private:
  RigLoop(Seconds tick, const Params& params, runtime::SiteExchange& exchange, MotorBusDevice& leader,
          MotorBusDevice& follower, const Joints<double>& scales, station::JointLocalTeleoperator pair);
  [[nodiscard]] bool arms(const control::SiteRequests& pressed) noexcept;
  [[nodiscard]] control::SiteRequests asked(const control::SiteRequests& pressed) noexcept;
  void judge_distance() noexcept;
  void note_troubles() noexcept;
  void note_fault() noexcept;
  void look_at_tares(const station::Tick& tick) noexcept;
  void keep_books(const station::JointLocalTeleoperator::Output& done) noexcept;

  runtime::SiteConsole console_;
  Params params_;
  MotorBusDevice *leader_, *follower_;
  std::unique_ptr<station::WatchedArm> watched_leader_, watched_follower_;  ///< in front of these; or none
  Joints<double> scales_;
  station::JointLocalTeleoperator pair_;
  runtime::JointStreams* streams_ = nullptr;
  std::shared_ptr<RigSeconds> shared_ = std::make_shared<RigSeconds>();
  Joints<station::DeviceReading> leader_read_, follower_read_;
  std::optional<RigSecond> at_end_;
  RigSecond second_;
  RigTotals totals_;
  double arm_until_s_ = 0.0;  ///< how long an arming waits for the first readings
  bool read_once_ = false;    ///< both were, at some cycle
  bool seen_ = false;         ///< both were read
  bool active_ = false;       ///< the follower, at the tick before
  bool arming_ = false;       ///< asked for where they had not been aligned yet
  bool refused_ = false;      ///< because an arm is heavier than its motors may carry
};

}  // namespace tactus::devices
