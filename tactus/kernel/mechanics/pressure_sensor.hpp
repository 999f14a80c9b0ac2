// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/analogue_sensor.hpp>
#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <cmath>
#include <cstdint>

namespace tactus::mechanics {

/// Pressure transmitter of a cylinder's chamber: an `AnalogueSensor` and a converter of finite resolution. The defaults
/// are those of a 250 bar industrial transmitter (noise 0.1 % of full scale) behind a 12-bit converter.
class PressureSensor {
 public:
  struct Params {
    double bandwidth_Hz = 500.0;
    double noise_rms_Pa = 2.5e4;
    double resolution_Pa = 6100.0;
    double limit_Pa = 25e6;
    std::int64_t seed = 1;
    static constexpr auto fields() {
      return List{field("bandwidth_Hz", &Params::bandwidth_Hz, units::hertz, positive,
                        "-3 dB frequency of the analogue part. Must be below half the rate of the plant's steps."),
                  field("noise_rms_Pa", &Params::noise_rms_Pa, units::pascal, non_negative,
                        "Standard deviation of the white noise on every sample."),
                  field("resolution_Pa", &Params::resolution_Pa, units::pascal, non_negative,
                        "Step of the converter; 0: no quantisation."),
                  field("limit_Pa", &Params::limit_Pa, units::pascal, positive, "Full scale."),
                  field("seed", &Params::seed, non_negative, "Seed of the noise; equal seeds give equal noise.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<PressureSensor> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    const auto sensor = AnalogueSensor::make({.bandwidth_Hz = params.bandwidth_Hz,
                                              .noise_rms = params.noise_rms_Pa,
                                              .offset = 0.0,
                                              .limit = params.limit_Pa,
                                              .seed = params.seed},
                                             dt);
    if (!sensor) return sensor.error();
    return PressureSensor(*sensor, params.resolution_Pa);
  }

  /// Advances the analogue part by one substep under `pressure_Pa` and returns its output in Pa. Real-time safe.
  double step(double pressure_Pa) noexcept { return sensor_.step(pressure_Pa); }
  /// The reading in Pa. Real-time safe as `AnalogueSensor::sample` is.
  double sample() noexcept { return quantised(sensor_.sample(), resolution_Pa_); }
  void reset() noexcept { reset(0.0); }
  /// As if the pressure had always been `pressure_Pa`.
  void reset(double pressure_Pa) noexcept { sensor_.reset(pressure_Pa); }

 private:
  PressureSensor(const AnalogueSensor& sensor, double resolution_Pa) : sensor_(sensor), resolution_Pa_(resolution_Pa) {}
  AnalogueSensor sensor_;
  double resolution_Pa_;
};

}  // namespace tactus::mechanics
