#pragma once

#include <tactus/control/architecture.hpp>
#include <tactus/devices/motor_bus_device.hpp>
#include <tactus/runtime/joint_streams.hpp>
#include <tactus/runtime/site_console.hpp>
#include <tactus/station/local_teleoperator.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace tactus::devices {

/// One second of a pair, for the display. States and causes are those of its end.
struct RigSecond {
  double time_s = 0.0;
  control::SiteState leader = control::SiteState::configure, follower = control::SiteState::configure;
  control::SiteCause cause =
      control::SiteCause::started;  ///< of the leader, or of the follower where that stopped by itself
  station::DeviceHealth leader_health = station::DeviceHealth::good, follower_health = station::DeviceHealth::good;
  DeviceTrouble leader_trouble, follower_trouble;       ///< the worst of the second, or since they stand
  control::GateFault fault = control::GateFault::none;  ///< what a gate latched, of the leader first
  bool fault_of_leader = false;
  std::size_t fault_joint = 0;
  double most_torque = 0.0;  ///< of any motor of the second, either way
  double farthest = 0.0;     ///< of a joint from its leader
  std::size_t joint = 0;     ///< which one
  bool too_far = false;      ///< so that nobody can arm
};

/// What a pair went through.
struct RigTotals {
  double duration_s = 0.0;
  std::int64_t ticks = 0, active_ticks = 0, armings = 0, holds = 0;
  std::int64_t late_ticks = 0, silent_ticks = 0, lost_ticks = 0;  ///< of the worse device
};

/// A leader and a follower of several joints on one computer, supervised: the step of a servo thread. No motor has
/// power until somebody arms, and nobody can while a joint of the follower is farther from its leader than it may be.
/// Then both stand, try the sign of each motor, the coupling comes in over `blend_s`, and the follower goes to where
/// its leader is at no more than `silence.catch_up_m_per_s`. Does not allocate, lock or block, as far as the devices do
/// not.
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

  /// The same with sites that were made elsewhere, as those of arms (`arm_sites`): their joints are scaled by none.
  static Result<RigLoop> around(station::JointSupervisedPair sites, Seconds tick, const Params& params,
                                runtime::SiteExchange& exchange, MotorBusDevice& leader, MotorBusDevice& follower);

  /// Every tick from now on goes there too. Before the first tick.
  void leave_in(runtime::JointStreams& streams) { streams_ = &streams; }
  /// One tick; false once the sites were to end and have no force any more.
  bool operator()(const station::Tick& tick) noexcept;
  /// After the last tick.
  [[nodiscard]] const RigTotals& totals() const noexcept { return totals_; }
  /// The seconds that ended, as they end. One other thread.
  [[nodiscard]] std::optional<RigSecond> next_second() noexcept;

 private:
  struct Shared {
    telemetry::Ring<RigSecond, 64> seconds;
  };
  RigLoop(Seconds tick, const Params& params, runtime::SiteExchange& exchange, MotorBusDevice& leader,
          MotorBusDevice& follower, const Joints<double>& scales, station::JointLocalTeleoperator pair);
  [[nodiscard]] control::SiteRequests asked(const control::SiteRequests& pressed) noexcept;
  void judge_distance() noexcept;
  void note_troubles() noexcept;
  void note_fault() noexcept;
  void keep_books(const station::JointLocalTeleoperator::Output& done) noexcept;

  runtime::SiteConsole console_;
  Params params_;
  MotorBusDevice *leader_, *follower_;
  Joints<double> scales_;
  station::JointLocalTeleoperator pair_;
  runtime::JointStreams* streams_ = nullptr;
  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
  Joints<station::DeviceReading> leader_read_, follower_read_;
  RigSecond second_;
  RigTotals totals_;
  bool seen_ = false;    ///< both were read
  bool active_ = false;  ///< the follower, at the tick before
  bool arming_ = false;  ///< asked for where they had not been aligned yet
};

}  // namespace tactus::devices
