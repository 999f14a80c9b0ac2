// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/real_time/plant_segment.hpp>
#include <tactus/simulation/real_time/simulated_plant.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace tactus::real_time {

/// The controller's side of a plant that another process owns: both devices, and the simulated truth alongside them.
class SharedPlant final : public TapPlant {
 public:
  /// Takes the controller's place. `silence` is the longest that the owner may not respond. Errors: those of
  /// `PlantSegment::attach`; `out_of_bounds` for `silence`.
  static Result<std::unique_ptr<SharedPlant>> attach(const std::string& name, Seconds silence);
  SharedPlant(const SharedPlant&) = delete;
  SharedPlant& operator=(const SharedPlant&) = delete;
  /// Leaves: the owner applies no force from its next tick on.
  ~SharedPlant() override;

  /// That the plant is the one that the experiment describes, and has its taps. Errors: `inconsistent`, with the first
  /// key that differs.
  [[nodiscard]] Check check(const experiments::TappingParams& params) const;

  /// Asks for the start of a tap and waits for the answer. The plant is there until the first command. Not while a
  /// servo thread reads. Errors: `failed` where none comes.
  Check begin(std::size_t tap);
  /// The tap is over: the owner applies no force, and is not to take silence for a fault.
  void end() noexcept;

  runtime::SharedDevice& master() noexcept override { return master_; }
  runtime::SharedDevice& slave() noexcept override { return slave_; }
  std::optional<SimulatedTruth> next(const station::Tick& tick) noexcept override;
  [[nodiscard]] double tip_position_m() const noexcept override { return tip_position_m_; }
  [[nodiscard]] bool lost() const noexcept override;
  /// In words, for a plant that is lost.
  [[nodiscard]] Error why_lost() const;

 private:
  SharedPlant(PlantSegment segment, Seconds silence);

  PlantSegment segment_;
  Seconds silence_;
  runtime::SharedDevice master_;
  runtime::SharedDevice slave_;
  std::uint64_t next_truth_ = 0;
  double tip_position_m_ = 0.0;
  bool fell_behind_ = false;  ///< the truth was overwritten before it was read
};

}  // namespace tactus::real_time
