// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/ros2/bridge.hpp>
#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/runtime/servo/real_time_streams.hpp>
#include <tactus/runtime/servo/site_log.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace tactus::ros2 {

/// What ROS 2 nodes see of a tick. The motor is commanded the opposite of the displayed force.
Snapshot snapshot_of(const station::TeleoperatorRecord& record, std::int64_t stamp_ns, OperatingState state);
/// Of one site; the values of the other are 0. A slave's command is the one that it received last.
Snapshot snapshot_of(const runtime::SiteLogRecord& record, control::SiteRole role, std::int64_t stamp_ns);
/// Of both sites on one computer, from their records of one tick.
Snapshot snapshot_of(const runtime::SiteLogRecord& master, const runtime::SiteLogRecord& slave, std::int64_t stamp_ns);

/// What must be added to a time of CLOCK_MONOTONIC for the time of day, in ns. Not real-time safe.
std::int64_t to_time_of_day_ns();

/// Publishes to ROS 2 what a run at the real clock does, and subscribes to nothing. It reads record streams on a
/// thread of its own, every millisecond, so it does not delay the servo thread.
class Observer {
 public:
  /// Opens everything for the devices and the namespace of `params`; requests are not taken. Errors: those of
  /// `Bridge::create`.
  static Result<std::unique_ptr<Observer>> create(Bridge::Params params);
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  ~Observer();  ///< finishes

  /// Publishes what goes into these streams from now on. Before `start`.
  void watch(const runtime::RealTimeStreams& streams);
  void watch(const runtime::SiteStreams& streams);
  void watch(const runtime::JointStreams& streams);

  /// Starts the thread. Errors: `failed` where the system gives none.
  Check start();
  /// Publishes what is waiting, then that the robot is disabled, and leaves. `dropped` counts records that were
  /// overwritten before they were read as well.
  Bridge::Counts finish();

 private:
  /// Reads one record, or nothing; the number of lost records is written to `lost`.
  using Source = std::function<bool(Bridge& bridge, std::uint64_t& lost)>;

  explicit Observer(Bridge bridge) : bridge_(std::move(bridge)) {}
  void run() noexcept;
  void tell_all();

  Bridge bridge_;
  std::vector<Source> sources_;
  std::vector<std::uint64_t> lost_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace tactus::ros2
