// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/shared_device.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/plant_segment.hpp>
#include <tactus/simulation/real_time/simulated_plant.hpp>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace tactus::real_time {

/// How a plant went so far.
struct PlantStatus {
  std::uint64_t readings = 0;                                 ///< sent
  std::uint64_t commands = 0;                                 ///< received from controllers
  std::int64_t missed = 0;                                    ///< ticks
  std::int64_t taps = 0;                                      ///< begun
  std::int64_t released = 0;                                  ///< taps in which a device released its force
  station::ReleaseCause cause = station::ReleaseCause::none;  ///< of the last of them
  std::int64_t held_back = 0;                                 ///< commands that were beyond what a device may
  bool cut = false;  ///< another process has cut the shared memory: nobody can drive any more
  std::optional<std::int64_t> controller;
};

/// The owner's side of a plant: simulated devices in real time, on a servo thread, for a controller in another process.
///
/// A tap begins with the first command after the controller has requested it; until then the plant waits at the start.
/// While ticks are missed, it continues with the last command, as hardware does. Without a controller it does not move;
/// if the controller times out, or requests what the devices cannot give, it continues without a force.
class PlantServer {
 public:
  /// `silence` is how long commands may stay away. Errors: those of the experiment and of `PlantSegment::create`;
  /// `out_of_bounds` for `silence`.
  static Result<std::unique_ptr<PlantServer>> make(const std::string& name, const experiments::TappingParams& params,
                                                   Seconds silence);
  PlantServer(const PlantServer&) = delete;
  PlantServer& operator=(const PlantServer&) = delete;

  /// One tick, on the servo thread. Real-time safe.
  void step(const station::Tick& tick) noexcept;
  /// Makes the devices of a tap that was asked for. On another thread, always the same one, every few ms; it allocates.
  void serve();
  /// Any thread. Not real-time safe.
  [[nodiscard]] PlantStatus status() const;

 private:
  PlantServer(experiments::TappingEnsemble ensemble, const SimulatedPlant& first, PlantSegment segment,
              Seconds silence);
  void begin(const PlantRequest& request) noexcept;
  void read() noexcept;

  experiments::TappingEnsemble ensemble_;
  std::array<SimulatedPlant, 2> plants_;  ///< one runs, the other is made
  PlantSegment segment_;
  Seconds silence_;
  runtime::DeviceServer master_;
  runtime::DeviceServer slave_;
  station::DeviceReading master_reading_;
  station::DeviceReading slave_reading_;
  std::size_t current_ = 0;             ///< written by the servo thread, while `made_` is not 0
  std::atomic<std::uint64_t> made_{0};  ///< session that the other plant was made for; 0 once it is taken
  std::uint64_t served_ = 0;            ///< session that was made last
  std::uint64_t session_ = 0;
  bool running_ = false;
  std::int64_t start_tick_ = 0;
  std::atomic<std::int64_t> missed_{0}, taps_{0}, released_{0}, held_back_{0};
  std::atomic<station::ReleaseCause> cause_{station::ReleaseCause::none};
};

}  // namespace tactus::real_time
