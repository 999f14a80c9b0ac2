// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

namespace tactus::signal {

/// A delay of a whole number of ticks, at most `Capacity`: output[n] = input[n − ticks], and the initial value before
/// the first input arrives. With a delay of zero the output is the input.
///
/// The ring is as long as the delay plus one: write, advance, read. That order needs no branch for a delay of zero. The
/// delay is rounded to the nearest tick (`delay_ticks` shows which): a fractional delay would have to interpolate, and
/// an interpolator is a filter that nobody asked for.
template <class T, std::size_t Capacity>
class DelayLine {
  static_assert(std::is_trivially_copyable_v<T>, "a delay line is copied as bytes, so what it holds must be too");

 public:
  struct Params {
    double delay_s = 0.0;
    static constexpr auto fields() {
      return List{field("delay_s", &Params::delay_s, units::second, non_negative,
                        "Delay, rounded to the nearest whole number of control cycles.")};
    }
  };
  using Input = T;
  using Output = T;

  static Result<DelayLine> make(const Params& params, Seconds dt, const T& initial = T{}) {
    if (Check error = check(params, dt)) return *std::move(error);
    const double ticks = std::round(params.delay_s / dt.value);
    if (!(ticks <= static_cast<double>(Capacity))) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "delay_s",
                   .message = rounded_number(params.delay_s) + " s is " + rounded_number(ticks) +
                              " control cycles, and this delay line holds at most " + std::to_string(Capacity) + " (" +
                              rounded_number(static_cast<double>(Capacity) * dt.value) +
                              " s): shorten the delay or lengthen the control cycle",
                   .place = {}};
    }
    DelayLine line;
    line.length_ = static_cast<std::size_t>(ticks) + 1;
    line.initial_ = initial;
    line.reset();
    return line;
  }

  /// Takes in this tick's value and gives out the one of `delay_ticks()` ticks ago. Real-time safe.
  T step(const T& input) noexcept {
    slots_[next_] = input;
    next_ = next_ + 1 == length_ ? 0 : next_ + 1;
    return slots_[next_];
  }

  /// Empty again: the initial value comes out until the first new input arrives.
  void reset() noexcept {
    slots_.fill(initial_);
    next_ = 0;
  }

  [[nodiscard]] std::size_t delay_ticks() const noexcept { return length_ - 1; }

 private:
  DelayLine() = default;
  std::array<T, Capacity + 1> slots_{};
  T initial_{};
  std::size_t length_ = 1;
  std::size_t next_ = 0;
};

}  // namespace tactus::signal
