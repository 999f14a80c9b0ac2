// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_tap_run.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace tactus::real_time {

/// Where taps of two simulated arms in real time go while they run: both sites, and what both tools did.
class ArmTapStreams : public runtime::JointStreams {
 public:
  explicit ArmTapStreams(std::size_t joints) : runtime::JointStreams(joints), tools_(std::make_shared<Tools>()) {}

  /// What the tools did in the tick that began then, in ns of CLOCK_MONOTONIC. One thread only. Real-time safe.
  void push_tools(std::int64_t began_ns, const experiments::ArmRecord& record) noexcept {
    tools_->push(static_cast<std::uint64_t>(began_ns - origin_ns()), record);
  }
  /// As `JointStreams::for_each`, and `/tools`.
  template <class Visit>
  void for_each(const Visit& visit) const {
    runtime::JointStreams::for_each(visit);
    visit(std::string("/tools"), "tactus_msgs/msg/ToolsRecord", *tools_);
  }

 private:
  using Tools = telemetry::RecordStream<experiments::ArmRecord>;
  std::shared_ptr<Tools> tools_;
};

/// One tap through two simulated arms in real time: the step of a servo thread. With no tick missed, the records are
/// bit for bit those of virtual time. Arms that are simulated need not be put down: with the tap they end.
class RealTimeArmTap {
 public:
  /// Of a setup, a tap and streams that outlive it; without streams it leaves nothing. Errors: those of
  /// `ArmTapRun::make`.
  static Result<RealTimeArmTap> make(const experiments::ArmPairSetup& setup, const experiments::ArmTap& tap,
                                     ArmTapStreams* streams = nullptr);

  /// One tick, the sites first, then the arms. At ticks that were missed before it, the arms continue under the
  /// commands that their drives have. False once the tap is over. Real-time safe.
  bool step(const station::Tick& tick) noexcept;
  [[nodiscard]] const experiments::ArmTapRun& run() const noexcept { return run_; }

 private:
  RealTimeArmTap(experiments::ArmTapRun run, ArmTapStreams* streams);
  void step_arms(std::int64_t began_ns) noexcept;

  experiments::ArmTapRun run_;
  ArmTapStreams* streams_;
  std::int64_t period_ns_;
  std::int64_t first_tick_ = -1;
};

}  // namespace tactus::real_time
