// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/runtime/servo/shared_device.hpp>
#include <tactus/runtime/servo/shared_mapping.hpp>
#include <tactus/runtime/servo/shared_slots.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

/// The shared memory of a plant that a process of its own owns: what lies in it, and who may be in it.
namespace tactus::real_time {

/// What happened in one tick of a simulated plant and no sensor measures: for metrics, never for a site.
struct SimulatedTruth {
  std::int64_t tick = 0;             ///< of the plant since its start: this one has ended; 0 is the start itself
  double tip_position_m = 0.0;       ///< of the slave, when the tick ended
  double contact_sum_N = 0.0;        ///< of the force on the wall over the substeps of the tick
  double contact_peak_N = 0.0;       ///< of the largest substep
  std::int64_t touched = 0;          ///< 1: the tip met the wall in the tick
  std::int64_t touched_substep = 0;  ///< in which substep first
  double touched_after_s = 0.0;      ///< when, from the begin of that substep
};

/// What a plant states about itself once.
struct PlantFacts {
  station::DeviceLimits master;
  station::DeviceLimits slave;
  bool simulated = false;     ///< false: hardware
  std::int64_t taps = 0;      ///< that it can be asked for; 0 for hardware, which cannot be put back to a start
  std::string configuration;  ///< TOML of all that makes the plant what it is
};

/// A tap that a controller asks for. The number of the request is the session of its commands.
struct PlantRequest {
  std::uint64_t session = 0;       ///< never the same twice; 0: none was made yet
  std::optional<std::size_t> tap;  ///< none: nobody drives the plant
};

/// The layout, in memory of zeros. Numbers of 8 bytes only, so that it is the same for every compiler of one machine.
struct PlantLayout {
  static constexpr std::size_t configuration_bytes = 32768;
  static constexpr std::uint64_t truth_ticks = 16384;  ///< that a controller may fall behind

  std::atomic<std::uint64_t> magic;       ///< written last: from then on the facts are complete
  std::atomic<std::uint64_t> owner;       ///< process
  std::atomic<std::uint64_t> controller;  ///< process; 0 once it has left in good order
  station::DeviceLimits master_limits;
  station::DeviceLimits slave_limits;
  std::int64_t simulated;
  std::int64_t taps;
  std::uint64_t configuration_length;
  std::array<char, configuration_bytes> configuration;
  std::atomic<std::uint64_t> request;  ///< controller to owner: session · 2^16 + tap + 1, or + 0 for no tap
  std::atomic<std::uint64_t> answer;   ///< owner to controller: the request that the readings belong to
  runtime::DeviceSlots master;
  runtime::DeviceSlots slave;
  runtime::SharedSlots<SimulatedTruth, truth_ticks> simulated_truth;
};
static_assert(std::is_standard_layout_v<PlantLayout> && std::is_trivially_destructible_v<PlantLayout>,
              "it is mapped, not made");

/// A mapped segment, as its owner or as its one controller; unmapped, and by its owner removed, at the end.
///
/// Locks on its file (open file description locks) show who uses it. The kernel takes them back from a process
/// however it ends: a segment whose owner is dead is known as such, and a reused process number misleads nobody. Of the
/// same user only, and of mode 0600: what another user made, or others can write, is refused before it is mapped. A
/// process of the same user can still cut the file short; both sides survive that and notice it
/// (`SharedMapping`). Nothing here is real-time safe but `operator->`, `is_cut` and `request`.
class PlantSegment {
 public:
  /// As the owner. A segment of that name whose owner is dead is replaced; for its controller it has timed out.
  ///
  /// Errors: `syntax` for a name that is not 1 to 64 letters, digits, `-` or `_`; `inconsistent` where a living process
  /// owns it, another user has a file of that name, or a configuration is too long; `failed` where the system gives no
  /// shared memory.
  static Result<PlantSegment> create(const std::string& name, const PlantFacts& facts);

  /// As the controller.
  ///
  /// Errors: `syntax` as above; `missing` if no segment has that name, or its owner is dead; `inconsistent` where
  /// it is of another user or open to others, of another version, or has a controller; `failed` where the system does
  /// not let it be mapped.
  static Result<PlantSegment> attach(const std::string& name);

  PlantSegment(PlantSegment&& other) noexcept
      : name_(std::move(other.name_)),
        file_(std::exchange(other.file_, -1)),
        memory_(std::move(other.memory_)),
        layout_(other.layout_),
        owner_(other.owner_) {}
  PlantSegment& operator=(PlantSegment&&) = delete;
  ~PlantSegment();

  PlantLayout* operator->() const noexcept { return layout_; }
  /// Another process has cut the file: nobody is reached any more, and all of it reads as zeros. Real-time safe.
  [[nodiscard]] bool is_cut() const noexcept { return memory_.is_cut(); }
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] PlantFacts facts() const;
  /// The process that owns it, where that lives.
  [[nodiscard]] std::optional<std::int64_t> living_owner() const;
  /// The process that drives it, where that lives.
  [[nodiscard]] std::optional<std::int64_t> living_controller() const;

  /// What the controller asked for last. Real-time safe.
  [[nodiscard]] PlantRequest request() const noexcept;
  /// Controller: asks, and returns the session.
  std::uint64_t ask(std::optional<std::size_t> tap) noexcept;

 private:
  PlantSegment(std::string name, int file, runtime::SharedMapping memory, bool owner)
      : name_(std::move(name)),
        file_(file),
        memory_(std::move(memory)),
        layout_(static_cast<PlantLayout*>(memory_.data())),
        owner_(owner) {}

  std::string name_;
  int file_;
  runtime::SharedMapping memory_;
  PlantLayout* layout_;
  bool owner_;
};

}  // namespace tactus::real_time
