// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/contact.hpp>
#include <tactus/kernel/mechanics/servo_valve.hpp>

#include <array>

namespace tactus::mechanics {

/// Friction that falls from its static to its Coulomb value as the piston gets going: f(v) = F_c + (F_s − F_c)·exp(−(v
/// / v_s)²), alongside the viscous part. Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30(7),
/// 1994.
struct StribeckFriction {
  double coulomb_N = 150.0;
  double static_N = 250.0;
  double stribeck_velocity_m_per_s = 0.01;
  double viscous_N_s_per_m = 300.0;
  static constexpr auto fields() {
    using Params = StribeckFriction;
    return List{field("coulomb_N", &Params::coulomb_N, units::newton, non_negative, "F_c, Coulomb friction in motion."),
                field("static_N", &Params::static_N, units::newton, non_negative,
                      "F_s, friction at rest; not below the Coulomb value."),
                field("stribeck_velocity_m_per_s", &Params::stribeck_velocity_m_per_s, units::metre_per_second,
                      positive, "v_s, velocity that characterises the fall from F_s to F_c."),
                field("viscous_N_s_per_m", &Params::viscous_N_s_per_m, units::newton_second_per_metre, non_negative,
                      "Growth of the friction with velocity.")};
  }
};

/// Double-acting cylinder with two chambers of compressible oil behind a servo valve, and the mass that it moves.
///
///     ṗ₁ = β/V₁ (q₁ − A₁ v − c (p₁ − p₂)),   V₁ = V₀ + A₁ (s/2 + x)
///     ṗ₂ = β/V₂ (q₂ + A₂ v + c (p₁ − p₂)),   V₂ = V₀ + A₂ (s/2 − x)
///     m v̇ = A₁ p₁ − A₂ p₂ − friction − end stops,   ẋ = v
///
/// x is 0 at mid-stroke and grows as the first chamber fills. The oil cannot pull: no pressure falls below 0.
///
/// One step of length h is Strang's splitting: half a step of position and pressures at constant velocity (Heun's
/// rule), a step of the velocity with the viscous friction at its midpoint and dry friction as an impulse of at most
/// h·f(v) that holds a piston exactly (Moreau), the other half step. Second order where the motion is smooth. Stable
/// while h is below 2 over the stiffest mode, oil or end stop, and below 1 over the fastest decay of a pressure; `make`
/// refuses a longer step.
///
/// Sized for paper B's rig: 40 mm bore, a 20 mm rod at both ends, 210 bar, so 19.8 kN; 6.8 kg (the paper's); 200 mm of
/// stroke. β = 700 MPa is Merritt's advice for oil with some air in it.
/// Sources: Merritt 1967, section 6.6; Jelali and Kroll 2003, section 4.3.
class HydraulicCylinder {
 public:
  struct Params {
    double first_area_m2 = 9.42e-4;
    double second_area_m2 = 9.42e-4;
    double stroke_m = 0.2;
    double dead_volume_m3 = 2e-5;
    double bulk_modulus_Pa = 7e8;
    double leakage_m3_per_s_per_Pa = 8e-14;
    double supply_Pa = 21e6;
    double tank_Pa = 1e5;
    double mass_kg = 6.8;
    StribeckFriction friction;
    KelvinVoigtContact::Params end_stop{.stiffness_N_per_m = 5e7, .damping_N_s_per_m = 1.1e4};
    static constexpr auto fields() {
      return List{
          field("first_area_m2", &Params::first_area_m2, units::square_metre, positive,
                "Piston area of the chamber that pushes toward +x."),
          field("second_area_m2", &Params::second_area_m2, units::square_metre, positive,
                "Piston area of the other chamber."),
          field("stroke_m", &Params::stroke_m, units::metre, positive, "Distance between the end stops."),
          field(
              "dead_volume_m3", &Params::dead_volume_m3, units::cubic_metre, positive,
              "Volume of oil in a chamber with its hose and valve when the piston is at the end stop of this chamber."),
          field("bulk_modulus_Pa", &Params::bulk_modulus_Pa, units::pascal, positive,
                "Effective bulk modulus of the oil."),
          field("leakage_m3_per_s_per_Pa", &Params::leakage_m3_per_s_per_Pa, units::cubic_metre_per_second_per_pascal,
                non_negative, "Laminar leakage from chamber to chamber."),
          field("supply_Pa", &Params::supply_Pa, units::pascal, positive, "Constant pressure of the pump."),
          field("tank_Pa", &Params::tank_Pa, units::pascal, non_negative,
                "Pressure of the return line; below supply_Pa."),
          field("mass_kg", &Params::mass_kg, units::kilogram, positive, "Mass of piston, rod and load."),
          field("friction", &Params::friction, "Friction of the seals."),
          field("end_stop", &Params::end_stop, "Contact of piston and cylinder at both ends.")};
    }
  };

  struct State {
    double position_m = 0.0;
    double velocity_m_per_s = 0.0;
    std::array<double, 2> pressure_Pa{};
    double end_stop_force_N = 0.0;  ///< on the piston, mean over the last step, positive toward +x
  };

  /// Errors: `inconsistent` for a tank pressure not below the supply's, a static friction below the Coulomb value, or a
  /// step too long, with the longest that would do.
  static Result<HydraulicCylinder> make(const Params& params, const ServoValve& valve, Seconds dt);

  /// Advances by one step with the valve's opening held over it. Real-time safe.
  void step(const ServoValve& valve, double opening) noexcept;
  /// At rest at `position_m`, the pressures balanced.
  void reset(double position_m) noexcept;

  [[nodiscard]] const State& state() const noexcept { return state_; }
  /// What the oil pushes the piston with, in N.
  [[nodiscard]] double pressure_force_N() const noexcept;

 private:
  using Pressures = std::array<double, 2>;
  HydraulicCylinder(const Params& params, const KelvinVoigtContact& end_stop, Seconds dt)
      : params_(params), end_stop_(end_stop), dt_s_(dt.value) {
    reset(0.0);
  }
  [[nodiscard]] Pressures rates(const ServoValve& valve, double opening, double position_m,
                                const Pressures& pressure_Pa) const noexcept;
  void compress(const ServoValve& valve, double opening, double duration_s) noexcept;
  void accelerate() noexcept;
  /// On the piston, positive toward +x.
  double end_stop_force_N() noexcept;

  Params params_;
  KelvinVoigtContact end_stop_;
  double dt_s_;
  State state_;
};

}  // namespace tactus::mechanics
