// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/engine.hpp>

#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <tuple>
#include <utility>

namespace tactus::live {

namespace {

/// One loop's ticks on their way to a log. The number of a tick is its place in the sequence.
class LoopStream final : public telemetry::Stream {
 public:
  LoopStream(Engine::Ticks::Reader ticks, std::size_t loop, std::uint16_t channel)
      : ticks_(std::move(ticks)), loop_(loop), channel_(channel) {}

  void drain(telemetry::LogWriter& log) override {
    EngineTick tick;
    while (ticks_.next(tick)) {
      const LoopTick& own = tick.loop[loop_];
      if (!tick.ran[loop_]) continue;
      dropped_.fetch_add(own.number - next_, std::memory_order_relaxed);
      next_ = own.number + 1;
      log.write(channel_, own.number, own.time_ns, telemetry::to_cdr(own.record));
    }
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept override { return dropped_.load(std::memory_order_relaxed); }

 private:
  Engine::Ticks::Reader ticks_;
  std::size_t loop_;
  std::uint16_t channel_;
  std::uint32_t next_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace

Result<std::unique_ptr<Engine>> Engine::make(Setup setup) {
  const Seconds tick{setup.loop[0]->tick_s()};
  const auto toward = Hand::make(tick);
  if (!toward) return toward.error();
  const auto across = Hand::make(tick, Hand::fastest_across_m_per_s);
  if (!across) return across.error();
  return std::unique_ptr<Engine>(new Engine(std::move(setup), {*toward, *across, *across}));
}

Engine::Engine(Setup setup, const Hands& hands)
    : setup_(std::move(setup)), tick_s_(setup_.loop[0]->tick_s()), hands_(hands) {}

Engine::~Engine() {
  Order order;
  while (orders_.try_pop(order)) delete order.change;
  destroy_returned();
}

void Engine::log_to(telemetry::Recorder& recorder) {
  for (std::size_t i = 0; i < loops; ++i) {
    recorder.add({.topic = std::string("/") + loop_names[i] + "/teleoperator",
                  .type_name = "tactus_msgs/msg/TeleoperatorRecord",
                  .columns = telemetry::columns_of<Record>()},
                 [&](std::uint16_t channel) { return std::make_unique<LoopStream>(watch(), i, channel); });
  }
}

Engine::Ticks::Reader Engine::watch() {
  watched_.store(true, std::memory_order_relaxed);
  return Ticks::Reader(ticks_);
}

bool Engine::aim(const HandPoint& target) noexcept { return orders_.try_push({.target = target}); }

bool Engine::change(std::unique_ptr<Change> change) {
  destroy_returned();
  if (!orders_.try_push({.change = change.get()})) return false;
  static_cast<void>(change.release());
  return true;
}

void Engine::destroy_returned() {
  Change* change = nullptr;
  while (returned_.try_pop(change)) delete change;
}

void Engine::take_orders() noexcept {
  Order order;
  while (orders_.try_pop(order)) {
    if (order.change == nullptr) {
      for (std::size_t i = 0; i < hands_.size(); ++i) hands_[i].aim(order.target[i]);
      continue;
    }
    apply(*order.change);
    // There are never more changes under way than there is room for: each was an order first.
    returned_.try_push(order.change);
  }
}

void Engine::apply(Change& change) noexcept {
  for (std::size_t i = 0; i < loops; ++i) {
    LoopChange& loop = change.loop[i];
    if (loop.made && loop.goes_on) {
      setup_.loop[i]->exchange(*loop.made);
      ++tick_.loop[i].changes;
    } else if (loop.made) {
      std::swap(setup_.loop[i], loop.made);
      tick_.loop[i].stopped = false;
      ++tick_.loop[i].run;
    }
    setup_.runs[i] = change.runs[i].value_or(setup_.runs[i]);
  }
  if (change.reset_hand) {
    for (Hand& hand : hands_) hand.reset();
  }
  if (change.tap) hands_[0].begin(*change.tap);
}

void Engine::step() noexcept {
  take_orders();
  const double time_s = static_cast<double>(ticks_done_) * tick_s_;
  const auto time_ns = static_cast<std::uint64_t>(std::llround(1e9 * time_s));
  const double target_m = hands_[0].target_m();
  HandPoint path, path_at_next_tick;
  for (std::size_t i = 0; i < hands_.size(); ++i) std::tie(path[i], path_at_next_tick[i]) = hands_[i].step();
  ++ticks_done_;
  for (std::size_t i = 0; i < loops; ++i) {
    tick_.ran[i] = setup_.runs[i];
    if (!setup_.runs[i]) continue;
    LoopTick& tick = tick_.loop[i];
    Record& record = tick.record;
    if (!tick.stopped) {
      setup_.loop[i]->step(path, path_at_next_tick, share_, tick);
      tick.stopped = !setup_.loop[i]->good();
      // A loop that started over counts from zero; the log and the view do not.
      if (record.touched) record.touched_at_s += time_s - record.time_s;
    }
    record.time_s = time_s;
    tick.time_ns = time_ns;
    tick.hand_position_m = target_m;
    tick.hand_speed_m_per_s = (path_at_next_tick[0] - path[0]) / tick_s_;
    tick.wall_position_m = loop_wall_m;
    tick.real_time_ratio = real_time_ratio_;
    tick.number = ticks_of_[i]++;
  }
  if (watched_.load(std::memory_order_relaxed)) ticks_->push(tick_);
}

bool Engine::at_rest() const noexcept {
  bool rest = true;
  for (std::size_t i = 0; i < loops; ++i) {
    rest = rest && (!setup_.runs[i] || tick_.loop[i].stopped || setup_.loop[i]->at_rest());
  }
  return rest;
}

void Engine::run(const std::function<bool()>& keep_going) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds pause{1};
  constexpr double most_behind_s = 0.1;
  constexpr double window_s = 1.0;
  constexpr double longest_ramp_s = 0.5;
  const auto seconds_since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  Clock::time_point start = Clock::now();
  Clock::time_point window_start = start;
  std::uint64_t done = 0;
  std::uint64_t window_done = 0;
  while (keep_going()) {
    double due_s = seconds_since(start);
    const double behind_s = due_s - static_cast<double>(done) * tick_s_;
    if (behind_s > most_behind_s) {
      start += std::chrono::nanoseconds(std::llround(1e9 * behind_s));
      due_s -= behind_s;
    }
    for (; static_cast<double>(done) * tick_s_ < due_s; ++done) step();
    if (const double window = seconds_since(window_start); window >= window_s) {
      real_time_ratio_ = static_cast<double>(done - window_done) * tick_s_ / window;
      window_start = Clock::now();
      window_done = done;
    }
    std::this_thread::sleep_for(pause);
  }
  share_ = 0.0;
  for (double ramp_s = 0.0; ramp_s < longest_ramp_s && !at_rest(); ramp_s += tick_s_) step();
  share_ = 1.0;
}

}  // namespace tactus::live
