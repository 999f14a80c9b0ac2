// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/margins.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::stability {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double longest_turn_rad = 0.1;

/// How far the loop gain turns between two points, seen from 0 or from −1.
double turned(std::complex<double> a, std::complex<double> b) {
  const auto between = [](std::complex<double> from, std::complex<double> to) {
    return from == 0.0 || to == 0.0 ? 0.0 : std::fabs(std::arg(to * std::conj(from)));
  };
  return std::max(between(a, b), between(1.0 + a, 1.0 + b));
}

/// Where `value`, of different sign at both ends, is zero.
template <class Value>
double zero_between(double lower, double upper, const Value& value) {
  const bool lower_positive = value(lower) > 0.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (lower + upper);
    ((value(middle) > 0.0) == lower_positive ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

struct Minimum {
  double value, at;
};

/// The smallest of `value(L)` along the curve, refined by golden section between the neighbours of the smallest few.
template <class Value>
Minimum smallest(const LoopCurve& curve, const Value& value) {
  const std::size_t n = curve.gain.size();
  std::vector<double> values(n);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) {
    values[i] = value(curve.gain[i]);
    least = std::min(least, values[i]);
  }
  Minimum best{.value = std::numeric_limits<double>::infinity(), .at = 0.0};
  for (std::size_t i = 0; i < n; ++i) {
    const double left = i > 0 ? values[i - 1] : values[i], right = i + 1 < n ? values[i + 1] : values[i];
    if (values[i] > left || values[i] > right || values[i] > 1.05 * least) continue;
    double a = curve.frequency_rad_per_s[i > 0 ? i - 1 : i];
    double b = curve.frequency_rad_per_s[i + 1 < n ? i + 1 : i];
    const double ratio = 1.0 / std::numbers::phi;
    double c = b - ratio * (b - a), d = a + ratio * (b - a);
    double at_c = value(curve.at(c)), at_d = value(curve.at(d));
    for (int round = 0; round < 45; ++round) {
      if (at_c < at_d) {
        b = d;
        d = c;
        at_d = at_c;
        c = b - ratio * (b - a);
        at_c = value(curve.at(c));
      } else {
        a = c;
        c = d;
        at_c = at_d;
        d = a + ratio * (b - a);
        at_d = value(curve.at(d));
      }
    }
    for (const Minimum& candidate : {Minimum{values[i], curve.frequency_rad_per_s[i]}, Minimum{at_c, c}}) {
      if (candidate.value < best.value) best = candidate;
    }
  }
  return best;
}

}  // namespace

LoopCurve trace(std::function<std::complex<double>(double)> at, double tick_s, double lowest_Hz) {
  LoopCurve curve{.at = std::move(at), .frequency_rad_per_s = {}, .gain = {}};
  const double highest = pi / tick_s;
  const double lowest = std::min(2.0 * pi * lowest_Hz, 0.5 * highest);
  constexpr int points = 600;
  const auto add = [&curve](double frequency, std::complex<double> gain) {
    curve.frequency_rad_per_s.push_back(frequency);
    curve.gain.push_back(gain);
  };
  /// Halves until neighbours are close; past that depth a curve has a jump, which none of a rational loop has.
  const std::function<void(double, std::complex<double>, double, std::complex<double>, int)> refine =
      [&](double from, std::complex<double> from_gain, double to, std::complex<double> to_gain, int depth) {
        if (depth > 0 && turned(from_gain, to_gain) > longest_turn_rad) {
          const double middle = 0.5 * (from + to);
          const std::complex<double> middle_gain = curve.at(middle);
          refine(from, from_gain, middle, middle_gain, depth - 1);
          refine(middle, middle_gain, to, to_gain, depth - 1);
          return;
        }
        add(to, to_gain);
      };
  double before = lowest;
  std::complex<double> gain_before = curve.at(before);
  add(before, gain_before);
  for (int i = 1; i <= points; ++i) {
    const double next = i == points ? highest : lowest * std::pow(highest / lowest, i / static_cast<double>(points));
    const std::complex<double> gain = curve.at(next);
    refine(before, gain_before, next, gain, 24);
    before = next;
    gain_before = gain;
  }
  return curve;
}

LoopCurve trace(const Loop& loop) {
  return trace([loop](double frequency) { return loop.at(frequency); }, loop.tick_s);
}

