// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <cstdint>
#include <vector>

/// What a device is excited with, one sample per tick, to be played open loop (forces) or as a reference (positions).
///
/// Forces begin and end at 0 and never exceed `force_limit_N`; a request that would is refused rather than clipped, for
/// a clipped signal has other lines than the one asked for. Errors of all: a parameter outside its bounds,
/// `inconsistent` for a limit that the signal would exceed, for a fade longer than half the signal, for a frequency not
/// below half the sample rate, and for more than 1e8 samples. None is real-time safe.
namespace tactus::identification {

inline constexpr Bounds excitation_duration_s = positive_up_to(3600.0);

/// A force that may not be exceeded, and how gently the excitation sets in and ends.
struct ForceEnvelope {
  double force_limit_N = 5.0;
  double fade_s = 0.1;
  static constexpr auto fields() {
    return List{
        field("force_limit_N", &ForceEnvelope::force_limit_N, units::newton, positive, "Largest force allowed."),
        field("fade_s", &ForceEnvelope::fade_s, units::second, non_negative,
              "Time in which the force grows from 0, and in which it dies away, along half a cosine."),
    };
  }
};

enum class SweepSpacing { linear, logarithmic };
constexpr auto enumerators(SweepSpacing) {
  return std::array{Enumerator{SweepSpacing::linear, "linear"}, Enumerator{SweepSpacing::logarithmic, "logarithmic"}};
}

/// Swept sine, upward or (as in paper A: friction stays broken loose) downward.
struct SweptSineParams {
  double start_Hz = 400.0;
  double end_Hz = 1.0;
  double duration_s = 20.0;
  double amplitude_N = 1.0;
  SweepSpacing spacing = SweepSpacing::logarithmic;
  ForceEnvelope envelope = {};
  static constexpr auto fields() {
    return List{
        field("start_Hz", &SweptSineParams::start_Hz, units::hertz, positive, "Frequency of the first sample."),
        field("end_Hz", &SweptSineParams::end_Hz, units::hertz, positive, "Frequency at the end."),
        field("duration_s", &SweptSineParams::duration_s, units::second, excitation_duration_s, "Length."),
        field("amplitude_N", &SweptSineParams::amplitude_N, units::newton, positive, "Amplitude of the sine."),
        field("spacing", &SweptSineParams::spacing, "Whether equal times hold equal steps or equal ratios."),
        field("envelope", &SweptSineParams::envelope, "Limit and fade."),
    };
  }
};
Result<std::vector<double>> swept_sine_N(const SweptSineParams& params, Seconds tick);

/// Sum of sines of equal amplitude on the lines of one period, with Schroeder's phases, which keep the peak low. The
/// fades take up whole periods of their own at both ends, so that `periods` in between are exact repetitions.
/// Source: Schroeder, Synthesis of low-peak-factor signals, 1970.
struct MultisineParams {
  double lowest_Hz = 1.0;
  double highest_Hz = 200.0;
  double period_s = 1.0;
  std::int64_t periods = 10;
  double peak_N = 1.0;
  ForceEnvelope envelope = {};
  static constexpr auto fields() {
    return List{
        field("lowest_Hz", &MultisineParams::lowest_Hz, units::hertz, positive, "No line lies below."),
        field("highest_Hz", &MultisineParams::highest_Hz, units::hertz, positive, "No line lies above."),
        field("period_s", &MultisineParams::period_s, units::second, excitation_duration_s,
              "Length of a period, rounded to whole samples; the distance of its lines is the reciprocal."),
        field("periods", &MultisineParams::periods, between(1, 1e6), "Exact periods, besides those of the fades."),
        field("peak_N", &MultisineParams::peak_N, units::newton, positive, "Largest force of a period."),
        field("envelope", &MultisineParams::envelope, "Limit and fade."),
    };
  }
};
Result<std::vector<double>> multisine_N(const MultisineParams& params, Seconds tick);

/// Plus or minus the amplitude, drawn again at the end of each hold; the same for the same seed.
struct RandomBinaryParams {
  double amplitude_N = 1.0;
  double hold_s = 1e-3;
  double duration_s = 20.0;
  std::int64_t seed = 1;
  ForceEnvelope envelope = {};
  static constexpr auto fields() {
    return List{
        field("amplitude_N", &RandomBinaryParams::amplitude_N, units::newton, positive, "The force, either way."),
        field("hold_s", &RandomBinaryParams::hold_s, units::second, positive, "Time between draws, in whole samples."),
        field("duration_s", &RandomBinaryParams::duration_s, units::second, excitation_duration_s, "Length."),
        field("seed", &RandomBinaryParams::seed, between(0, 9e15), "Which of the random signals."),
        field("envelope", &RandomBinaryParams::envelope, "Limit and fade."),
    };
  }
};
Result<std::vector<double>> random_binary_N(const RandomBinaryParams& params, Seconds tick);

/// Slow triangular loops 0, +peak, −peak, 0: stiffness and hysteresis without inertia. Begins and ends at 0 by itself.
struct ForceLoopParams {
  double peak_N = 4.0;
  double rate_N_per_s = 1.0;
  std::int64_t loops = 3;
  double force_limit_N = 5.0;
  static constexpr auto fields() {
    return List{
        field("peak_N", &ForceLoopParams::peak_N, units::newton, positive, "Force at which the loop turns."),
        field("rate_N_per_s", &ForceLoopParams::rate_N_per_s, units::newton_per_second, positive, "Slope."),
        field("loops", &ForceLoopParams::loops, between(1, 1000), "How often."),
        field("force_limit_N", &ForceLoopParams::force_limit_N, units::newton, positive, "Largest force allowed."),
    };
  }
};
Result<std::vector<double>> force_loops_N(const ForceLoopParams& params, Seconds tick);

/// Reference of a position controller: from one end to the other and back at constant speed, the speed fading in and
/// out along half a cosine at each end. The force that it takes is Coulomb friction, and damping where speeds differ.
struct CrossingParams {
  double from_m = -0.02;
  double to_m = 0.02;
  double speed_m_per_s = 0.02;
  double fade_s = 0.1;
  double workspace_lower_m = -0.03;
  double workspace_upper_m = 0.03;
  static constexpr auto fields() {
    return List{
        field("from_m", &CrossingParams::from_m, units::metre, any_finite, "Where it begins and ends."),
        field("to_m", &CrossingParams::to_m, units::metre, any_finite, "Where it turns."),
        field("speed_m_per_s", &CrossingParams::speed_m_per_s, units::metre_per_second, positive, "Constant speed."),
        field("fade_s", &CrossingParams::fade_s, units::second, non_negative, "Time to reach the speed, and to stop."),
        field("workspace_lower_m", &CrossingParams::workspace_lower_m, units::metre, any_finite, "Least position."),
        field("workspace_upper_m", &CrossingParams::workspace_upper_m, units::metre, any_finite, "Largest position."),
    };
  }
};
Result<std::vector<double>> crossing_m(const CrossingParams& params, Seconds tick);

}  // namespace tactus::identification
