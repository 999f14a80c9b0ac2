// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/real_pair_transform.hpp>
#include <tactus/identification/diagnosis/line.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::diagnosis {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

/// Means over `width` samples about each one, fewer at the ends.
template <class T>
std::vector<T> moving_average(std::span<const T> samples, std::size_t width) {
  std::vector<T> sums(samples.size() + 1);
  for (std::size_t i = 0; i < samples.size(); ++i) sums[i + 1] = sums[i] + samples[i];
  std::vector<T> means(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::size_t from = i - std::min(i, width / 2);
    const std::size_t to = std::min(samples.size(), i + width - width / 2);
    means[i] = (sums[to] - sums[from]) / static_cast<double>(to - from);
  }
  return means;
}

std::size_t two_periods(double frequency_Hz, Seconds dt) {
  return std::max<std::size_t>(2, static_cast<std::size_t>(std::llround(2.0 / (frequency_Hz * dt.value))));
}

/// The samples of a frame under a Hann window, less their straight line.
void take_frame(std::span<const double> samples, std::vector<double>& frame) {
  const auto n = static_cast<double>(samples.size());
  double sum = 0.0, moment = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double at = static_cast<double>(i) - 0.5 * (n - 1.0);
    sum += samples[i];
    moment += at * samples[i];
  }
  const double mean = sum / n, slope = moment / (n * (n * n - 1.0) / 12.0);
  frame.resize(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double at = static_cast<double>(i) - 0.5 * (n - 1.0);
    const double weight = 0.5 - 0.5 * std::cos(two_pi * (static_cast<double>(i) + 0.5) / n);
    frame[i] = weight * (samples[i] - mean - slope * at);
  }
}

}  // namespace

std::vector<double> without_slow(std::span<const double> samples, double frequency_Hz, Seconds dt) {
  const std::size_t width = two_periods(frequency_Hz, dt);
  const auto once = moving_average(samples, width);
  const auto slow = moving_average(std::span<const double>(once), width);
  std::vector<double> fast(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) fast[i] = samples[i] - slow[i];
  return fast;
}

std::vector<Complex> demodulate(std::span<const double> samples, double frequency_Hz, Seconds dt) {
  const std::vector<double> fast = without_slow(samples, frequency_Hz, dt);
  std::vector<Complex> turned(samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    turned[i] = 2.0 * fast[i] * std::polar(1.0, -two_pi * frequency_Hz * static_cast<double>(i) * dt.value);
  }
  const std::size_t width = two_periods(frequency_Hz, dt);
  const auto once = moving_average(std::span<const Complex>(turned), width);
  return moving_average(std::span<const Complex>(once), width);
}

std::vector<Complex> line_in_blocks(std::span<const double> samples, std::size_t block, double frequency_Hz,
                                    Seconds dt) {
  std::vector<Complex> lines;
  std::vector<double> frame;
  for (std::size_t first = 0; first + block <= samples.size(); first += block) {
    take_frame(samples.subspan(first, block), frame);
    Complex sum{};
    for (std::size_t i = 0; i < block; ++i) {
      sum += frame[i] * std::polar(1.0, -two_pi * frequency_Hz * static_cast<double>(first + i) * dt.value);
    }
    lines.push_back(sum * (4.0 / static_cast<double>(block)));  // the window's mean is a half
  }
  return lines;
}

Relation relation(std::span<const Complex> from, std::span<const Complex> to) {
  Complex sum{};
  double count = 0.0;
  for (std::size_t i = 0; i < std::min(from.size(), to.size()); ++i) {
    const Complex cross = std::conj(from[i]) * to[i];
    if (std::abs(cross) > 0.0) sum += cross / std::abs(cross);
    count += 1.0;
  }
  if (count == 0.0) return {};
  const Complex mean = sum / count;
  return {.coherence = std::norm(mean), .angle_rad = std::arg(mean), .alignment = mean.real()};
}

double usual_size(std::span<const Complex> blocks) {
  if (blocks.empty()) return 0.0;
  std::vector<double> sizes(blocks.size());
  std::transform(blocks.begin(), blocks.end(), sizes.begin(), [](const Complex& block) { return std::abs(block); });
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

Spectrogram spectrogram(std::span<const double> samples, std::size_t frame, std::size_t hop, Seconds dt) {
  Spectrogram found;
  identification::RealPairTransform transform(frame);
  for (std::size_t k = 0; k <= frame / 2; ++k) {
    found.frequency_Hz.push_back(static_cast<double>(k) / (static_cast<double>(frame) * dt.value));
  }
  // Mean square of a line under a Hann window: 2·|X|²/(N·Σw²), Σw² = 3N/8.
  const double n = static_cast<double>(frame);
  const double scale = 2.0 / (n * 0.375 * n);
  std::vector<double> windowed;
  for (std::size_t first = 0; first + frame <= samples.size(); first += hop) {
    take_frame(samples.subspan(first, frame), windowed);
    const auto into = transform.samples();
    for (std::size_t m = 0; m < frame / 2; ++m) {
      into[m].re = {windowed[2 * m], windowed[2 * m]};
      into[m].im = {windowed[2 * m + 1], windowed[2 * m + 1]};
    }
    const auto lines = transform.spectra();
    std::vector<double> power(frame / 2 + 1);
    for (std::size_t k = 0; k < power.size(); ++k) {
      power[k] = scale * (lines[k].re[0] * lines[k].re[0] + lines[k].im[0] * lines[k].im[0]);
    }
    found.time_s.push_back((static_cast<double>(first) + 0.5 * n) * dt.value);
    found.power.push_back(std::move(power));
  }
  return found;
}

}  // namespace tactus::diagnosis
