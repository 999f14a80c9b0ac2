// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <algorithm>
#include <cstdint>

namespace tactus::mechanics {

/// The chain that every analogue sensor has, on two clocks, in the unit of what is sensed.
///
/// `step`, on the plant's substeps, is the analogue part: the quantity through a second-order Butterworth low-pass,
/// −3 dB at the bandwidth, as an anti-aliasing filter is. `sample`, once a servo tick, is the converter: plus the
/// offset, plus white noise, then saturation. The noise is drawn per sample and not per substep, so its RMS does not
/// depend on how finely the plant is stepped; it is drawn from its own seeded stream, so no other sensor can shift it.
class AnalogueSensor {
 public:
  struct Settings {
    double bandwidth_Hz;
    double noise_rms;
    double offset;
    double limit;
    std::int64_t seed;
  };

  /// For settings within the bounds of the sensor that they describe. Errors: `out_of_bounds`, naming `bandwidth_Hz`,
  /// for a bandwidth of half the rate of the substeps or more.
  static Result<AnalogueSensor> make(const Settings& settings, Seconds dt) {
    if (Check error = signal::check_below_nyquist("bandwidth_Hz", settings.bandwidth_Hz, dt)) return *std::move(error);
    const auto filter = signal::SecondOrderFilter::make({.frequency_Hz = settings.bandwidth_Hz}, dt);
    if (!filter) return filter.error();
    return AnalogueSensor(settings, *filter);
  }

  /// Advances the analogue part by one substep under `value` and returns its output. Real-time safe.
  double step(double value) noexcept { return analogue_ = filter_.step(value); }

  /// The reading: the latest analogue output with offset, noise and saturation. A noisy sensor draws one random number.
  /// Real-time safe but for the unbounded, on average 1.4, draws of `Random::normal`.
  double sample() noexcept {
    const double noise = settings_.noise_rms > 0.0 ? settings_.noise_rms * noise_.normal() : 0.0;
    return std::clamp(analogue_ + settings_.offset + noise, -settings_.limit, settings_.limit);
  }

  /// As if it had always sensed `value`, and the noise from its beginning.
  void reset(double value) noexcept {
    filter_.settle(value);
    analogue_ = value;
    noise_ = signal::Random(static_cast<std::uint64_t>(settings_.seed));
  }

  /// The analogue part as it is, for sweeps.
  [[nodiscard]] const signal::SecondOrderSection<double>& section() const noexcept { return filter_.section(); }

 private:
  AnalogueSensor(const Settings& settings, const signal::SecondOrderFilter& filter)
      : settings_(settings), filter_(filter) {}
  Settings settings_;
  signal::SecondOrderFilter filter_;
  double analogue_ = 0.0;
  signal::Random noise_{static_cast<std::uint64_t>(settings_.seed)};
};

}  // namespace tactus::mechanics
