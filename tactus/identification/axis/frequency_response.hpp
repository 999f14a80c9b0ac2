// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Frequency responses from recorded input and output, with bands that show how far to trust them.
namespace tactus::identification {

/// One experiment: input and output at the same instants, as many samples of each.
struct InputOutput {
  std::span<const double> input;
  std::span<const double> output;
};

enum class Window { hann, rectangular };
constexpr auto enumerators(Window) {
  return std::array{Enumerator{Window::hann, "hann"}, Enumerator{Window::rectangular, "rectangular"}};
}

/// How a recording is cut into segments (Welch's method).
struct SegmentParams {
  std::int64_t samples = 4096;
  double overlap = 0.5;
  Window window = Window::hann;
  static constexpr auto fields() {
    return List{
        field("samples", &SegmentParams::samples, between(8, 1 << 24),
              "Samples of a segment, a power of two: the distance of the lines is 1 / (samples * sample time)."),
        field("overlap", &SegmentParams::overlap, units::none, between(0.0, 0.95),
              "Part of a segment that the next one repeats. A Hann window wants 0.5."),
        field("window", &SegmentParams::window, "Weight of the samples in a segment."),
    };
  }
};

/// Averaged one-sided spectral densities, one value per line from 0 to half the sample rate. Units: square of the
/// signal's (product of both for the cross spectrum) per Hz. As `scipy.signal.welch` and `csd` scale them.
struct Spectra {
  std::vector<double> frequency_Hz;
  std::vector<double> input_power;
  std::vector<double> output_power;
  std::vector<std::complex<double>> cross_power;  ///< conj(input) times output
  std::size_t segments = 0;
  /// Of how many independent segments the average is worth: overlapping ones share samples (Welch 1967, white signal).
  double independent_segments = 0.0;
};

/// A frequency response, output over input, with the ordinary coherence where the estimate has one.
struct FrequencyResponse {
  std::vector<double> frequency_Hz;
  std::vector<std::complex<double>> response;
  /// Radius of the circle around `response` in the complex plane that holds the true one with a probability of 95 %;
  /// infinite where the data cannot determine (a single run without smoothing).
  std::vector<double> radius_95;
  /// 0 to 1; 0 where a signal has no power. Empty for the ETFE.
  std::vector<double> coherence;
};

/// Averages the spectra over all segments of all runs, each segment less its mean.
///
/// Errors: parameters out of bounds, samples that are no power of two, no run; `inconsistent` for input and output of
/// different length, fewer than two segments in total, or a signal that never changes in any run; `out_of_bounds` for a
/// sample that is not finite. Not real-time safe.
/// Source: Welch, The use of fast Fourier transform for the estimation of power spectra, 1967.
Result<Spectra> average_spectra(std::span<const InputOutput> runs, Seconds sample_time, const SegmentParams& params);

/// H1 = cross over input power: unbiased by noise on the output, too small where there is noise on the input.
/// Band: Bendat and Piersol, Random Data, section 9.2, radius² = (20^(1/(n−1)) − 1)·(1 − γ²)·output/input power, n
/// independent segments, γ² the coherence.
FrequencyResponse response_h1(const Spectra& spectra);

/// H2 = output power over conjugate cross: unbiased by noise on the input, too large where there is noise on the
/// output. Band: as wide in proportion to the response as that of H1.
FrequencyResponse response_h2(const Spectra& spectra);

/// How the empirical transfer function estimate is smoothed.
struct EtfeParams {
  std::int64_t smoothing_lines = 1;
  static constexpr auto fields() {
    return List{field("smoothing_lines", &EtfeParams::smoothing_lines, between(1, 1001),
                      "Lines that a moving average takes together, an odd number; at both ends of the frequency "
                      "axis it takes as many as there are.")};
  }
};

/// Empirical transfer function estimate: the ratio of the transforms of output and input, each less its mean and
/// followed by zeros to the next power of two (the same for all runs), its complex value averaged over the runs, then
/// over neighbouring lines. Left out are the line at 0 Hz, for the means are gone, and lines where an input has less
/// than 1e-12 of its largest amplitude; an average of nothing is not a number. For an excitation that begins and ends
/// at rest. The band follows from the scatter of what was averaged, taken as independent. Paper A, section on
/// identification; Ljung, System Identification, section 6.3.
///
/// Errors as for `average_spectra`; `inconsistent` for an even number of lines, or fewer than 8 samples. At most 2^27
/// samples. Not real-time safe.
Result<FrequencyResponse> etfe(std::span<const InputOutput> runs, Seconds sample_time, const EtfeParams& params);

/// Whether a device answered alike at different amplitudes, positions or grips.
struct Linearity {
  /// Part of all pairs of responses and lines that differ by more than the 95 % bands of the two explain.
  double outside = 0.0;
  /// Median over the lines of the largest difference between two responses, in proportion to their mean.
  double spread = 0.0;
  /// Where that largest difference has its own maximum.
  double worst_Hz = 0.0;
  std::size_t lines = 0;
  bool linear = false;  ///< `outside` is at most 0.1, twice what chance alone would give
};

/// Compares responses on the same lines between `lower_Hz` and `upper_Hz`, both included. Lines where one of them does
/// not rise above its band are left out: they show noise alone.
/// Errors: `inconsistent` for fewer than two responses, different lines, or no line to compare. Not real-time safe.
Result<Linearity> judge_linearity(std::span<const FrequencyResponse> responses, double lower_Hz, double upper_Hz);

}  // namespace tactus::identification
