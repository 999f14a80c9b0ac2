// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/kernel/mechanics/friction.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace tactus::control {

namespace {

std::size_t bodies_of(ModelFidelity fidelity) {
  switch (fidelity) {
    case ModelFidelity::second_order:
      return 1;
    case ModelFidelity::fourth_order:
      return 2;
    case ModelFidelity::sixth_order_linear:
    case ModelFidelity::sixth_order:
      break;
  }
  return 3;
}

/// Which body motor, drum or handle belongs to: links are rigid from the motor outward.
constexpr std::size_t body_of(std::size_t mass, std::size_t bodies) {
  return mass + bodies > 3 ? mass + bodies - 3 : 0;
}

/// The parameters without what a linear model lacks.
InducedMotionModel::Params what_it_has(InducedMotionModel::Params params) {
  if (params.fidelity == ModelFidelity::sixth_order) return params;
  MasterModel& master = params.master;
  master.motor.friction_N = 0.0;
  master.drum.friction_N = 0.0;
  master.linkage.hysteretic_fraction = 0.0;
  master.hand.quintic_stiffness_N_per_m5 = 0.0;
  master.hand.stiffness_N_per_m *= master.linear_hand_stiffening;
  return params;
}

/// q̇ = A q + B u of the linear part: positions of the bodies, then their velocities; u the forces on them. Row by row.
struct LinearPart {
  std::size_t bodies;
  std::vector<double> a;  ///< 2 bodies by 2 bodies
  std::vector<double> b;  ///< 2 bodies by bodies
};

LinearPart linear_part(const MasterModel& master, std::size_t bodies, double linkage_stiffness_N_per_m) {
  const std::array mass_kg{master.motor.mass_kg, master.drum.mass_kg, master.handle.mass_kg};
  std::array<double, 3> together_kg{};
  for (std::size_t mass = 0; mass < 3; ++mass) together_kg[body_of(mass, bodies)] += mass_kg[mass];
  const auto coupling = [](double cable, double linkage, double hand) {
    return std::array<std::array<double, 3>, 3>{
        {{cable, -cable, 0.0}, {-cable, cable + linkage, -linkage}, {0.0, -linkage, linkage + hand}}};
  };
  const auto stiffness =
      coupling(master.cable.stiffness_N_per_m, linkage_stiffness_N_per_m, master.hand.stiffness_N_per_m);
  const auto damping =
      coupling(master.cable.damping_N_s_per_m, master.linkage.damping_N_s_per_m, master.hand.damping_N_s_per_m);
  LinearPart part{bodies, std::vector<double>(4 * bodies * bodies), std::vector<double>(2 * bodies * bodies)};
  for (std::size_t i = 0; i < bodies; ++i) {
    part.a[2 * bodies * i + bodies + i] = 1.0;
    part.b[bodies * (bodies + i) + i] = 1.0 / together_kg[i];
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t row = body_of(i, bodies);
    double* const accelerations = &part.a[2 * bodies * (bodies + row)];
    for (std::size_t j = 0; j < 3; ++j) {
      accelerations[body_of(j, bodies)] -= stiffness[i][j] / together_kg[row];
      accelerations[bodies + body_of(j, bodies)] -= damping[i][j] / together_kg[row];
    }
  }
  return part;
}

/// By how much the mode that grows most grows in one step of forward Euler.
double euler_growth(const LinearPart& part, double step_s) {
  std::vector<double> transition = part.a;
  for (double& entry : transition) entry *= step_s;
  for (std::size_t i = 0; i < 2 * part.bodies; ++i) transition[2 * part.bodies * i + i] += 1.0;
  double growth = 0.0;
  for (const auto& value : signal::eigenvalues(transition, 2 * part.bodies)) growth = std::max(growth, std::abs(value));
  return growth;
}

int euler_substeps(Seconds dt) {
  constexpr double round_off = 1e-9;
  return static_cast<int>(std::max(1.0, std::ceil(dt.value / InducedMotionModel::euler_substep_s - round_off)));
}

}  // namespace

