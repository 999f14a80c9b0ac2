// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/frequency_response.hpp>
#include <tactus/identification/axis/real_pair_transform.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <Eigen/Core>

namespace tactus::identification {
namespace {

using Complex = std::complex<double>;
using ComplexPair = RealPairTransform::ComplexPair;

constexpr double outside_chance = 0.05;
constexpr double infinite = std::numeric_limits<double>::infinity();

Eigen::Map<const Eigen::ArrayXd> as_array(std::span<const double> samples) {
  return {samples.data(), static_cast<Eigen::Index>(samples.size())};
}

Check check_signal(std::span<const double> samples, const std::string& what) {
  if (samples.empty() || (as_array(samples) * 0.0).sum() == 0.0) return std::nullopt;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i])) {
      return Error{
          ErrorCode::out_of_bounds, {}, "sample " + std::to_string(i) + " of the " + what + " is not finite", {}};
    }
  }
  return std::nullopt;
}

bool changes(std::span<const double> samples) {
  return std::any_of(samples.begin(), samples.end(), [&](double sample) { return sample != samples.front(); });
}

Check check_runs(std::span<const InputOutput> runs) {
  if (runs.empty()) return inconsistent("there is no run to estimate from");
  bool input_changes = false;
  bool output_changes = false;
  for (const InputOutput& run : runs) {
    if (run.input.size() != run.output.size()) {
      return inconsistent("the input has " + std::to_string(run.input.size()) + " samples and the output " +
                          std::to_string(run.output.size()) + "; record both at the same instants");
    }
    if (Check error = check_signal(run.input, "input")) return error;
    if (Check error = check_signal(run.output, "output")) return error;
    input_changes = input_changes || changes(run.input);
    output_changes = output_changes || changes(run.output);
  }
  if (!input_changes) return inconsistent("the input never changes, so it excites nothing; name another column");
  if (!output_changes) return inconsistent("the output never changes, so it shows nothing; name another column");
  return std::nullopt;
}

double mean(std::span<const double> samples) { return as_array(samples).mean(); }

/// Square of the 95 % radius of the mean of n complex values with unit variance: F(2, 2n − 2) / n in closed form.
double squared_radius(double n) {
  return n > 1.0 ? (std::pow(outside_chance, -1.0 / (n - 1.0)) - 1.0) * (n - 1.0) / n : infinite;
}

std::vector<double> weights(const SegmentParams& params) {
  std::vector<double> window(static_cast<std::size_t>(params.samples), 1.0);
  if (params.window == Window::rectangular) return window;
  for (std::size_t i = 0; i < window.size(); ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(window.size());
    window[i] = 0.5 - 0.5 * std::cos(angle);
  }
  return window;
}

/// Segments of a run less what they share with their neighbours (Welch 1967, eq. for the variance).
double independent(std::size_t segments, std::size_t step, std::span<const double> window) {
  double power = 0.0;
  for (const double weight : window) power += weight * weight;
  double variance = 1.0;
  for (std::size_t k = 1; k < segments && k * step < window.size(); ++k) {
    double shared = 0.0;
    for (std::size_t i = k * step; i < window.size(); ++i) shared += window[i] * window[i - k * step];
    const double rest = 1.0 - static_cast<double>(k) / static_cast<double>(segments);
    variance += 2.0 * rest * (shared / power) * (shared / power);
  }
  return static_cast<double>(segments) / variance;
}

/// Samples of both signals less their means, weighted; what `window` exceeds them by becomes zeros.
void fill(std::span<ComplexPair> to, std::span<const double> input, std::span<const double> output,
          std::span<const double> window) {
  const double input_mean = mean(input);
  const double output_mean = mean(output);
  const std::size_t whole = input.size() / 2;
  for (std::size_t m = 0; m < whole; ++m) {
    const std::size_t i = 2 * m;
    to[m].re = {window[i] * (input[i] - input_mean), window[i] * (output[i] - output_mean)};
    to[m].im = {window[i + 1] * (input[i + 1] - input_mean), window[i + 1] * (output[i + 1] - output_mean)};
  }
  std::fill(to.begin() + static_cast<std::ptrdiff_t>(whole), to.end(), ComplexPair{});
  if (input.size() % 2 == 1) {
    const std::size_t last = input.size() - 1;
    to[whole].re = {window[last] * (input[last] - input_mean), window[last] * (output[last] - output_mean)};
  }
}

std::vector<double> lines_Hz(std::size_t length, Seconds sample_time) {
  std::vector<double> frequency_Hz(length / 2 + 1);
  const double spacing_Hz = 1.0 / (static_cast<double>(length) * sample_time.value);
  for (std::size_t k = 0; k < frequency_Hz.size(); ++k) frequency_Hz[k] = spacing_Hz * static_cast<double>(k);
  return frequency_Hz;
}

