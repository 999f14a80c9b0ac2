// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/units.hpp>

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

/// One spectral line of a signal, in time.
namespace tactus::diagnosis {

using Complex = std::complex<double>;

/// The samples less what is slower than about half of `frequency_Hz`: less their moving average over two periods, taken
/// twice. At the ends the average is over what there is.
std::vector<double> without_slow(std::span<const double> samples, double frequency_Hz, Seconds dt);

/// The complex amplitude of the line at each sample, in the unit of the samples: the signal is |y|·cos(2πft + arg y).
/// Averaged over two periods twice, so it follows changes within about three periods. Time counts from the first
/// sample.
std::vector<Complex> demodulate(std::span<const double> samples, double frequency_Hz, Seconds dt);

/// Complex amplitudes of the line, block after block of `block` samples, under a Hann window and less a straight line.
/// Time counts from the first sample of all, so blocks of different signals may be multiplied.
std::vector<Complex> line_in_blocks(std::span<const double> samples, std::size_t block, double frequency_Hz,
                                    Seconds dt);

/// What blocks of two signals have in common. Each block counts alike, however large it is, so that a few in which
/// something else moved change little.
struct Relation {
  double coherence = 0;  ///< 0 to 1: the square of the mean of the unit vectors between them
  double angle_rad = 0;  ///< by which the second leads the first
  double alignment = 0;  ///< -1 to 1: the mean cosine of the angle between them
};
Relation relation(std::span<const Complex> from, std::span<const Complex> to);

/// The median of the magnitudes.
double usual_size(std::span<const Complex> blocks);

/// Power of frames of samples over time and frequency, for detection and for a picture.
struct Spectrogram {
  std::vector<double> time_s;              ///< of the middle of each frame
  std::vector<double> frequency_Hz;        ///< from 0
  std::vector<std::vector<double>> power;  ///< by frame, then frequency: mean square of the samples in the line
};
/// Hann frames of `frame` samples, a power of two of at least 8, each less its straight line, `hop` samples apart.
Spectrogram spectrogram(std::span<const double> samples, std::size_t frame, std::size_t hop, Seconds dt);

}  // namespace tactus::diagnosis