Result<InducedMotionModel> InducedMotionModel::make(const Params& requested, Seconds dt) {
  if (auto error = signal::check(requested, dt)) return *std::move(error);
  if (dt.value > 0.01) return out_of_bounds("dt", dt.value, positive_up_to(0.01), units::second);
  const Params params = what_it_has(requested);
  const auto linkage = mechanics::BoucWenSpring::make(params.master.linkage, dt);
  if (!linkage) return under("master.linkage", linkage.error());
  if (params.step == CancellationStep::euler) {
    const double substep = dt.value / euler_substeps(dt);
    const double radius = euler_growth(
        linear_part(params.master, bodies_of(params.fidelity), linkage->initial_stiffness_N_per_m()), substep);
    constexpr double round_off = 1e-9;
    if (radius > 1.0 + round_off) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "step",
                   .message = "forward Euler with substeps of " + rounded_number(substep * 1e6) +
                              " us is unstable for this model (a mode grows by " +
                              rounded_number(std::round(1e6 * radius) / 1e6) +
                              " a substep): use the exact step, or less stiffness or more mass",
                   .place = {}};
    }
  }
  return InducedMotionModel(params, *linkage, dt);
}

InducedMotionModel::InducedMotionModel(const Params& params, const mechanics::BoucWenSpring& linkage, Seconds dt)
    : params_(params),
      bodies_(bodies_of(params.fidelity)),
      hysteretic_(params.master.linkage.hysteretic_fraction > 0.0),
      euler_substeps_(euler_substeps(dt)),
      euler_substep_s_(dt.value / euler_substeps_) {
  exact_.dt_s = dt.value;
  exact_.motor_friction_N = params.master.motor.friction_N;
  exact_.drum_friction_N = params.master.drum.friction_N;
  exact_.velocity_share = params.friction == ModelFriction::total_velocity ? 1.0 : 0.0;
  exact_.friction_band_m_per_s = params.friction_band_m_per_s;
  exact_.quintic_N_per_m5 = params.master.hand.quintic_stiffness_N_per_m5;
  exact_.quintic_guard_m = params.master.hand.guard_m;
  exact_.linkage_stiffness_N_per_m = linkage.initial_stiffness_N_per_m();
  exact_.linkage = linkage.motion();
  exact_.both_stopped = 1.0;
  const std::array<double, 3> mass_kg{params.master.motor.mass_kg, params.master.drum.mass_kg,
                                      params.master.handle.mass_kg};
  for (std::size_t i = 0; i < 3; ++i) {
    double together_kg = 0.0;
    for (std::size_t j = 0; j < 3; ++j) together_kg += body_of(i, bodies_) == body_of(j, bodies_) ? mass_kg[j] : 0.0;
    euler_response_[i] = euler_substep_s_ / together_kg;
  }
  precompute_exact_step();
  if (params_.fidelity == ModelFidelity::sixth_order) precompute_friction();
}

void InducedMotionModel::precompute_exact_step() {
  // exp of the augmented matrix [A B; 0 0]·dt holds Φ and Γ side by side (Van Loan 1978).
  const LinearPart part = linear_part(params_.master, bodies_, exact_.linkage_stiffness_N_per_m);
  const std::size_t states = 2 * bodies_, size = 3 * bodies_;
  std::vector<double> exponential(size * size);
  for (std::size_t row = 0; row < states; ++row) {
    for (std::size_t i = 0; i < states; ++i) exponential[size * row + i] = part.a[states * row + i] * exact_.dt_s;
    for (std::size_t i = 0; i < bodies_; ++i)
      exponential[size * row + states + i] = part.b[bodies_ * row + i] * exact_.dt_s;
  }
  signal::exponentiate(exponential, size);

  // Masses of one body have equal rows; the first of them stands for all, and the columns of the others stay zero.
  for (std::size_t row = 0; row < 6; ++row) {
    const double* const held = &exponential[size * (body_of(row % 3, bodies_) + (row < 3 ? 0 : bodies_))];
    for (std::size_t mass = 0; mass < 3; ++mass) {
      const std::size_t body = body_of(mass, bodies_);
      exact_.response[mass][row] = held[body + states];
      if (mass > 0 && body == body_of(mass - 1, bodies_)) continue;
      exact_.transition[mass][row] = held[body];
      exact_.transition[mass + 3][row] = held[body + bodies_];
    }
  }
}

