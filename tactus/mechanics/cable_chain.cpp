#include <tactus/mechanics/cable_chain.hpp>

namespace tactus::mechanics {

Result<CableChain> CableChain::make(const Params& params, Seconds dt) { return make(params, nobody_holds, dt); }

Result<CableChain> CableChain::make(const Params& params, const LinearSpring::Params& grip, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (auto error = validate(grip)) return under("grip", *std::move(error));
  const auto linkage = ElastoSlipSpring::make(params.linkage, dt);
  if (!linkage) return under("linkage", linkage.error());
  return CableChain(params, grip, dt, *linkage);
}

CableChain::CableChain(const Params& params, const LinearSpring::Params& grip, Seconds dt,
                       const ElastoSlipSpring& linkage)
    : mass_kg_{params.motor.mass_kg, params.drum.mass_kg, params.tip.mass_kg},
      friction_N_{params.motor.friction_N, params.drum.friction_N},
      cable_(params.cable),
      grip_(grip),
      step_(step_of(dt.value)),
      state_{.linkage = linkage} {}

CableChain::Step CableChain::step_of(double duration_s) const noexcept {
  const double half = 0.5 * duration_s;
  // M + h/2 B: the cable couples motor and drum; the tip stands alone because the linkage's damping is explicit.
  const double a = mass_kg_[0] + half * cable_.damping_N_s_per_m;
  const double b = -half * cable_.damping_N_s_per_m;
  const double c = mass_kg_[1] + half * cable_.damping_N_s_per_m;
  const double determinant = a * c - b * b;
  return {.h_s = duration_s,
          .half_s = half,
          .cable_damping = half * cable_.damping_N_s_per_m,
          .tip_momentum_kg = mass_kg_[2] - half * grip_.damping_N_s_per_m,
          .i00 = c / determinant,
          .i01 = -b / determinant,
          .i11 = a / determinant,
          .i22 = 1.0 / (mass_kg_[2] + half * grip_.damping_N_s_per_m),
          .drum_on_motor = -b / c,
          .motor_on_drum = -b / a,
          .motor_impulse = duration_s * friction_N_[0],
          .drum_impulse = duration_s * friction_N_[1]};
}

void CableChain::reset(double position_m) noexcept {
  state_.position_m.fill(position_m);
  state_.velocity_m_per_s.fill(0.0);
  state_.linkage.reset();
}

}  // namespace tactus::mechanics
