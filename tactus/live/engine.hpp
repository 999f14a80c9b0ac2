#pragma once

#include <tactus/core/result.hpp>
#include <tactus/live/hand.hpp>
#include <tactus/live/messages.hpp>
#include <tactus/simulation/teleoperator.hpp>
#include <tactus/telemetry/recorder.hpp>
#include <tactus/telemetry/ring.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace tactus::live {

/// Two loops side by side, both driven by the same hand.
inline constexpr std::size_t loops = 2;
inline constexpr std::array<const char*, loops> loop_names{"left", "right"};

/// What changes between two ticks, made beforehand on the thread that asks for it.
struct Change {
  struct Loop {
    std::optional<simulation::Teleoperator> made;
    /// Parts of `made` to go on with; none where the loop starts over as `made`.
    std::optional<simulation::Teleoperator::Parts> parts;
  };
  std::array<Loop, loops> loop;
  std::array<std::optional<bool>, loops> runs;  ///< whether a loop runs from now on
  bool reset_hand = false;
  std::optional<ScriptedTap> tap;
};

/// Teleoperators in virtual time, paced to real time.
///
/// Two threads: the loop's, which calls `run`, and that of the view, which calls all else. Between them are wait-free
/// rings, so the view can be slow, stuck or gone: then ticks are missing in the view, and counted, and the loop is as
/// it was. A change is made on the view's thread, taken between two ticks, and what it replaced goes back there to be
/// destroyed: the loop's thread allocates and frees nothing.
class Engine {
 public:
  using Record = simulation::Teleoperator::Record;

  struct Setup {
    std::array<simulation::Teleoperator, loops> teleoperators;
    std::array<bool, loops> runs{true, true};
    double wall_m = 0.01;                 ///< of the environment, as the master's hand sees it
    std::array<double, loops> reach_m{};  ///< a device farther than this from its origin has left its workspace
  };
  static Result<std::unique_ptr<Engine>> make(Setup setup);
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  ~Engine();

  /// Logs every tick of both loops too, on the topics `/left/teleoperator` and `/right/teleoperator`. Before `run`; the
  /// recorder must outlive the engine.
  void log_to(telemetry::Recorder& recorder);

  /// The loop's thread: steps until `keep_going` returns false, which is asked every millisecond. Where the machine
  /// does not keep up by a tenth of a second, that time is left out: no burst follows.
  void run(const std::function<bool()>& keep_going);
  /// One tick of both loops, for who paces it otherwise. The loop's thread.
  void step() noexcept;

  /// Where the hand shall go, in m from rest. False where the loop has not taken what was said before. View's thread.
  bool aim(double target_m) noexcept;
  /// View's thread. False, and `change` is lost, where the loop has not taken what was said before.
  bool change(std::unique_ptr<Change> change);
  /// The next tick of a loop, if there is one. View's thread.
  bool next(std::size_t loop, LoopTick& tick) noexcept { return ticks_[loop].try_pop(tick); }
  /// Ticks that found the view behind. Any thread.
  [[nodiscard]] std::uint64_t dropped(std::size_t loop) const noexcept { return ticks_[loop].dropped(); }

  /// What a loop did in its newest tick. The loop's thread.
  [[nodiscard]] const Record& newest(std::size_t loop) const noexcept { return records_[loop]; }
  [[nodiscard]] double tick_s() const noexcept { return tick_s_; }
  [[nodiscard]] double wall_m() const noexcept { return setup_.wall_m; }

 private:
  struct Order {
    double target_m = 0.0;
    Change* change = nullptr;
  };
  using Stream = telemetry::RecordStream<Record>;

  Engine(Setup setup, const Hand& hand);
  void take_orders() noexcept;
  void apply(Change& change) noexcept;
  void destroy_returned();

  Setup setup_;
  double tick_s_;
  Hand hand_;
  std::array<Record, loops> records_;
  std::array<bool, loops> stopped_{};
  std::array<std::uint32_t, loops> starts_{};
  std::array<Stream*, loops> log_{};
  std::uint64_t ticks_done_ = 0;
  double real_time_ratio_ = 1.0;
  std::array<telemetry::Ring<LoopTick, 4096>, loops> ticks_;
  telemetry::Ring<Order, 256> orders_;
  telemetry::Ring<Change*, 512> returned_;
};

}  // namespace tactus::live
