// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::mechanics {

/// Two-stage electrohydraulic servo valve with four edges.
///
/// The spool follows the current as a second-order system, ẍ = ω² (u − x) − 2 ζ ω ẋ with u = clamp(i / i_rated, ±1),
/// and stops at ±1. Within its overlap nothing flows: the opening is x less the dead band. Through an edge flows
///
///     q = k · opening · Δp / (Δp² + p_t²)^(1/4)  →  k · opening · √Δp · sign(Δp)  for |Δp| ≫ p_t,
///
/// turbulent orifice flow with a laminar one around no pressure drop, where the root has no slope; k follows from the
/// rated flow, for which two edges share the rated drop. A small laminar leakage past every edge centres the pressures.
///
/// The defaults are those of a two-stage valve of 19 l/min at 70 bar and 15 mA, as data sheets of the paper's series
/// state them: 100 Hz, 2 % overlap (lap is specified within ±3 %), about half a litre a minute of null leakage.
/// Sources: H. E. Merritt, Hydraulic Control Systems, Wiley 1967, sections 5.3 and 7.4; M. Jelali and A. Kroll,
/// Hydraulic Servo-systems, Springer 2003, section 4.2.
class ServoValve {
 public:
  struct Params {
    double rated_current_mA = 15.0;
    double rated_flow_m3_per_s = 3.17e-4;
    double rated_drop_Pa = 7e6;
    double natural_frequency_Hz = 100.0;
    double damping_ratio = 0.8;
    double overlap = 0.02;
    double leakage_m3_per_s_per_Pa = 4e-13;
    double transition_Pa = 1e5;
    static constexpr auto fields() {
      return List{
          field("rated_current_mA", &Params::rated_current_mA, units::milliampere, positive,
                "Current that opens the valve fully; more has no effect."),
          field("rated_flow_m3_per_s", &Params::rated_flow_m3_per_s, units::cubic_metre_per_second, positive,
                "Flow through the fully open valve at rated_drop_Pa."),
          field("rated_drop_Pa", &Params::rated_drop_Pa, units::pascal, positive,
                "Total pressure drop over both edges at the rated flow."),
          field("natural_frequency_Hz", &Params::natural_frequency_Hz, units::hertz, positive,
                "Natural frequency of the spool."),
          field("damping_ratio", &Params::damping_ratio, units::none, between(0.05, 2.0),
                "Damping ratio of the spool."),
          field("overlap", &Params::overlap, units::none, between(0.0, 0.5),
                "Share of the spool's stroke, in each direction from the centre, without flow."),
          field("leakage_m3_per_s_per_Pa", &Params::leakage_m3_per_s_per_Pa, units::cubic_metre_per_second_per_pascal,
                non_negative, "Laminar leakage past each of the four edges."),
          field("transition_Pa", &Params::transition_Pa, units::pascal, positive,
                "Pressure drop below which the flow is laminar.")};
    }
  };
  using Input = double;
  using Output = double;

  static Result<ServoValve> make(const Params& params, Seconds dt) {
    if (Check error = signal::check(params, dt)) return *std::move(error);
    return ServoValve(params, dt);
  }

  /// Advances the spool by one step under `current_mA`, held over it, and returns the opening at the end, between −1
  /// and 1 and positive when it feeds the first chamber. Implicit midpoint: second order, stable at every step.
  /// Real-time safe.
  double step(double current_mA) noexcept {
    const double wanted = std::clamp(current_mA / params_.rated_current_mA, -1.0, 1.0);
    const double before_per_s = velocity_per_s_;
    velocity_per_s_ = ((1.0 - damping_ - stiffness_) * velocity_per_s_ + drive_per_s_ * (wanted - spool_)) /
                      (1.0 + damping_ + stiffness_);
    spool_ += half_s_ * (before_per_s + velocity_per_s_);
    const double stopped = std::clamp(spool_, -1.0, 1.0);
    if (stopped != spool_) velocity_per_s_ = 0.0;
    spool_ = stopped;
    return opening();
  }
  void reset() noexcept { spool_ = velocity_per_s_ = 0.0; }

  /// Share of the stroke that is open.
  [[nodiscard]] double opening() const noexcept {
    return spool_ - std::clamp(spool_, -params_.overlap, params_.overlap);
  }

  /// Flow in m³/s into a chamber at `pressure_Pa`, that is fed for an `opening` above 0 and drained for one below.
  /// Real-time safe.
  [[nodiscard]] double flow_into(double pressure_Pa, double opening, double supply_Pa, double tank_Pa) const noexcept {
    const double drop_Pa = opening > 0.0 ? supply_Pa - pressure_Pa : pressure_Pa - tank_Pa;
    return flow_gain_ * opening * drop_Pa / std::sqrt(std::hypot(drop_Pa, params_.transition_Pa)) +
           params_.leakage_m3_per_s_per_Pa * (supply_Pa + tank_Pa - 2.0 * pressure_Pa);
  }
  /// The greatest slope in m³/(s Pa) of that flow over the pressure: of the open valve where nothing drops.
  [[nodiscard]] double steepest_flow() const noexcept {
    return flow_gain_ / std::sqrt(params_.transition_Pa) + 2.0 * params_.leakage_m3_per_s_per_Pa;
  }

 private:
  ServoValve(const Params& params, Seconds dt)
      : params_(params),
        half_s_(0.5 * dt.value),
        flow_gain_(params.rated_flow_m3_per_s / std::sqrt(0.5 * params.rated_drop_Pa)) {
    const double omega = 2.0 * std::numbers::pi * params.natural_frequency_Hz;
    damping_ = params.damping_ratio * omega * dt.value;
    stiffness_ = 0.25 * omega * omega * dt.value * dt.value;
    drive_per_s_ = omega * omega * dt.value;
  }

  Params params_;
  double half_s_;
  double flow_gain_;  ///< k, in m³/(s √Pa)
  double damping_, stiffness_, drive_per_s_;
  double spool_ = 0.0;
  double velocity_per_s_ = 0.0;
};

}  // namespace tactus::mechanics
