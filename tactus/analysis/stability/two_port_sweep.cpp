// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/two_port_sweep.hpp>

#include <cmath>
#include <numbers>

namespace tactus::stability {

namespace {}  // namespace

report::Axis two_port_axis() { return {.label = "frequency", .unit = "Hz", .scale = report::Axis::Scale::logarithmic}; }

std::optional<double> TwoPortSweep::transparent_to_Hz() const {
  std::optional<double> reached;
  for (const TwoPortPoint& point : points) {
    const double size = std::abs(point.transparency);
    if (size > std::numbers::sqrt2 || size < 1.0 / std::numbers::sqrt2) break;
    reached = point.frequency_Hz;
  }
  return reached;
}

Result<TwoPortSweep> sweep_two_port(const simulation::Teleoperator::Params& params,
                                    const Linearisation& linearisation) {
  const auto port = TwoPort::make(params, linearisation);
  if (!port) return port.error();
  const TipLoad wall = wall_load(params.environment, linearisation.preload_N);
  const double ideal = params.control.position_scale * params.control.force_gain;
  TwoPortSweep sweep;
  if (params.person.grip.damping_N_s_per_m > 0.0) sweep.reference_N_s_per_m = params.person.grip.damping_N_s_per_m;
  const double step = std::pow(10.0, 1.0 / 46.0);
  for (double f = 0.5; f <= 0.45 * params.servo.rate_Hz; f *= step) {
    TwoPortPoint point{.frequency_Hz = f, .hybrid = port->at(turn * f)};
    point.llewellyn = llewellyn_index(point.hybrid);
    point.scattering = scattering_norm(point.hybrid, sweep.reference_N_s_per_m);
    point.passivity = passivity_index(point.hybrid, sweep.reference_N_s_per_m);
    point.wall_N_s_per_m = wall.damping_N_s_per_m + wall.stiffness_N_per_m / std::complex<double>(0.0, turn * f);
    point.free_N_s_per_m = transmitted_impedance(point.hybrid, 0.0);
    point.contact_N_s_per_m = transmitted_impedance(point.hybrid, point.wall_N_s_per_m);
    point.transparency = point.contact_N_s_per_m / (ideal * point.wall_N_s_per_m);
    sweep.points.push_back(point);
  }
  return sweep;
}

report::Figure two_port_figure(const TwoPortSweep& sweep) {
  const auto hertz = sweep.over([](const TwoPortPoint& point) { return point.frequency_Hz; });
  const auto size = [&sweep](auto member) {
    return sweep.over([member](const TwoPortPoint& point) { return std::abs(point.*member); });
  };
  const auto logarithmic = report::Axis::Scale::logarithmic;
  report::Figure figure{
      .title = "Two-port",
      .caption =
          "What the hand feels in free motion and on the wall, compared with the wall itself; transparent is "
          "where what it feels is lambda mu times the wall, 0 dB and 0 degrees. Stable between all "
          "passive ends where Llewellyn's index is at least 1, passive where the scattering norm is at "
          "most 1.",
      .columns = 1,
      .panels = {}};
  figure.panels.push_back({"Transmitted impedance",
                           two_port_axis(),
                           {.label = "impedance", .unit = "N s/m", .scale = logarithmic},
                           {{"free", hertz, size(&TwoPortPoint::free_N_s_per_m), 0},
                            {"on the wall", hertz, size(&TwoPortPoint::contact_N_s_per_m), 1},
                            {"the wall", hertz, size(&TwoPortPoint::wall_N_s_per_m), 2, report::Dash::dashed}},
                           {}});
  figure.panels.push_back(
      {"Transparency",
       two_port_axis(),
       {.label = "felt over ideal", .unit = "dB"},
       {{"", hertz,
         sweep.over([](const TwoPortPoint& point) { return 20.0 * std::log10(std::abs(point.transparency)); }), 1}},
       {{.at = 0.0, .label = "bound"}}});
  figure.panels.push_back({"Absolute stability",
                           two_port_axis(),
                           {.label = "Llewellyn's index", .lower = -1.5, .upper = 3.0},
                           {{"", hertz, sweep.over([](const TwoPortPoint& point) { return point.llewellyn; }), 3}},
                           {{.at = 1.0, .label = "bound"}}});
  figure.panels.push_back({"Passivity",
                           two_port_axis(),
                           {.label = "scattering norm", .scale = logarithmic},
                           {{"", hertz, sweep.over([](const TwoPortPoint& point) { return point.scattering; }), 4}},
                           {{.at = 1.0, .label = "bound"}}});
  return figure;
}

}  // namespace tactus::stability
