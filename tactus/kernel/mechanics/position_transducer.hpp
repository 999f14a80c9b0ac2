// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/analogue_sensor.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cstdint>

namespace tactus::mechanics {

/// Inductive position transducer: the demodulator's low-pass, noise and a converter of finite resolution, that is an
/// `AnalogueSensor` and an `Encoder`. The defaults are those of a 200 mm transducer with a 5 kHz carrier behind a
/// 16-bit converter.
class PositionTransducer {
 public:
  struct Params {
    double bandwidth_Hz = 250.0;
    double noise_rms_m = 3e-6;
    double resolution_m = 3e-6;
    std::int64_t seed = 2;
    static constexpr auto fields() {
      return List{field("bandwidth_Hz", &Params::bandwidth_Hz, units::hertz, positive,
                        "-3 dB frequency of the demodulator. Must be below half the rate of the plant's steps."),
                  field("noise_rms_m", &Params::noise_rms_m, units::metre, non_negative,
                        "Standard deviation of the white noise on every sample."),
                  field("resolution_m", &Params::resolution_m, units::metre, non_negative,
                        "Step of the converter; 0: no quantisation."),
                  field("seed", &Params::seed, non_negative, "Seed of the noise; equal seeds give equal noise.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<PositionTransducer> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    const auto sensor = AnalogueSensor::make({.bandwidth_Hz = params.bandwidth_Hz,
                                              .noise_rms = params.noise_rms_m,
                                              .offset = 0.0,
                                              .limit = 10.0,
                                              .seed = params.seed},
                                             dt);
    if (!sensor) return sensor.error();
    return PositionTransducer(*sensor, params.resolution_m);
  }

  /// Advances the demodulator by one substep at `position_m` and returns its output in m. Real-time safe.
  double step(double position_m) noexcept { return sensor_.step(position_m); }
  /// The reading in m. Real-time safe as `AnalogueSensor::sample` is.
  double sample() noexcept { return quantised(sensor_.sample(), resolution_m_); }
  void reset() noexcept { reset(0.0); }
  /// As if it had always been at `position_m`.
  void reset(double position_m) noexcept { sensor_.reset(position_m); }

 private:
  PositionTransducer(const AnalogueSensor& sensor, double resolution_m)
      : sensor_(sensor), resolution_m_(resolution_m) {}
  AnalogueSensor sensor_;
  double resolution_m_;
};

}  // namespace tactus::mechanics
