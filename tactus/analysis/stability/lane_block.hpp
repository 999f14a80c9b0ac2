// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/lane.hpp>
#include <tactus/analysis/stability/lane_run.hpp>

#include <cstring>

/// The body of a `LaneRunner`. Compiled once for each instruction set, with that set's flags, so it must leave nothing
/// behind that another translation unit could pick up: everything here depends on the lane type, and nothing of the
/// standard library is used that is not a builtin.
namespace tactus::stability::lane_block {

/// How a scalar is made of the numbers of its lanes.
template <class Scalar>
struct Access {
  using Real = typename Scalar::Real;
  static constexpr std::size_t count = Scalar::count;
  static Real get(const Scalar& scalar, std::size_t lane) noexcept { return scalar.get(lane); }
  static void set(Scalar& scalar, std::size_t lane, double value) noexcept { scalar.set(lane, value); }
};
template <>
struct Access<double> {
  using Real = double;
  static constexpr std::size_t count = 1;
  static double get(double scalar, std::size_t) noexcept { return scalar; }
  static void set(double& scalar, std::size_t, double value) noexcept { scalar = value; }
};

/// Flushes denormals while it lives: a run that dies away would slow down by a hundred times.
template <class Scalar>
class FlushDenormals {
 public:
  FlushDenormals() noexcept {
#if defined(__SSE2__)
    before_ = _mm_getcsr();
    _mm_setcsr(before_ | 0x8040U);
#endif
  }
  ~FlushDenormals() {
#if defined(__SSE2__)
    _mm_setcsr(before_);
#endif
  }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_ = 0;
};

/// A delay of its own for each lane, on one ring.
template <class Scalar>
struct Line {
  using A = Access<Scalar>;
  Scalar* slots;
  std::size_t length;
  std::size_t delay[A::count];
  bool equal = true;  ///< all lanes wait the same
  std::size_t now = 0;

