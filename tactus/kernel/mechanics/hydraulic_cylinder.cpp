// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/hydraulic_cylinder.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::mechanics {

namespace {

/// A piston that is pushed into its end stop leaves at least this share of the dead volume: below it the volume is
/// held, so that no input makes it negative.
constexpr double least_volume_share = 0.5;

}  // namespace

Result<HydraulicCylinder> HydraulicCylinder::make(const Params& params, const ServoValve& valve, Seconds dt) {
  if (Check error = signal::check(params, dt)) return *std::move(error);
  if (params.tank_Pa >= params.supply_Pa) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "tank_Pa",
                 .message = rounded_number(params.tank_Pa) + " Pa is not below the supply's " +
                            rounded_number(params.supply_Pa) + " Pa",
                 .place = {}};
  }
  if (params.friction.static_N < params.friction.coulomb_N) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "friction.static_N",
                 .message = rounded_number(params.friction.static_N) + " N is below the Coulomb friction of " +
                            rounded_number(params.friction.coulomb_N) + " N; give at least that",
                 .place = {}};
  }
  const double oil = params.bulk_modulus_Pa / (least_volume_share * params.dead_volume_m3);
  const double stiffness =
      oil * (params.first_area_m2 * params.first_area_m2 + params.second_area_m2 * params.second_area_m2) +
      params.end_stop.stiffness_N_per_m;
  const double damping = params.end_stop.damping_N_s_per_m / params.mass_kg;
  const double by_mode_s = 2.0 / (std::sqrt(stiffness / params.mass_kg) + damping);
  const double by_flow_s = 1.0 / (oil * (valve.steepest_flow() + 2.0 * params.leakage_m3_per_s_per_Pa));
  const bool flow_is_faster = by_flow_s < by_mode_s;
  const double longest_s = std::min(by_mode_s, by_flow_s);
  if (dt.value > longest_s) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = flow_is_faster ? "dead_volume_m3" : "mass_kg",
                 .message = std::string(flow_is_faster ? "the pressure of so little oil changes too fast"
                                                       : "oil and end stops are too stiff for so little mass") +
                            " for a step of " + rounded_number(dt.value) + " s; steps of at most " +
                            rounded_number(longest_s) + " s would do",
                 .place = {}};
  }
  const auto end_stop = KelvinVoigtContact::make(params.end_stop, dt);
  if (!end_stop) return under("end_stop", end_stop.error());
  return HydraulicCylinder(params, *end_stop, dt);
}

void HydraulicCylinder::reset(double position_m) noexcept {
  const double whole_Pa = params_.supply_Pa + params_.tank_Pa;
  const double both_m2 = params_.first_area_m2 + params_.second_area_m2;
  state_ = {.position_m = position_m,
            .velocity_m_per_s = 0.0,
            .pressure_Pa = {whole_Pa * params_.second_area_m2 / both_m2, whole_Pa * params_.first_area_m2 / both_m2},
            .end_stop_force_N = 0.0};
}

double HydraulicCylinder::pressure_force_N() const noexcept {
  return params_.first_area_m2 * state_.pressure_Pa[0] - params_.second_area_m2 * state_.pressure_Pa[1];
}

HydraulicCylinder::Pressures HydraulicCylinder::rates(const ServoValve& valve, double opening, double position_m,
                                                      const Pressures& pressure_Pa) const noexcept {
  const double half_m = 0.5 * params_.stroke_m;
  const double least_m3 = least_volume_share * params_.dead_volume_m3;
  const double first_m3 = std::max(least_m3, params_.dead_volume_m3 + params_.first_area_m2 * (half_m + position_m));
  const double second_m3 = std::max(least_m3, params_.dead_volume_m3 + params_.second_area_m2 * (half_m - position_m));
  const double across = params_.leakage_m3_per_s_per_Pa * (pressure_Pa[0] - pressure_Pa[1]);
  const double into_first = valve.flow_into(pressure_Pa[0], opening, params_.supply_Pa, params_.tank_Pa);
  const double into_second = valve.flow_into(pressure_Pa[1], -opening, params_.supply_Pa, params_.tank_Pa);
  return {
      params_.bulk_modulus_Pa / first_m3 * (into_first - params_.first_area_m2 * state_.velocity_m_per_s - across),
      params_.bulk_modulus_Pa / second_m3 * (into_second + params_.second_area_m2 * state_.velocity_m_per_s + across)};
}

void HydraulicCylinder::compress(const ServoValve& valve, double opening, double duration_s) noexcept {
  const double there_m = state_.position_m + duration_s * state_.velocity_m_per_s;
  const Pressures here = rates(valve, opening, state_.position_m, state_.pressure_Pa);
  const Pressures reached{state_.pressure_Pa[0] + duration_s * here[0], state_.pressure_Pa[1] + duration_s * here[1]};
  const Pressures there = rates(valve, opening, there_m, reached);
  for (std::size_t i = 0; i < 2; ++i) {
    state_.pressure_Pa[i] = std::max(0.0, state_.pressure_Pa[i] + 0.5 * duration_s * (here[i] + there[i]));
  }
  state_.position_m = there_m;
}

double HydraulicCylinder::end_stop_force_N() noexcept {
  const double half_m = 0.5 * params_.stroke_m;
  const double x_m = state_.position_m, v_m_per_s = state_.velocity_m_per_s;
  return end_stop_.step({.penetration_m = -half_m - x_m, .rate_m_per_s = -v_m_per_s}) -
         end_stop_.step({.penetration_m = x_m - half_m, .rate_m_per_s = v_m_per_s});
}

void HydraulicCylinder::accelerate() noexcept {
  const StribeckFriction& friction = params_.friction;
  const double before = state_.velocity_m_per_s;
  state_.end_stop_force_N = end_stop_force_N();
  const double viscous = 0.5 * dt_s_ * friction.viscous_N_s_per_m;
  const double momentum = (params_.mass_kg - viscous) * before + dt_s_ * (pressure_force_N() + state_.end_stop_force_N);
  const double slowness = before / friction.stribeck_velocity_m_per_s;
  const double most =
      dt_s_ * (friction.coulomb_N + (friction.static_N - friction.coulomb_N) * std::exp(-slowness * slowness));
  state_.velocity_m_per_s = (momentum - std::clamp(momentum, -most, most)) / (params_.mass_kg + viscous);
}

void HydraulicCylinder::step(const ServoValve& valve, double opening) noexcept {
  compress(valve, opening, 0.5 * dt_s_);
  accelerate();
  compress(valve, opening, 0.5 * dt_s_);
}

}  // namespace tactus::mechanics
