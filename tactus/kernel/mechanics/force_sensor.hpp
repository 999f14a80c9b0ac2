// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/analogue_sensor.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cstdint>

namespace tactus::mechanics {

/// Force sensor with its analogue front end and its converter: an `AnalogueSensor`. Range: bandwidth below half the
/// rate of the substeps.
class ForceSensor {
 public:
  struct Params {
    double bandwidth_Hz = 1000.0;
    double noise_rms_N = 0.0;
    double offset_N = 0.0;
    double limit_N = 100.0;
    std::int64_t seed = 1;
    static constexpr auto fields() {
      return List{field("bandwidth_Hz", &Params::bandwidth_Hz, units::hertz, positive,
                        "-3 dB frequency of the analogue part. Must be below half the rate of the plant's steps."),
                  field("noise_rms_N", &Params::noise_rms_N, units::newton, non_negative,
                        "Standard deviation of the white noise on every sample."),
                  field("offset_N", &Params::offset_N, units::newton, any_finite, "Reading without force."),
                  field("limit_N", &Params::limit_N, units::newton, positive,
                        "Largest reading in either direction; above it the sensor saturates."),
                  field("seed", &Params::seed, non_negative, "Seed of the noise; equal seeds give equal noise.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<ForceSensor> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    const auto sensor = AnalogueSensor::make({.bandwidth_Hz = params.bandwidth_Hz,
                                              .noise_rms = params.noise_rms_N,
                                              .offset = params.offset_N,
                                              .limit = params.limit_N,
                                              .seed = params.seed},
                                             dt);
    if (!sensor) return sensor.error();
    return ForceSensor(*sensor);
  }

  /// Advances the analogue part by one substep under `force_N` and returns its output in N. Real-time safe.
  double step(double force_N) noexcept { return sensor_.step(force_N); }

  /// The reading in N: the latest analogue output with offset, noise and saturation. Real-time safe as
  /// `AnalogueSensor::sample` is.
  double sample() noexcept { return sensor_.sample(); }

  /// No force so far, and the noise from its beginning.
  void reset() noexcept { sensor_.reset(0.0); }

  /// The analogue part as it is, for sweeps.
  [[nodiscard]] const signal::SecondOrderSection<double>& analogue() const noexcept { return sensor_.section(); }

 private:
  explicit ForceSensor(const AnalogueSensor& sensor) : sensor_(sensor) {}
  AnalogueSensor sensor_;
};

}  // namespace tactus::mechanics
