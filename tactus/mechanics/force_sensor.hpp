#pragma once

#include <tactus/core/element.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/signal/checks.hpp>
#include <tactus/signal/random.hpp>
#include <tactus/signal/second_order_filter.hpp>

#include <algorithm>
#include <cstdint>

namespace tactus::mechanics {

/// Force sensor with its analogue front end and its converter, which run on two clocks.
///
/// `step`, on the plant's substeps, is the analogue part: the force through a second-order Butterworth low-pass, −3 dB
/// at `bandwidth_Hz`, as an anti-aliasing filter is. `sample`, once a servo tick, is the converter: plus the offset,
/// plus white noise, then saturation. The noise is drawn per sample and not per substep, so its RMS does not depend on
/// how finely the plant is stepped; it is drawn from its own seeded stream, so no other sensor can shift it. Range:
/// bandwidth below half the rate of the substeps.
class ForceSensor {
 public:
  struct Params {
    double bandwidth_Hz = 1000.0;
    double noise_rms_N = 0.0;
    double offset_N = 0.0;
    double limit_N = 100.0;
    std::int64_t seed = 1;
    static constexpr auto fields() {
      return std::tuple{
          field("bandwidth_Hz", &Params::bandwidth_Hz, units::hertz, positive,
                "The -3 dB frequency of the analogue part; below half the rate of the substeps."),
          field("noise_rms_N", &Params::noise_rms_N, units::newton, non_negative,
                "Standard deviation of the white noise on every sample."),
          field("offset_N", &Params::offset_N, units::newton, any_finite, "Reading at no force."),
          field("limit_N", &Params::limit_N, units::newton, positive,
                "Largest reading either way; beyond it the sensor saturates."),
          field("seed", &Params::seed, non_negative, "Seed of the noise: the same seed, the same noise.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<ForceSensor> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    if (Check error = signal::check_below_nyquist("bandwidth_Hz", params.bandwidth_Hz, dt)) return *std::move(error);
    const auto filter = signal::SecondOrderFilter::make({.frequency_Hz = params.bandwidth_Hz}, dt);
    if (!filter) return filter.error();
    return ForceSensor(params, *filter);
  }

  /// Advances the analogue part by one substep under `force_N` and returns its output in N. Real-time safe.
  double step(double force_N) noexcept { return analogue_N_ = filter_.step(force_N); }

  /// The reading in N: the latest analogue output with offset, noise and saturation. A noisy sensor draws one random
  /// number. Real-time safe but for the unbounded, on average 1.4, draws of `Random::normal`.
  double sample() noexcept {
    const double noise_N = params_.noise_rms_N > 0.0 ? params_.noise_rms_N * noise_.normal() : 0.0;
    return std::clamp(analogue_N_ + params_.offset_N + noise_N, -params_.limit_N, params_.limit_N);
  }

  /// No force so far, and the noise from its beginning.
  void reset() noexcept {
    filter_.reset();
    analogue_N_ = 0.0;
    noise_ = signal::Random(static_cast<std::uint64_t>(params_.seed));
  }

  /// The analogue part as it stands.
  [[nodiscard]] const signal::SecondOrderSection<double>& analogue() const noexcept { return filter_.section(); }

 private:
  ForceSensor(const Params& params, const signal::SecondOrderFilter& filter) : params_(params), filter_(filter) {}
  Params params_;
  signal::SecondOrderFilter filter_;
  double analogue_N_ = 0.0;
  signal::Random noise_{static_cast<std::uint64_t>(params_.seed)};
};

}  // namespace tactus::mechanics
