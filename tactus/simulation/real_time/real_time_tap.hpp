// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/real_time_streams.hpp>
#include <tactus/simulation/experiments/tapping/tap_observer.hpp>
#include <tactus/simulation/real_time/simulated_plant.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tactus::real_time {

/// One tap through simulated devices in real time: the step of a servo thread. When the tap is over, or was ended from
/// outside, the sites release at the rate limits of their gates; these ticks are no part of the tap and have no record.
///
/// The record of a tick is complete when the plant has advanced to the next. Ticks that were missed have a record too,
/// with the readings and commands that held. With devices of its own and none missed, the records are bit for bit those
/// of virtual time.
class RealTimeTap {
 public:
  /// With devices of its own. Errors: those of plants and sites.
  static Result<std::unique_ptr<RealTimeTap>> make(const experiments::Tap& tap, double observation_s,
                                                   const runtime::RealTimeStreams& streams = {});
  /// Through a plant that outlives it and is at the start of the tap. If the plant is lost, the sites release at
  /// the rate limit and the tap is over. Errors: those of the sites.
  static Result<std::unique_ptr<RealTimeTap>> make(const experiments::Tap& tap, double observation_s, TapPlant& plant,
                                                   const runtime::RealTimeStreams& streams = {});
  RealTimeTap(const RealTimeTap&) = delete;
  RealTimeTap& operator=(const RealTimeTap&) = delete;

  /// One tick; false once the tap is over and no site commands a force. Real-time safe.
  bool step(const station::Tick& tick) noexcept;
  /// From the next tick on the sites release. For the thread that steps. Real-time safe.
  void end() noexcept { over_ = true; }
  /// No force at once, as the last thing. Of the thread that steps. Real-time safe.
  void release() noexcept { loop_.release(); }

  [[nodiscard]] experiments::TapResult result() const { return observer_.result(); }
  /// Every tick.
  [[nodiscard]] const std::vector<simulation::Teleoperator::Record>& trace() const { return trace_; }

 private:
  RealTimeTap(const experiments::Tap& tap, double observation_s, const runtime::RealTimeStreams& streams,
              const simulation::Clock& clock, TapPlant& plant, station::BareTeleoperator loop);
  /// Ends the open record with what the plant did, and hands it on; false once the tap is over.
  bool complete(const SimulatedTruth& truth) noexcept;
  /// One tick of the ramp to zero force; false at its end.
  bool step_to_rest(const station::Tick& own) noexcept;

  simulation::Clock clock_;
  std::unique_ptr<SimulatedPlant> own_;
  TapPlant* plant_;
  station::BareTeleoperator loop_;
  experiments::TapObserver observer_;
  runtime::RealTimeStreams streams_;
  simulation::Teleoperator::Record record_;
  std::vector<simulation::Teleoperator::Record> trace_;
  std::int64_t first_tick_ = -1;
  std::int64_t plant_ticks_ = 0;
  bool over_ = false;
  double letting_go_s_ = 0.0;
  std::int64_t start_ns_ = 0;  ///< of the first tick, after the origin
};

}  // namespace tactus::real_time
