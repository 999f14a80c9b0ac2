#include <tactus/mechanics/cable_chain.hpp>

#include <algorithm>

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
      dt_s_(dt.value),
      step_inverse_(invert(dt.value)),
      state_{.linkage = linkage} {}

CableChain::Inverse CableChain::invert(double duration_s) const noexcept {
  const double half = 0.5 * duration_s;
  // M + h/2 B: the cable couples motor and drum; the tip stands alone because the linkage's damping is explicit.
  const double a = mass_kg_[0] + half * cable_.damping_N_s_per_m;
  const double b = -half * cable_.damping_N_s_per_m;
  const double c = mass_kg_[1] + half * cable_.damping_N_s_per_m;
  const double determinant = a * c - b * b;
  return {.i00 = c / determinant,
          .i01 = -b / determinant,
          .i11 = a / determinant,
          .i22 = 1.0 / (mass_kg_[2] + half * grip_.damping_N_s_per_m),
          .effective_mass0 = determinant / c,
          .effective_mass1 = determinant / a};
}

CableChain::Output CableChain::step(const Input& input) noexcept {
  advance(input, dt_s_, step_inverse_);
  return {.motor_position_m = state_.position_m[0], .tip_position_m = state_.position_m[2]};
}

void CableChain::advance(const Input& input, double duration_s) noexcept {
  advance(input, duration_s, invert(duration_s));
}

void CableChain::advance(const Input& input, double h, const Inverse& inverse) noexcept {
  auto& x = state_.position_m;
  auto& v = state_.velocity_m_per_s;
  const double half = 0.5 * h;
  for (std::size_t i = 0; i < 3; ++i) x[i] += half * v[i];

  const double cable_force = cable_.stiffness_N_per_m * (x[0] - x[1]);
  const double linkage_force = state_.linkage.step({.deflection_m = x[1] - x[2], .rate_m_per_s = v[1] - v[2]});
  const double grip_force =
      grip_.stiffness_N_per_m * (input.grip_position_m - x[2]) + grip_.damping_N_s_per_m * input.grip_velocity_m_per_s;

  const double cable_damping = half * cable_.damping_N_s_per_m * (v[0] - v[1]);
  const double p0 = mass_kg_[0] * v[0] - cable_damping + h * (input.motor_force_N - cable_force);
  const double p1 = mass_kg_[1] * v[1] + cable_damping + h * (cable_force - linkage_force);
  const double p2 =
      (mass_kg_[2] - half * grip_.damping_N_s_per_m) * v[2] + h * (linkage_force + grip_force + input.tip_force_N);

  const double v0_free = inverse.i00 * p0 + inverse.i01 * p1;
  const double v1_free = inverse.i01 * p0 + inverse.i11 * p1;
  const double limit0 = h * friction_N_[0];
  const double limit1 = h * friction_N_[1];
  double impulse0 = std::clamp(-inverse.effective_mass0 * v0_free, -limit0, limit0);
  double impulse1 = std::clamp(-inverse.effective_mass1 * (v1_free + inverse.i01 * impulse0), -limit1, limit1);
  impulse0 = std::clamp(-inverse.effective_mass0 * (v0_free + inverse.i01 * impulse1), -limit0, limit0);
  impulse1 = std::clamp(-inverse.effective_mass1 * (v1_free + inverse.i01 * impulse0), -limit1, limit1);

  v[0] = v0_free + inverse.i00 * impulse0 + inverse.i01 * impulse1;
  v[1] = v1_free + inverse.i01 * impulse0 + inverse.i11 * impulse1;
  v[2] = inverse.i22 * p2;
  for (std::size_t i = 0; i < 3; ++i) x[i] += half * v[i];
}

void CableChain::reset(double position_m) noexcept {
  state_.position_m.fill(position_m);
  state_.velocity_m_per_s.fill(0.0);
  state_.linkage.reset();
}

}  // namespace tactus::mechanics
