// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/broadcast.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/data/telemetry/ring.hpp>
#include <tactus/interfaces/live/hand.hpp>
#include <tactus/interfaces/live/loop.hpp>
#include <tactus/interfaces/live/loops.hpp>
#include <tactus/interfaces/live/messages.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <atomic>
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
  std::array<LoopChange, loops> loop;
  std::array<std::optional<bool>, loops> runs;  ///< whether a loop runs from now on
  bool reset_hand = false;
  std::optional<ScriptedTap> tap;
};

/// What both loops did in one tick, from their thread to all that watch.
struct EngineTick {
  std::array<LoopTick, loops> loop;
  std::array<bool, loops> ran{};  ///< of each loop, whether it runs
};

/// Loops in virtual time, paced to real time.
///
/// Two threads: the loop's, which calls `run`, and that of the view, which calls all else. Between them is a broadcast
/// of each tick, one copy for the view and the log, and wait-free rings for what is asked of the loop. So the view can
/// be slow, stuck or gone: then ticks are missing in the view, and counted, and the loop is as it was. A change is made
/// on the view's thread, taken between two ticks, and what it replaced goes back there to be destroyed: the loop's
/// thread allocates and frees nothing.
class Engine {
 public:
  using Record = simulation::Teleoperator::Record;
  /// At 5 kHz it holds 0.8 s.
  using Ticks = telemetry::Broadcast<EngineTick, 4096>;

  struct Setup {
    std::array<std::unique_ptr<Loop>, loops> loop;  ///< of one tick
    std::array<bool, loops> runs{true, true};
  };
  static Result<std::unique_ptr<Engine>> make(Setup setup);
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  ~Engine();

  /// Logs every tick of both loops too, on the topics `/left/teleoperator` and `/right/teleoperator`. Before `run`.
  void log_to(telemetry::Recorder& recorder);

  /// The loop's thread: steps until `keep_going` returns false, which is asked every millisecond, and then until the
  /// forces have fallen to zero at the rate limits of their gates. Where the machine does not keep up by a tenth of a
  /// second, that time is left out: no burst follows.
  void run(const std::function<bool()>& keep_going);
  /// One tick of both loops, for who paces it otherwise. The loop's thread.
  void step() noexcept;

  /// Where the hand shall go, from rest. False where the loop has not taken the request before. View's thread.
  bool aim(const HandPoint& target) noexcept;
  /// View's thread. False, and `change` is lost, where the loop has not taken the request before.
  bool change(std::unique_ptr<Change> change);
  /// Shows every tick from now on. Before anybody asks for that, a tick is not copied. Any thread.
  [[nodiscard]] Ticks::Reader watch();

  /// What a loop did in its newest tick. The loop's thread.
  [[nodiscard]] const Record& newest(std::size_t loop) const noexcept { return tick_.loop[loop].record; }
  [[nodiscard]] double tick_s() const noexcept { return tick_s_; }

 private:
  struct Order {
    HandPoint target{};
    Change* change = nullptr;
  };

  using Hands = std::array<Hand, 3>;  ///< of a hand, one along each direction

  Engine(Setup setup, const Hands& hands);
  void take_orders() noexcept;
  /// No loop that runs commands a force.
  [[nodiscard]] bool at_rest() const noexcept;
  void apply(Change& change) noexcept;
  void destroy_returned();

  Setup setup_;
  double tick_s_;
  Hands hands_;
  EngineTick tick_;
  std::array<std::uint32_t, loops> ticks_of_{};
  std::uint64_t ticks_done_ = 0;
  double real_time_ratio_ = 1.0;
  double share_ = 1.0;  ///< of the controllers' forces; 0 at the end
  std::shared_ptr<Ticks> ticks_ = std::make_shared<Ticks>();
  std::atomic<bool> watched_{false};
  telemetry::Ring<Order, 256> orders_;
  telemetry::Ring<Change*, 512> returned_;
};

}  // namespace tactus::live
