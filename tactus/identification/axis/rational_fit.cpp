// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/linear_fit.hpp>
#include <tactus/identification/axis/rational_fit.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace tactus::identification {

namespace {

using signal::RationalFilter;
using signal::RationalFunction;
using Coefficients = RationalFunction::Coefficients;
constexpr std::size_t order = 4;

std::vector<double> simulate(const RationalFilter& made, std::span<const double> input) {
  RationalFilter filter = made;
  std::vector<double> output;
  output.reserve(input.size());
  for (const double sample : input) output.push_back(filter.step(sample));
  return output;
}

/// The same polynomial with its roots right of the imaginary axis (or on it) moved to the left of it.
Coefficients stabilised(const Coefficients& monic) {
  std::array<double, order * order> companion{};
  for (std::size_t i = 0; i < order; ++i) companion[order * i + order - 1] = -monic[i];
  for (std::size_t i = 1; i < order; ++i) companion[order * i + i - 1] = 1.0;
  std::array<std::complex<double>, order + 1> product{1.0};
  for (const std::complex<double> root : signal::eigenvalues(companion, order)) {
    const double left = -std::max(std::abs(root.real()), 1e-6 * (1.0 + std::abs(root)));
    const std::complex<double> moved(left, root.imag());
    for (std::size_t i = order + 1; i-- > 0;) product[i] = (i > 0 ? product[i - 1] : 0.0) - moved * product[i];
  }
  Coefficients ascending{};
  for (std::size_t i = 0; i <= order; ++i) ascending[i] = product[i].real();
  return ascending;
}

/// s^power / A(s) behind `input`, in a time in which the start frequency is 1 rad per unit.
Result<std::vector<double>> filtered(std::span<const double> input, std::size_t power, const Coefficients& denominator,
                                     Seconds dt) {
  Coefficients numerator{};
  numerator[power] = 1.0;
  const auto filter = RationalFilter::make(RationalFunction::of(numerator, denominator), dt);
  if (!filter) return filter.error();
  return simulate(*filter, input);
}

/// The numerator over a given denominator that leaves the least output error.
Result<Coefficients> fit_numerator(std::span<const double> input, std::span<const double> output,
                                   const Coefficients& denominator, Seconds dt) {
  std::vector<double> regressors((order + 1) * input.size());
  for (std::size_t power = 0; power <= order; ++power) {
    const auto column = filtered(input, power, denominator, dt);
    if (!column) return column.error();
    for (std::size_t i = 0; i < input.size(); ++i) regressors[(order + 1) * i + power] = (*column)[i];
  }
  const auto fit = fit_linear(regressors, order + 1, output);
  if (!fit) return fit.error();
  Coefficients numerator{};
  for (std::size_t i = 0; i <= order; ++i) numerator[i] = fit->parameters[i];
  return numerator;
}

}  // namespace

Result<RationalFit> fit_rational(std::span<const double> input, std::span<const double> output, Seconds dt,
                                 double start_frequency_Hz, int rounds) {
  if (input.size() != output.size() || input.size() < 100) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = "a fit of the fourth order needs as many outputs as inputs, and at least 100",
                 .place = {}};
  }
  const double rate = 2.0 * std::numbers::pi * start_frequency_Hz;
  const Seconds scaled{dt.value * rate};
  Coefficients denominator{1.0, 4.0, 6.0, 4.0, 1.0};
  std::optional<RationalFit> best;
  for (int round = 1; round <= rounds; ++round) {
    constexpr std::size_t columns = 2 * order + 1;
    std::vector<double> regressors(columns * input.size()), observations;
    for (std::size_t power = 0; power <= order; ++power) {
      const auto of_input = filtered(input, power, denominator, scaled);
      if (!of_input) return of_input.error();
      auto of_output = filtered(output, power, denominator, scaled);
      if (!of_output) return of_output.error();
      for (std::size_t i = 0; i < input.size(); ++i) {
        regressors[columns * i + power] = (*of_input)[i];
        if (power < order) regressors[columns * i + order + 1 + power] = -(*of_output)[i];
      }
      if (power == order) observations = *std::move(of_output);
    }
    const auto fit = fit_linear(regressors, columns, observations);
    if (!fit) {
      if (best) break;
      return fit.error();
    }
    for (std::size_t i = 0; i < order; ++i) denominator[i] = fit->parameters[order + 1 + i];
    denominator[order] = 1.0;
    const bool moved = !signal::is_hurwitz(denominator);
    if (moved) denominator = stabilised(denominator);
    const auto numerator_fit = fit_numerator(input, output, denominator, scaled);
    if (!numerator_fit) break;
    const Coefficients numerator = *numerator_fit;
    const auto filter = RationalFilter::make(RationalFunction::of(numerator, denominator), scaled);
    if (!filter) break;
    const std::vector<double> simulated = simulate(*filter, input);
    double sum = 0.0;
    for (std::size_t i = 0; i < output.size(); ++i) sum += std::pow(simulated[i] - output[i], 2);
    const double rms = std::sqrt(sum / static_cast<double>(output.size()));
    if (best && !(rms < best->residual_rms)) continue;
    Coefficients n{}, d{};
    for (std::size_t i = 0; i <= order; ++i) {
      n[i] = numerator[i] / std::pow(rate, static_cast<double>(i));
      d[i] = denominator[i] / std::pow(rate, static_cast<double>(i));
    }
    best =
        RationalFit{.function = RationalFunction::of(n, d), .residual_rms = rms, .round = round, .moved_poles = moved};
  }
  if (!best) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "no round of the fit gave a usable transfer function: try another start frequency",
                 .place = {}};
  }
  return *best;
}

}  // namespace tactus::identification
