// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/sections.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>

namespace tactus::signal {

/// How a continuous block becomes a sampled one.
enum class Discretisation { tustin, exact };

/// The words for a discretisation in a file.
constexpr auto enumerators(Discretisation) {
  return std::array{Enumerator<Discretisation>{Discretisation::tustin, "tustin"},
                    Enumerator<Discretisation>{Discretisation::exact, "exact"}};
}

/// Prediction of a slow signal: H(s) = (2·Tp·s + 1) / (Tp·s + 1), a lead of Tp at low frequency (paper B, eq. 1).
///
/// Gain 1 at rest, 2 at high frequency. `tustin`: bilinear, so the lead at rest is exactly Tp and the gain at half the
/// sample rate exactly 2. `exact`: step-invariant, exact for an input held between the samples; for a smooth input its
/// lead is half a sample longer, and its gain at half the sample rate 2 + (1 − a)/(1 + a) with a = exp(−dt/Tp).
/// Stable for every Tp. Starts at rest at zero.
/// Source: M. Saków et al., Signal Prediction in Bilateral Teleoperation with Force-Feedback, eq. 1.
class PredictionBlock {
 public:
  struct Params {
    double time_constant_s = 0.0018;
    Discretisation discretisation = Discretisation::tustin;
    static constexpr auto fields() {
      return List{field("time_constant_s", &Params::time_constant_s, units::second, positive_up_to(10.0),
                        "Tp: time by which the block predicts at low frequency."),
                  field("discretisation", &Params::discretisation,
                        "tustin keeps the lead at low frequency and the gain at high frequency of the continuous "
                        "block; exact is exact for an input that is constant between samples.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<PredictionBlock> make(const Params& params, Seconds dt) {
    if (Check error = check(params, dt)) return *std::move(error);
    return PredictionBlock(params, dt);
  }

  /// The predicted sample. Real-time safe.
  double step(double input) noexcept { return section_.step(input); }
  /// Back to rest at zero.
  void reset() noexcept { section_.state = 0.0; }

 private:
  PredictionBlock(const Params& params, Seconds dt) {
    if (params.discretisation == Discretisation::exact) {
      const double a = std::exp(-dt.value / params.time_constant_s);
      section_ = {.b0 = 2.0, .b1 = -(1.0 + a), .a1 = -a};
    } else {
      const double r = dt.value / (2.0 * params.time_constant_s);  // (2 + r)/(1 + r) at once: no overflow for large Tp
      section_ = {.b0 = (2.0 + r) / (1.0 + r), .b1 = (r - 2.0) / (1.0 + r), .a1 = (r - 1.0) / (1.0 + r)};
    }
  }
  FirstOrderSection<double> section_;
};

/// n equal prediction blocks in series, n from 0 (passes its input on) to `most_blocks`: lead n·Tp at low frequency,
/// gain 2^n at high frequency.
class PredictionCascade {
 public:
  static constexpr std::size_t most_blocks = 4;
  struct Params {
    std::int64_t blocks = 2;
    PredictionBlock::Params block;
    static constexpr auto fields() {
      return List{field("blocks", &Params::blocks, between(0, 4), "Blocks in series; 0 predicts nothing."),
                  field("block", &Params::block, "Parameters of each block.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<PredictionCascade> make(const Params& params, Seconds dt) {
    if (Check error = check(params, dt)) return *std::move(error);
    return PredictionCascade(params.blocks, PredictionBlock::make(params.block, dt).value());
  }

  /// The predicted sample. Real-time safe.
  double step(double input) noexcept {
    for (std::size_t i = 0; i < count_; ++i) input = blocks_[i].step(input);
    return input;
  }
  void reset() noexcept {
    for (PredictionBlock& block : blocks_) block.reset();
  }

 private:
  PredictionCascade(std::int64_t blocks, const PredictionBlock& block)
      : count_(static_cast<std::size_t>(blocks)), blocks_{block, block, block, block} {}
  std::size_t count_;
  std::array<PredictionBlock, most_blocks> blocks_;
};

/// H(s) of the continuous cascade.
inline std::complex<double> response(const PredictionCascade::Params& params, std::complex<double> s) {
  const std::complex<double> x = params.block.time_constant_s * s;
  const std::complex<double> one = (1.0 + 2.0 * x) / (1.0 + x);
  std::complex<double> product = 1.0;
  for (std::int64_t i = 0; i < params.blocks; ++i) product *= one;
  return product;
}

/// The usable band: the highest frequency in Hz up to which `response(f)` differs from the ideal prediction
/// exp(2πi·f·lead_s) by no more than `tolerance`, and no higher than `highest_Hz`. Not real-time safe.
template <class Response>
double usable_band_Hz(const Response& response, double lead_s, double tolerance, double highest_Hz) {
  const auto error = [&](double frequency_Hz) {
    const double angle = 2.0 * std::numbers::pi * frequency_Hz * lead_s;
    return std::abs(response(frequency_Hz) * std::polar(1.0, -angle) - 1.0);
  };
  double low = 0.0, high = 1e-3 * highest_Hz;
  while (error(high) < tolerance && high < highest_Hz) low = high, high *= 1.1;
  for (int i = 0; i < 60; ++i) (error(0.5 * (low + high)) < tolerance ? low : high) = 0.5 * (low + high);
  return std::min(low, highest_Hz);
}

/// The usable band of the continuous cascade (0.1: a tenth of the signal). Near it, the error is n·3/2·(ω·Tp)².
/// Infinite for no blocks. Not real-time safe.
inline double usable_band_Hz(const PredictionCascade::Params& params, double tolerance = 0.1) {
  if (params.blocks == 0) return std::numeric_limits<double>::infinity();
  const double lead_s = static_cast<double>(params.blocks) * params.block.time_constant_s;
  const auto continuous = [&](double frequency_Hz) {
    return response(params, std::complex<double>(0.0, 2.0 * std::numbers::pi * frequency_Hz));
  };
  return usable_band_Hz(continuous, lead_s, tolerance, 1.0 / lead_s);
}

/// By how much the sampled cascade amplifies the RMS of white noise: the square root of the sum of its squared impulse
/// response. In closed form for tustin, c = 2·Tp/dt: n = 1 gives sqrt(4 − 3/(1 + c)). Not real-time safe.
inline Result<double> white_noise_gain(const PredictionCascade::Params& params, Seconds dt) {
  Result<PredictionCascade> cascade = PredictionCascade::make(params, dt);
  if (!cascade) return cascade.error();
  double sum = 0.0;
  const double ticks = std::min(1e7, 50.0 * params.block.time_constant_s / dt.value + 50.0);
  for (double tick = 0.0; tick < ticks; ++tick) {
    const double sample = cascade->step(tick == 0.0 ? 1.0 : 0.0);
    sum += sample * sample;
  }
  return std::sqrt(sum);
}

}  // namespace tactus::signal