void accumulate(std::span<const ComplexPair> lines, Spectra& sum) {
  double* const input_power = sum.input_power.data();
  double* const output_power = sum.output_power.data();
  Complex* const cross_power = sum.cross_power.data();
  for (std::size_t k = 0; k < lines.size(); ++k) {
    const auto [x_re, y_re] = lines[k].re;
    const auto [x_im, y_im] = lines[k].im;
    input_power[k] += x_re * x_re + x_im * x_im;
    output_power[k] += y_re * y_re + y_im * y_im;
    cross_power[k] += Complex{x_re * y_re + x_im * y_im, x_re * y_im - x_im * y_re};
  }
}

void scale(Spectra& spectra, std::span<const double> window, Seconds sample_time) {
  double power = 0.0;
  for (const double weight : window) power += weight * weight;
  const double two_sided = sample_time.value / (power * static_cast<double>(spectra.segments));
  const std::size_t last = spectra.frequency_Hz.size() - 1;
  for (std::size_t k = 0; k <= last; ++k) {
    const double factor = k == 0 || k == last ? two_sided : 2.0 * two_sided;
    spectra.input_power[k] *= factor;
    spectra.output_power[k] *= factor;
    spectra.cross_power[k] *= factor;
  }
}

double coherence_at(const Spectra& spectra, std::size_t k) {
  const double powers = spectra.input_power[k] * spectra.output_power[k];
  return powers > 0.0 ? std::min(1.0, std::norm(spectra.cross_power[k]) / powers) : 0.0;
}

/// Ratios of output and input, summed over the runs at each line: how many, their sum, the sum of their squares.
FrequencyResponse smooth(std::span<const Complex> sums, std::span<const double> squares, std::span<const double> counts,
                         std::size_t half_width) {
  FrequencyResponse result;
  const std::size_t lines = sums.size();
  result.response.reserve(lines);
  result.radius_95.reserve(lines);
  for (std::size_t k = 0; k < lines; ++k) {
    const std::size_t first = k > half_width ? k - half_width : 0;
    const std::size_t last = std::min(lines - 1, k + half_width);
    Complex sum{};
    double power = 0.0;
    double count = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      sum += sums[i];
      power += squares[i];
      count += counts[i];
    }
    const Complex average = sum / count;
    const double scatter = std::max(0.0, power - count * std::norm(average));
    result.response.push_back(average);
    result.radius_95.push_back(count > 1.0 ? std::sqrt(scatter / (count - 1.0) * squared_radius(count)) : infinite);
  }
  return result;
}

}  // namespace

Result<Spectra> average_spectra(std::span<const InputOutput> runs, Seconds sample_time, const SegmentParams& params) {
  if (Check error = signal::check(params, sample_time)) return *std::move(error);
  const auto length = static_cast<std::size_t>(params.samples);
  if (!std::has_single_bit(length)) {
    return Error{ErrorCode::out_of_bounds,
                 "samples",
                 std::to_string(length) + " is no power of two; take " + std::to_string(std::bit_floor(length)),
                 {}};
  }
  if (Check error = check_runs(runs)) return *std::move(error);
  const auto shared = static_cast<std::size_t>(params.overlap * static_cast<double>(length));
  const std::size_t step = length - shared;
  const auto segments_of = [&](const InputOutput& run) {
    return run.input.size() < length ? std::size_t{0} : (run.input.size() - length) / step + 1;
  };

  Spectra spectra;
  const std::vector<double> window = weights(params);
  std::size_t longest = 0;
  for (const InputOutput& run : runs) {
    const std::size_t segments = segments_of(run);
    longest = std::max(longest, run.input.size());
    spectra.segments += segments;
    if (segments > 0) spectra.independent_segments += independent(segments, step, window);
  }
  if (spectra.segments < 2) {
    return inconsistent("a recording of " + std::to_string(longest) + " samples holds fewer than two segments of " +
                        std::to_string(length) + " samples; record for longer or take shorter segments");
  }

  spectra.frequency_Hz = lines_Hz(length, sample_time);
  spectra.input_power.resize(length / 2 + 1);
  spectra.output_power.resize(length / 2 + 1);
  spectra.cross_power.resize(length / 2 + 1);
  RealPairTransform transform(length);
  for (const InputOutput& run : runs) {
    for (std::size_t segment = 0; segment < segments_of(run); ++segment) {
      fill(transform.samples(), run.input.subspan(segment * step, length), run.output.subspan(segment * step, length),
           window);
      accumulate(transform.spectra(), spectra);
    }
  }
  scale(spectra, window, sample_time);
  return spectra;
}

FrequencyResponse response_h1(const Spectra& spectra) {
  FrequencyResponse result{.frequency_Hz = spectra.frequency_Hz, .response = {}, .radius_95 = {}, .coherence = {}};
  const double n = spectra.independent_segments;
  const double factor = n > 1.0 ? squared_radius(n) * n / (n - 1.0) : infinite;
  for (std::size_t k = 0; k < spectra.frequency_Hz.size(); ++k) {
    const double coherence = coherence_at(spectra, k);
    const double unexplained = (1.0 - coherence) * spectra.output_power[k] / spectra.input_power[k];
    result.response.push_back(spectra.cross_power[k] / spectra.input_power[k]);
    result.radius_95.push_back(std::sqrt(factor * unexplained));
    result.coherence.push_back(coherence);
  }
  return result;
}

