// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

namespace tactus::experiments {

/// How far the magnitude spectrum of what arrived is from that of what was wanted:
///
///     √( Σ (|Y(f)| − |W(f)|)² / Σ |W(f)|² ),   f every 1/(duration of the window) from `lower_Hz` to `upper_Hz`
///
/// with Y and W the discrete Fourier transforms of `arrived` and `wanted` behind a window that rises over the first
/// and falls over the last `edge_share` of the samples, each as half a cosine. 0 when both spectra are equal, 1 when
/// nothing arrived. Time shifts do not count: what comes late but whole is not dull.
///
/// Both signals have equal length and unit, `sample_time_s` above 0, 0 < `lower_Hz` < `upper_Hz` below half the
/// sampling rate. None where nothing was wanted in the band. Not real-time safe.
std::optional<double> spectral_error(std::span<const double> wanted, std::span<const double> arrived,
                                     double sample_time_s, double lower_Hz, double upper_Hz);

/// Share of the window that each of its edges takes.
inline constexpr double edge_share = 0.1;

}  // namespace tactus::experiments
