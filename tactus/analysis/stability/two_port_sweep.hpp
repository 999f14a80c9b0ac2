// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/two_port.hpp>
#include <tactus/data/report/figure.hpp>

#include <complex>
#include <optional>
#include <vector>

/// A two-port over frequency.
namespace tactus::stability {

/// The two-port of a teleoperator at one frequency, with all that is read off it.
struct TwoPortPoint {
  double frequency_Hz = 0.0;
  HybridMatrix hybrid;
  double llewellyn = 0.0;
  double scattering = 0.0;
  double passivity = 0.0;
  std::complex<double> free_N_s_per_m = {};     ///< what the hand feels in free motion
  std::complex<double> contact_N_s_per_m = {};  ///< what it feels with the tip on the wall
  std::complex<double> wall_N_s_per_m = {};     ///< the wall itself
  std::complex<double> transparency = {};       ///< what it feels on the wall over λ μ times the wall: ideal is 1
};

/// From 0.5 Hz to 0.45 of the servo rate, 46 points a decade. Waves have the impedance of the hand's damper.
struct TwoPortSweep {
  double reference_N_s_per_m = 1.0;
  std::vector<TwoPortPoint> points;

  /// `value` of every point.
  template <class Value>
  [[nodiscard]] std::vector<double> over(const Value& value) const {
    std::vector<double> values;
    values.reserve(points.size());
    for (const TwoPortPoint& point : points) values.push_back(value(point));
    return values;
  }
  /// Up to where the hand feels the wall within 3 dB, from the lowest frequency on; none where not even there.
  [[nodiscard]] std::optional<double> transparent_to_Hz() const;
};

/// Errors: those of `TwoPort::make`.
Result<TwoPortSweep> sweep_two_port(const simulation::Teleoperator::Params& params, const Linearisation& linearisation);

/// The axis of frequency of its pictures.
report::Axis two_port_axis();

/// Transmitted impedance, transparency, absolute stability and passivity over frequency.
report::Figure two_port_figure(const TwoPortSweep& sweep);

}  // namespace tactus::stability