FrequencyResponse response_h2(const Spectra& spectra) {
  FrequencyResponse result = response_h1(spectra);
  for (std::size_t k = 0; k < spectra.frequency_Hz.size(); ++k) {
    // H2 = H1 / γ², with the same phase.
    result.response[k] /= result.coherence[k];
    result.radius_95[k] /= result.coherence[k];
  }
  return result;
}

Result<FrequencyResponse> etfe(std::span<const InputOutput> runs, Seconds sample_time, const EtfeParams& params) {
  if (Check error = signal::check(params, sample_time)) return *std::move(error);
  if (params.smoothing_lines % 2 == 0) {
    return Error{ErrorCode::out_of_bounds,
                 "smoothing_lines",
                 std::to_string(params.smoothing_lines) + " has no line in the middle; take an odd number",
                 {}};
  }
  if (Check error = check_runs(runs)) return *std::move(error);
  constexpr std::size_t shortest = 8;
  constexpr std::size_t most = std::size_t{1} << 27U;
  constexpr double smallest_input = 1e-12;
  std::size_t longest = 0;
  for (const InputOutput& run : runs) {
    longest = std::max(longest, run.input.size());
    if (run.input.size() < shortest || run.input.size() > most) {
      return inconsistent("a run of " + std::to_string(run.input.size()) + " samples cannot be used; give it " +
                          std::to_string(shortest) + " to " + std::to_string(most));
    }
  }

  RealPairTransform transform(std::bit_ceil(longest));
  const std::vector<double> window(longest, 1.0);
  const std::size_t lines = transform.length() / 2 + 1;
  std::vector<Complex> sums(lines);
  std::vector<double> squares(lines);
  std::vector<double> counts(lines);
  for (const InputOutput& run : runs) {
    fill(transform.samples(), run.input, run.output, window);
    const std::span<const ComplexPair> spectra = transform.spectra();
    const auto input_power = [](const ComplexPair& line) { return line.re[0] * line.re[0] + line.im[0] * line.im[0]; };
    double largest = 0.0;
    for (const ComplexPair& line : spectra) largest = std::max(largest, input_power(line));
    for (std::size_t k = 1; k < lines; ++k) {  // with the means removed, line 0 holds rounding only
      const double power = input_power(spectra[k]);
      if (power <= largest * smallest_input * smallest_input) continue;
      const auto [x_re, y_re] = spectra[k].re;
      const auto [x_im, y_im] = spectra[k].im;
      const Complex ratio{(x_re * y_re + x_im * y_im) / power, (x_re * y_im - x_im * y_re) / power};
      sums[k] += ratio;
      squares[k] += std::norm(ratio);
      counts[k] += 1.0;
    }
  }
  FrequencyResponse result = smooth(sums, squares, counts, static_cast<std::size_t>(params.smoothing_lines / 2));
  result.frequency_Hz = lines_Hz(transform.length(), sample_time);
  return result;
}

Result<Linearity> judge_linearity(std::span<const FrequencyResponse> responses, double lower_Hz, double upper_Hz) {
  if (responses.size() < 2) return inconsistent("one response has nothing to be compared with; give two or more");
  const std::vector<double>& frequency_Hz = responses.front().frequency_Hz;
  for (const FrequencyResponse& response : responses) {
    if (response.frequency_Hz != frequency_Hz) {
      return inconsistent(
          "the responses have different frequency lines; use the same sample time and segments for all");
    }
  }
  Linearity found;
  std::vector<double> spreads;
  double worst = -1.0;
  double outside = 0.0;
  double pairs = 0.0;
  for (std::size_t k = 0; k < frequency_Hz.size(); ++k) {
    if (frequency_Hz[k] < lower_Hz || frequency_Hz[k] > upper_Hz) continue;
    Complex sum{};
    bool told = true;
    for (const FrequencyResponse& response : responses) {
      sum += response.response[k];
      told = told && response.radius_95[k] < std::abs(response.response[k]);
    }
    if (!told || !std::isfinite(std::abs(sum)) || sum == Complex{}) continue;
    double largest = 0.0;
    for (std::size_t i = 0; i < responses.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double apart = std::abs(responses[i].response[k] - responses[j].response[k]);
        if (apart > std::hypot(responses[i].radius_95[k], responses[j].radius_95[k])) outside += 1.0;
        pairs += 1.0;
        largest = std::max(largest, apart);
      }
    }
    spreads.push_back(largest * static_cast<double>(responses.size()) / std::abs(sum));
    if (spreads.back() > worst) {
      worst = spreads.back();
      found.worst_Hz = frequency_Hz[k];
    }
  }
  if (spreads.empty())
    return inconsistent(
        "on no line between the given frequencies do all responses rise above their bands, so nothing can be compared");
  const auto middle = spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 2);
  std::nth_element(spreads.begin(), middle, spreads.end());
  found.spread = *middle;
  found.lines = spreads.size();
  found.outside = outside / pairs;
  found.linear = found.outside <= 2.0 * outside_chance;
  return found;
}

}  // namespace tactus::identification
