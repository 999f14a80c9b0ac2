// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/contact.hpp>
#include <tactus/kernel/mechanics/springs.hpp>

#include <array>

namespace tactus::mechanics {

/// Which law the wall pushes back with.
enum class ContactLaw {
  kelvin_voigt,   ///< spring and damper that cannot pull
  hunt_crossley,  ///< damping that grows with depth, no pull either
  bonded,         ///< spring and damper either way: the tip is glued to the surface
};
constexpr std::array<Enumerator<ContactLaw>, 3> enumerators(ContactLaw) {
  return {{{ContactLaw::kelvin_voigt, "kelvin-voigt"},
           {ContactLaw::hunt_crossley, "hunt-crossley"},
           {ContactLaw::bonded, "bonded"}}};
}

/// A wall that the slave's tip can touch: nothing before `position_m`, an elastic body beyond it. Or, bonded, one that
/// the tip is glued to at `position_m`, so that all stays linear.
class Environment {
 public:
  struct Params {
    ContactLaw law = ContactLaw::kelvin_voigt;
    double position_m = 0.0;
    double stiffness_N_per_m = 40000.0;
    double damping_N_s_per_m = 5.0;
    double exponent = 1.5;
    double dissipation_s_per_m = 0.5;
    static constexpr auto fields() {
      return List{
          field("law", &Params::law, "Contact law of the wall; bonded also resists pulling."),
          field("position_m", &Params::position_m, units::metre, between(-1.0, 1.0), "Position of the wall's surface."),
          field("stiffness_N_per_m", &Params::stiffness_N_per_m, units::newton_per_metre, between(0.0, 1e7),
                "Stiffness of the wall; with Hunt-Crossley the secant stiffness at a depth of 0.1 mm."),
          field("damping_N_s_per_m", &Params::damping_N_s_per_m, units::newton_second_per_metre, between(0.0, 1e4),
                "Viscous damping of the wall (not with Hunt-Crossley)."),
          field("exponent", &Params::exponent, units::none, between(1.0, 2.5),
                "Exponent of the force as a function of depth (Hunt-Crossley only)."),
          field("dissipation_s_per_m", &Params::dissipation_s_per_m, units::second_per_metre, between(0.0, 100.0),
                "c: the force of the spring is multiplied by 1 + c times the rate of penetration, at least by 0 "
                "(Hunt-Crossley only).")};
    }
  };
  /// The tip as the wall sees it.
  struct Input {
    double position_m = 0.0;
    double velocity_m_per_s = 0.0;
  };
  using Output = double;

  static Result<Environment> make(const Params& params, Seconds dt);

  /// Force in N with which the wall pushes the tip back, negative only where a bonded one pulls. Real-time safe.
  double step(const Input& tip) noexcept {
    const Penetration depth{.penetration_m = tip.position_m - position_m_, .rate_m_per_s = tip.velocity_m_per_s};
    if (law_ == ContactLaw::bonded) {
      return bond_.step({.deflection_m = depth.penetration_m, .rate_m_per_s = depth.rate_m_per_s});
    }
    return law_ == ContactLaw::kelvin_voigt ? kelvin_voigt_.step(depth) : hunt_crossley_.step(depth);
  }
  double force_N(double position_m, double velocity_m_per_s) noexcept {
    return step({.position_m = position_m, .velocity_m_per_s = velocity_m_per_s});
  }
  void reset() noexcept {}

  [[nodiscard]] double position_m() const noexcept { return position_m_; }

 private:
  Environment(const Params& params, const KelvinVoigtContact& kelvin_voigt, const HuntCrossleyContact& hunt_crossley,
              const LinearSpring& bond)
      : law_(params.law),
        position_m_(params.position_m),
        kelvin_voigt_(kelvin_voigt),
        hunt_crossley_(hunt_crossley),
        bond_(bond) {}

  ContactLaw law_;
  double position_m_;
  KelvinVoigtContact kelvin_voigt_;
  HuntCrossleyContact hunt_crossley_;
  LinearSpring bond_;
};

}  // namespace tactus::mechanics
