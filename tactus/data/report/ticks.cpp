// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/data/report/ticks.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::report {
namespace {

std::string label_of(double value, int decimals) {
  std::string label = fixed(value, decimals);
  if (label.front() == '-') label.replace(0, 1, "−");
  return label;
}

/// factor·10^exponent, correctly rounded: dividing by a positive power of ten keeps 0.3 equal to 3e-1.
double scaled(double factor, int exponent) {
  return exponent < 0 ? factor / std::pow(10.0, -exponent) : factor * std::pow(10.0, exponent);
}

struct Step {
  int factor;
  int exponent;
  Step next() const {
    return factor == 1 ? Step{2, exponent} : factor == 2 ? Step{5, exponent} : Step{1, exponent + 1};
  }
};

/// Index range of the multiples of a step within the limits, forgiving the last bits of a division.
struct Indices {
  double first, last;
};
Indices multiples(Step step, double lower, double upper) {
  const double size = scaled(step.factor, step.exponent);
  const double slack = 1e-9;
  return {std::ceil(lower / size - slack), std::floor(upper / size + slack)};
}

int decade_below(double value) { return static_cast<int>(std::floor(std::log10(value) + 1e-12)); }
int decade_above(double value) { return static_cast<int>(std::ceil(std::log10(value) - 1e-12)); }

/// Labels of 1, 2 or 5 times a power of ten: all as plain numbers where the axis spans readable magnitudes.
std::string decade_label(int factor, int exponent, bool plain) {
  if (plain) return label_of(scaled(factor, exponent), std::max(0, -exponent));
  return (factor == 1 ? "" : std::to_string(factor) + "×") + power_of_ten(exponent);
}

}  // namespace

Ticks linear_ticks(double lower, double upper, int most) {
  most = std::max(most, 2);
  Step step{1, decade_below(upper / most - lower / most) - 1};
  Indices indices = multiples(step, lower, upper);
  while (indices.last - indices.first + 1 > most) {
    step = step.next();
    indices = multiples(step, lower, upper);
  }

  Ticks ticks;
  const double largest = std::max(std::abs(lower), std::abs(upper));
  if (largest >= 1e5 || largest < 1e-3) ticks.exponent = 3 * static_cast<int>(std::floor(decade_below(largest) / 3.0));
  const int shown_exponent = step.exponent - ticks.exponent;
  const int count = static_cast<int>(indices.last - indices.first) + 1;
  for (int i = 0; i < count; ++i) {
    const double multiple = (indices.first + i) * step.factor;
    ticks.major.push_back(scaled(multiple, step.exponent));
    ticks.labels.push_back(label_of(scaled(multiple, shown_exponent), std::max(0, -shown_exponent)));
  }
  return ticks;
}

Ticks logarithmic_ticks(double lower, double upper, int most) {
  most = std::max(most, 2);
  const int first = decade_above(lower);
  const int last = decade_below(upper);
  const bool plain = first >= -4 && last <= 4;
  const bool sparse = last - first < 1;

  Ticks ticks;
  const int stride = std::max(1, (last - first) / most + 1);
  for (int exponent = decade_below(lower); exponent <= last; ++exponent) {
    for (int factor = 1; factor <= 9; ++factor) {
      const double value = scaled(factor, exponent);
      if (value < lower * (1 - 1e-12) || value > upper * (1 + 1e-12)) continue;
      const bool subdivision = sparse && (factor == 2 || factor == 5);
      if ((factor == 1 && (exponent - first) % stride == 0) || subdivision) {
        ticks.major.push_back(value);
        ticks.labels.push_back(decade_label(factor, exponent, plain));
      } else if (stride == 1 || factor == 1) {
        ticks.minor.push_back(value);
      }
    }
  }
  return ticks.major.size() < 2 ? linear_ticks(lower, upper, most) : ticks;
}

Limits axis_limits(std::optional<Limits> data, std::optional<double> lower, std::optional<double> upper,
                   bool logarithmic, double margin) {
  constexpr double largest = 1e300;
  constexpr double smallest = 1e-280;  // powers of ten below a span of this size still are normal numbers
  const auto usable = [&](const std::optional<double>& limit) {
    return limit && std::isfinite(*limit) && std::abs(*limit) <= largest && (!logarithmic || *limit >= smallest);
  };
  bool lower_set = usable(lower);
  bool upper_set = usable(upper);
  const auto negligible = [&](double from, double to) {
    return to - from <= std::max(1e-12 * std::max(std::abs(from), std::abs(to)), smallest);
  };

  // Work in the space in which the axis is even: the value, or its logarithm.
  const auto even = [&](double value) { return logarithmic ? std::log10(value) : value; };
  const double cap = even(largest);
  const double floor = logarithmic ? even(smallest) : -largest;
  if (lower_set && upper_set && negligible(even(*lower), even(*upper))) lower_set = upper_set = false;
  Limits limits{0.0, 1.0};
  if (data) limits = {std::clamp(even(data->lower), floor, cap), std::clamp(even(data->upper), floor, cap)};
  const bool known = data.has_value();
  if (lower_set) {
    limits.lower = even(*lower);
    if (!known || limits.upper < limits.lower) limits.upper = limits.lower;
  }
  if (upper_set) {
    limits.upper = even(*upper);
    if ((!known && !lower_set) || limits.lower > limits.upper) limits.lower = limits.upper;
  }

  const double magnitude = std::max(std::abs(limits.lower), std::abs(limits.upper));
  double air = margin * (limits.upper - limits.lower);
  if (negligible(limits.lower, limits.upper)) {
    air = logarithmic ? 0.5 : magnitude > smallest ? 0.5 * magnitude : 1.0;
  } else if (!known) {
    air = 0.0;
  }
  if (!lower_set) limits.lower = std::max(limits.lower - air, floor);
  if (!upper_set) limits.upper = std::min(limits.upper + air, cap);
  if (logarithmic) {
    return {lower_set ? *lower : std::pow(10.0, limits.lower), upper_set ? *upper : std::pow(10.0, limits.upper)};
  }
  return limits;
}

}  // namespace tactus::report
