#pragma once

#include <tactus/runtime/local_teleoperator.hpp>
#include <tactus/runtime/servo_record.hpp>
#include <tactus/runtime/simulated_devices.hpp>
#include <tactus/runtime/sites_record.hpp>
#include <tactus/simulation/tap_observer.hpp>
#include <tactus/telemetry/recorder.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace tactus::runtime {

/// Where a run in real time goes while it runs.
struct RealTimeStreams {
  using Teleoperator = telemetry::RecordStream<simulation::Teleoperator::Record>;
  using Servo = telemetry::RecordStream<ServoRecord>;
  using Sites = telemetry::RecordStream<SitesRecord>;
  Teleoperator* teleoperator = nullptr;
  Servo* servo = nullptr;
  Sites* sites = nullptr;      ///< what `replay` needs
  std::int64_t tap = 0;        ///< number of the tap, for the log
  std::int64_t origin_ns = 0;  ///< of the times in the log, on CLOCK_MONOTONIC
};

/// One tap through simulated devices in real time: the step of a servo thread. It owns both devices.
///
/// The record of a tick is complete when the plants have been advanced to the next. Ticks that were missed have a
/// record too, with the readings and commands that held. With none missed, the records are bit for bit those of virtual
/// time.
class RealTimeTap {
 public:
  /// Errors: those of plants and sites.
  static Result<std::unique_ptr<RealTimeTap>> make(const simulation::Tap& tap, double observation_s,
                                                   const RealTimeStreams& streams = {});
  RealTimeTap(const RealTimeTap&) = delete;
  RealTimeTap& operator=(const RealTimeTap&) = delete;

  /// One tick; false once the tap is over. Real-time safe.
  bool step(const Tick& tick) noexcept;

  [[nodiscard]] simulation::TapResult result() const { return observer_.result(); }
  /// Every tick.
  [[nodiscard]] const std::vector<simulation::Teleoperator::Record>& trace() const { return trace_; }

 private:
  RealTimeTap(const simulation::Tap& tap, double observation_s, const RealTimeStreams& streams,
              const simulation::Clock& clock, const simulation::MasterPlant& master,
              const simulation::SlavePlant& slave);
  /// Ends the open record with what the plants did, and hands it on; false once the tap is over.
  bool complete() noexcept;

  simulation::Clock clock_;
  SimulatedMaster master_;
  SimulatedSlave slave_;
  std::unique_ptr<LocalTeleoperator> loop_;
  simulation::TapObserver observer_;
  RealTimeStreams streams_;
  simulation::Teleoperator::Record record_;
  std::vector<simulation::Teleoperator::Record> trace_;
  std::int64_t first_tick_ = -1;
  std::int64_t start_ns_ = 0;  ///< of the first tick, after the origin
};

}  // namespace tactus::runtime