  /// Takes the slots from `room` and leaves it behind them.
  template <class DelayOf, class InitialOf>
  void make(Scalar*& room, const DelayOf& delay_of, const InitialOf& initial_of) noexcept {
    length = 1;
    for (std::size_t i = 0; i < A::count; ++i) {
      delay[i] = delay_of(i);
      equal = equal && delay[i] == delay[0];
      length = delay[i] + 1 > length ? delay[i] + 1 : length;
    }
    slots = room;
    room += length;
    for (std::size_t i = 0; i < A::count; ++i) {
      for (std::size_t n = 0; n < length; ++n) A::set(slots[n], i, initial_of(i));
    }
  }
  Scalar step(const Scalar& input) noexcept {
    slots[now] = input;
    Scalar output = slots[(now + length - delay[0]) % length];
    if (!equal) {
      for (std::size_t i = 1; i < A::count; ++i) {
        A::set(output, i, A::get(slots[(now + length - delay[i]) % length], i));
      }
    }
    now = now + 1 == length ? 0 : now + 1;
    return output;
  }
};

template <class Scalar>
struct Lines {
  Line<Scalar> slave, master, person;
  Scalar to_slave(const Scalar& position_m) noexcept { return slave.step(position_m); }
  Scalar to_master(const Scalar& force_N) noexcept { return master.step(force_N); }
  Scalar reaction(const Scalar& error_m) noexcept { return person.step(error_m); }
};

template <class Scalar>
void run(const LanePoint* const* points, const LanePlan& plan, double* lines_room, double* force_N,
         LaneResult* results) {
  using A = Access<Scalar>;
  using Loop = LaneLoop<Scalar>;
  constexpr std::size_t lanes = A::count;
  constexpr std::size_t numbers = sizeof(LaneLoop<double>) / sizeof(double);
  static_assert(sizeof(Loop) == numbers * sizeof(Scalar), "a loop is made of scalars alone");
  const FlushDenormals<Scalar> flush;

  Loop loop;
  for (std::size_t i = 0; i < lanes; ++i) {
    const char* from = reinterpret_cast<const char*>(&points[i]->loop);
    char* to = reinterpret_cast<char*>(&loop);
    for (std::size_t n = 0; n < numbers; ++n) {
      double number;
      Scalar scalar;
      __builtin_memcpy(&number, from + n * sizeof(double), sizeof(double));
      __builtin_memcpy(&scalar, to + n * sizeof(Scalar), sizeof(Scalar));
      A::set(scalar, i, number);
      __builtin_memcpy(to + n * sizeof(Scalar), &scalar, sizeof(Scalar));
    }
  }
  Scalar* room = reinterpret_cast<Scalar*>(lines_room);
  Lines<Scalar> lines;
  lines.slave.make(
      room, [&](std::size_t i) { return points[i]->to_slave_ticks; },
      [&](std::size_t i) { return points[i]->slave_start_m; });
  lines.master.make(
      room, [&](std::size_t i) { return points[i]->to_master_ticks; }, [](std::size_t) { return 0.0; });
  lines.person.make(
      room, [&](std::size_t i) { return points[i]->reaction_ticks; }, [](std::size_t) { return 0.0; });

  bool cancelling = false, hysteretic = false;
  std::size_t until[lanes];
  for (std::size_t i = 0; i < lanes; ++i) {
    cancelling = cancelling || points[i]->loop.cancels > 0.0;
    hysteretic = hysteretic || points[i]->loop.hysteretic > 0.0;
    until[i] = plan.approach_ticks;
    results[i] = LaneResult{};
  }

  Scalar peak_N = 0.0;
  Scalar still = 1.0;  // 1 in the lanes whose run continues
  std::size_t last = plan.approach_ticks;
  std::size_t next_end = last;  // when the next lane is done
  for (std::size_t tick = 0; tick < last; ++tick) {
    const double time_s = static_cast<double>(tick) * plan.clock.tick_s;
    const auto record = loop.tick(plan.clock, time_s, lines, cancelling, hysteretic);
    using std::fabs;
    using std::max;
    peak_N = max(peak_N, select(still > 0.0, record.peak_contact_force_N, Scalar(0.0)));
    // Written so that a NaN counts as outside.
    const auto inside_master = fabs(record.master_position_m) < Scalar(1.0);
    const auto inside_slave = fabs(record.tip_position_m) < loop.position_scale;
    const Scalar outside = select(inside_master, select(inside_slave, Scalar(0.0), Scalar(1.0)), Scalar(1.0));
    const bool news = any(record.touches > 0.0) || any(outside > 0.0) || tick + 1 == next_end;
    for (std::size_t i = 0; i < lanes; ++i) {
      force_N[tick * lanes + i] = static_cast<double>(A::get(record.contact_force_N, i));
    }
    if (!news) continue;
    last = 0;
    next_end = plan.longest();
    for (std::size_t i = 0; i < lanes; ++i) {
      LaneResult& result = results[i];
      if (tick < until[i]) {
        const double touches = static_cast<double>(A::get(record.touches, i));
        if (touches > 0.0) {
          result.touches += touches;
          if (!result.touched) {
            result.touched = true;
            result.first_touch = tick;
            until[i] = tick + plan.observation_ticks;
          }
        }
        if (static_cast<double>(A::get(outside, i)) > 0.0) {
          result.diverged = true;
          until[i] = tick + 1;
        }
      }
      last = until[i] > last ? until[i] : last;
      if (until[i] <= tick + 1) {
        A::set(still, i, 0.0);
      } else if (until[i] < next_end) {
        next_end = until[i];
      }
    }
  }
  for (std::size_t i = 0; i < lanes; ++i) {
    results[i].ticks = until[i];
    results[i].peak_force_N = static_cast<double>(A::get(peak_N, i));
  }
}

}  // namespace tactus::stability::lane_block
