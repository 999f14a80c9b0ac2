// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <optional>

namespace tactus::control {

/// Splits a force between the master's motor and a vibrotactile actuator on its handle, so that the fast part reaches
/// the hand without moving the motor that measures the command (combined vibrotactile and force feedback, as described
/// by Kuchenbecker and Niemeyer, "Induced Master Motion in Force-Reflecting Teleoperation", Sec. IV).
///
///     below = H F,   above = F − below,   H(s) = 1 / (s² + √2 s + 1)  (s over 2π frequency)
///
/// H is the force filter's low-pass, so the motor gets what it gets from that filter, and the handle gets what the
/// filter takes away. The two parts sum to F but for round-off, in amplitude and phase at every frequency; a high-pass
/// of the same kind as H would leave a hole at the crossover. The price: `above` rises by 6 dB an octave only, and
/// peaks at √3/√2 (1.8 dB) of F at the crossover, where the parts point apart.
///
/// Starts from the first sample, as if the force had always been that. Frequency below half the sample rate; with 0
/// there is no split, and `below` is the force bit for bit.
class Crossover {
 public:
  struct Params {
    double frequency_Hz = 0.0;
    static constexpr auto fields() {
      return List{field("frequency_Hz", &Params::frequency_Hz, units::hertz, non_negative,
                        "Force below this frequency goes to the motor, the rest to the actuator on the handle; below "
                        "half the servo rate. 0 is off: all force goes to the motor.")};
    }
  };
  /// The whole force, in N.
  using Input = double;
  struct Output {
    double below_N = 0.0;
    double above_N = 0.0;
  };

  static constexpr int linear_states = 2;
  static constexpr std::optional<Unfit> not_on_lanes(const Params& params) {
    if (params.frequency_Hz == 0.0) return {};
    return Unfit{"frequency_Hz", "write 0"};
  }

  static Result<Crossover> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    Crossover crossover;
    if (params.frequency_Hz == 0.0) return crossover;
    const auto below = signal::SecondOrderFilter::make(
        {.kind = signal::FilterKind::low_pass, .frequency_Hz = params.frequency_Hz}, dt);
    if (!below) return below.error();
    crossover.below_ = *below;
    return crossover;
  }

  /// Both parts of this sample. Real-time safe.
  Output step(double force_N) noexcept {
    if (!below_) return {.below_N = force_N};
    if (!started_) below_->settle(force_N);
    started_ = true;
    const double below_N = below_->step(force_N);
    return {.below_N = below_N, .above_N = force_N - below_N};
  }

  /// As made: the next sample starts it.
  void reset() noexcept {
    if (below_) below_->reset();
    started_ = false;
  }

 private:
  Crossover() = default;
  std::optional<signal::SecondOrderFilter> below_;
  bool started_ = false;
};

}  // namespace tactus::control