GainMargin gain_margin(const LoopCurve& curve) {
  GainMargin margin;
  const auto consider = [&margin](double frequency, std::complex<double> gain) {
    if (gain.real() < 0.0 && -1.0 / gain.real() < margin.factor) {
      margin = {.factor = -1.0 / gain.real(), .frequency_rad_per_s = frequency};
    }
  };
  for (std::size_t i = 0; i + 1 < curve.gain.size(); ++i) {
    const std::complex<double> a = curve.gain[i], b = curve.gain[i + 1];
    if (std::signbit(a.imag()) == std::signbit(b.imag()) || (a.real() > 0.0 && b.real() > 0.0)) continue;
    const double frequency = zero_between(curve.frequency_rad_per_s[i], curve.frequency_rad_per_s[i + 1],
                                          [&curve](double at) { return curve.at(at).imag(); });
    consider(frequency, curve.at(frequency));
  }
  // Real by themselves, at rest and at half the sample rate; rounding may hide that the sign of Im changes there.
  consider(0.0, curve.at(0.0).real());
  consider(curve.frequency_rad_per_s.back(), curve.gain.back().real());
  return margin;
}

PhaseMargin phase_margin(const LoopCurve& curve) {
  PhaseMargin margin;
  for (std::size_t i = 0; i + 1 < curve.gain.size(); ++i) {
    if ((std::abs(curve.gain[i]) > 1.0) == (std::abs(curve.gain[i + 1]) > 1.0)) continue;
    const double frequency = zero_between(curve.frequency_rad_per_s[i], curve.frequency_rad_per_s[i + 1],
                                          [&curve](double at) { return std::abs(curve.at(at)) - 1.0; });
    // From −1, positive when the loop is not yet there.
    const double ahead = std::arg(-curve.at(frequency));
    if (std::fabs(ahead) < std::fabs(margin.phase_rad)) {
      margin.phase_rad = ahead;
      margin.phase_frequency_rad_per_s = frequency;
    }
    const double delay_s = (ahead >= 0.0 ? ahead : ahead + 2.0 * pi) / frequency;
    if (delay_s < margin.delay_s) {
      margin.delay_s = delay_s;
      margin.delay_frequency_rad_per_s = frequency;
    }
  }
  return margin;
}

ModulusMargin modulus_margin(const LoopCurve& curve) {
  const Minimum minimum = smallest(curve, [](std::complex<double> gain) { return std::abs(1.0 + gain); });
  return {.distance = minimum.value, .frequency_rad_per_s = minimum.at};
}

DiskMargin disk_margin(const LoopCurve& curve) {
  const Minimum minimum =
      smallest(curve, [](std::complex<double> gain) { return 2.0 * std::abs((1.0 + gain) / (1.0 - gain)); });
  return {.alpha = minimum.value, .frequency_rad_per_s = minimum.at};
}

double DiskMargin::gain_factor() const {
  return alpha < 2.0 ? (2.0 + alpha) / (2.0 - alpha) : std::numeric_limits<double>::infinity();
}

double DiskMargin::phase_rad() const { return 2.0 * std::atan(0.5 * alpha); }

int unstable_poles(const LoopCurve& curve) {
  // From rest to half the sample rate is half a turn around the unit circle; the other half is its mirror image.
  double turned_rad = 0.0;
  std::complex<double> before = 1.0 + curve.at(0.0);
  for (const std::complex<double> gain : curve.gain) {
    turned_rad += std::arg((1.0 + gain) * std::conj(before));
    before = 1.0 + gain;
  }
  // Poles of the closed loop within less poles of the open loop within, all of which are: none more by counting.
  return static_cast<int>(std::lround(-turned_rad / pi));
}

bool stable_without_force(const Loop& loop) {
  return poles(loop.master).cwiseAbs().maxCoeff() < 1.0 && poles(loop.slave).cwiseAbs().maxCoeff() < 1.0;
}

GainLimit gain_limit(const Loop& loop) {
  if (!stable_without_force(loop)) return {};
  Loop unit = loop;
  unit.force_gain = 1.0;
  const GainMargin margin = gain_margin(trace(unit));
  return {.force_gain = margin.factor, .frequency_rad_per_s = margin.frequency_rad_per_s};
}

}  // namespace tactus::stability