void InducedMotionModel::precompute_friction() {
  constexpr std::size_t motor_velocity = 3, drum_velocity = 4, stops_motor = 6, stops_drum = 7;
  const double on_motor = exact_.response[0][motor_velocity], on_drum = exact_.response[1][drum_velocity];
  const auto add_stopping_forces = [&](Column& column) {
    column[stops_motor] = -column[motor_velocity] / on_motor;
    column[stops_drum] = -column[drum_velocity] / on_drum;
  };
  for (Column& column : exact_.transition) add_stopping_forces(column);
  for (Column& column : exact_.response) add_stopping_forces(column);
  exact_.offset_response[stops_motor] = -1.0 / on_motor;
  exact_.offset_response[stops_drum] = -1.0 / on_drum;
  exact_.motor_per_drum = exact_.response[1][motor_velocity] / on_motor;
  exact_.drum_per_motor = exact_.response[0][drum_velocity] / on_drum;
  exact_.both_stopped = 1.0 / (1.0 - exact_.motor_per_drum * exact_.drum_per_motor);
}

InducedMotionModel::Output InducedMotionModel::step(const Input& input) noexcept {
  const FrictionRange range = exact_.friction_range(input.intended_velocity_m_per_s);
  if (params_.step == CancellationStep::exact) {
    exact_.advance(input.motor_force_N, input.handle_force_N, range, hysteretic_);
  } else {
    step_euler(input, range);
  }
  return exact_.state[0];
}

void InducedMotionModel::step_euler(const Input& input, const FrictionRange& range) noexcept {
  const MasterModel& m = params_.master;
  const double h = euler_substep_s_;
  const auto rub = [&range](double free_velocity, double most) {
    return free_velocity +
           std::clamp(-(free_velocity + range.offset_m_per_s), most * range.least_share, most * range.most_share);
  };
  const auto slipped_N = [this](double deflection_m) {
    return hysteretic_ ? exact_.slipped_force_N(deflection_m) : 0.0;
  };
  auto [x_motor, x_drum, x_handle, v_motor, v_drum, v_handle] = exact_.state;
  for (int i = 0; i < euler_substeps_; ++i) {
    const double cable =
        m.cable.stiffness_N_per_m * (x_motor - x_drum) + m.cable.damping_N_s_per_m * (v_motor - v_drum);
    const double linkage = exact_.linkage_stiffness_N_per_m * (x_drum - x_handle) + slipped_N(x_drum - x_handle) +
                           m.linkage.damping_N_s_per_m * (v_drum - v_handle);
    const double hand =
        exact_.quintic_force_N(x_handle) + m.hand.stiffness_N_per_m * x_handle + m.hand.damping_N_s_per_m * v_handle;
    double on_motor = input.motor_force_N - cable, on_drum = cable - linkage,
           on_handle = input.handle_force_N + linkage - hand;
    if (bodies_ < 3) on_motor = on_drum = on_motor + on_drum;
    if (bodies_ < 2) on_motor = on_drum = on_handle = on_drum + on_handle;
    x_motor += h * v_motor;
    x_drum += h * v_drum;
    x_handle += h * v_handle;
    v_motor = rub(v_motor + euler_response_[0] * on_motor, euler_response_[0] * m.motor.friction_N);
    v_drum = rub(v_drum + euler_response_[1] * on_drum, euler_response_[1] * m.drum.friction_N);
    v_handle += euler_response_[2] * on_handle;
  }
  exact_.state = {x_motor, x_drum, x_handle, v_motor, v_drum, v_handle};
}

}  // namespace tactus::control
