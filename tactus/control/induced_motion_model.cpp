#include <tactus/control/induced_motion_model.hpp>
#include <tactus/mechanics/friction.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

namespace tactus::control {

namespace {

int bodies_of(ModelFidelity fidelity) {
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

/// Calls `use` with the number of bodies as a constant.
template <class Use>
auto with_bodies(int bodies, const Use& use) {
  switch (bodies) {
    case 1:
      return use(std::integral_constant<int, 1>());
    case 2:
      return use(std::integral_constant<int, 2>());
    default:
      return use(std::integral_constant<int, 3>());
  }
}

/// Which body motor, drum or handle belongs to: links are rigid from the motor outward.
constexpr Eigen::Index body_of(std::size_t mass, int bodies) {
  return std::max<Eigen::Index>(0, static_cast<Eigen::Index>(mass) + bodies - 3);
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

/// q̇ = A q + B u of the linear part: positions of the bodies, then their velocities; u the forces on them.
template <int bodies>
struct LinearPart {
  Eigen::Matrix<double, 2 * bodies, 2 * bodies> a = decltype(a)::Zero();
  Eigen::Matrix<double, 2 * bodies, bodies> b = decltype(b)::Zero();
};

template <int bodies>
LinearPart<bodies> linear_part(const MasterModel& master, double linkage_stiffness_N_per_m) {
  using Square = Eigen::Matrix<double, bodies, bodies>;
  Eigen::Matrix<double, 3, bodies> rigid = Eigen::Matrix<double, 3, bodies>::Zero();
  for (std::size_t mass = 0; mass < 3; ++mass) rigid(static_cast<Eigen::Index>(mass), body_of(mass, bodies)) = 1.0;
  const Eigen::Vector3d mass{master.motor.mass_kg, master.drum.mass_kg, master.handle.mass_kg};
  const auto coupling = [](double cable, double linkage, double hand) {
    Eigen::Matrix3d matrix;
    matrix << cable, -cable, 0.0, -cable, cable + linkage, -linkage, 0.0, -linkage, linkage + hand;
    return matrix;
  };
  const Square stiffness =
      rigid.transpose() *
      coupling(master.cable.stiffness_N_per_m, linkage_stiffness_N_per_m, master.hand.stiffness_N_per_m) * rigid;
  const Square damping =
      rigid.transpose() *
      coupling(master.cable.damping_N_s_per_m, master.linkage.damping_N_s_per_m, master.hand.damping_N_s_per_m) * rigid;
  const Square inverse_mass = (rigid.transpose() * mass).cwiseInverse().asDiagonal();
  LinearPart<bodies> part;
  part.a.template topRightCorner<bodies, bodies>().setIdentity();
  part.a.template bottomLeftCorner<bodies, bodies>() = -inverse_mass * stiffness;
  part.a.template bottomRightCorner<bodies, bodies>() = -inverse_mass * damping;
  part.b.template bottomRows<bodies>() = inverse_mass;
  return part;
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
    const double radius = with_bodies(bodies_of(params.fidelity), [&](auto bodies) {
      const auto a = linear_part<bodies>(params.master, linkage->initial_stiffness_N_per_m()).a;
      return (decltype(a)::Identity() + substep * a).eval().eigenvalues().cwiseAbs().maxCoeff();
    });
    constexpr double round_off = 1e-9;
    if (radius > 1.0 + round_off) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = "step",
                   .message = "forward Euler with substeps of " + format_number(substep * 1e6) +
                              " us is unstable for this model (a mode grows by " + format_number(radius) +
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
  with_bodies(bodies_, [this](auto bodies) { precompute_exact_step<bodies>(); });
  if (params_.fidelity == ModelFidelity::sixth_order) precompute_friction();
}

template <int bodies>
void InducedMotionModel::precompute_exact_step() {
  // exp of the augmented matrix [A B; 0 0]·dt holds Φ and Γ side by side (Van Loan 1978).
  using Augmented = Eigen::Matrix<double, 3 * bodies, 3 * bodies>;
  const auto part = linear_part<bodies>(params_.master, exact_.linkage_stiffness_N_per_m);
  Augmented augmented = Augmented::Zero();
  augmented.template topLeftCorner<2 * bodies, 2 * bodies>() = part.a * exact_.dt_s;
  augmented.template topRightCorner<2 * bodies, bodies>() = part.b * exact_.dt_s;
  const Augmented exponential = augmented.exp();

  // Masses of one body have equal rows; the first of them stands for all, and the columns of the others stay zero.
  for (std::size_t row = 0; row < 6; ++row) {
    const Eigen::Index r = body_of(row % 3, bodies) + (row < 3 ? 0 : bodies);
    for (std::size_t mass = 0; mass < 3; ++mass) {
      const Eigen::Index body = body_of(mass, bodies);
      exact_.response[mass][row] = exponential(r, body + bodies + bodies);
      if (mass > 0 && body == body_of(mass - 1, bodies)) continue;
      exact_.transition[mass][row] = exponential(r, body);
      exact_.transition[mass + 3][row] = exponential(r, body + bodies);
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
    exact_.advance(input.motor_force_N, range, hysteretic_);
  } else {
    step_euler(input.motor_force_N, range);
  }
  return exact_.state[0];
}

void InducedMotionModel::step_euler(double motor_force_N, const FrictionRange& range) noexcept {
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
    double on_motor = motor_force_N - cable, on_drum = cable - linkage, on_handle = linkage - hand;
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
