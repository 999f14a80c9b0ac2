#include <tactus/control/induced_motion_model.hpp>
#include <tactus/mechanics/friction.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <unsupported/Eigen/MatrixFunctions>

namespace tactus::control {

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Matrix6x3 = Eigen::Matrix<double, 6, 3>;

/// ẋ = A x + B u of the linear part, u the forces on motor, drum and handle.
struct LinearPart {
  Matrix6 a = Matrix6::Zero();
  Matrix6x3 b = Matrix6x3::Zero();
};

LinearPart linear_part(const MasterModel& master) {
  const Eigen::Vector3d mass{master.motor.mass_kg, master.drum.mass_kg, master.handle.mass_kg};
  const auto coupling = [](double cable, double linkage, double hand) {
    Eigen::Matrix3d matrix;
    matrix << cable, -cable, 0.0, -cable, cable + linkage, -linkage, 0.0, -linkage, linkage + hand;
    return matrix;
  };
  const Eigen::Matrix3d stiffness =
      coupling(master.cable.stiffness_N_per_m, master.linkage.stiffness_N_per_m, master.hand.stiffness_N_per_m);
  const Eigen::Matrix3d damping =
      coupling(master.cable.damping_N_s_per_m, master.linkage.damping_N_s_per_m, master.hand.damping_N_s_per_m);
  const Eigen::Matrix3d inverse_mass = mass.cwiseInverse().asDiagonal();
  LinearPart part;
  part.a.topRightCorner<3, 3>().setIdentity();
  part.a.bottomLeftCorner<3, 3>() = -inverse_mass * stiffness;
  part.a.bottomRightCorner<3, 3>() = -inverse_mass * damping;
  part.b.bottomRows<3>() = inverse_mass;
  return part;
}

std::size_t euler_substeps(Seconds dt) {
  constexpr double round_off = 1e-9;
  return static_cast<std::size_t>(std::max(1.0, std::ceil(dt.value / InducedMotionModel::euler_substep_s - round_off)));
}

}  // namespace

Result<InducedMotionModel> InducedMotionModel::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (dt.value > 0.01) return out_of_bounds("dt", dt.value, positive_up_to(0.01), units::second);
  if (params.step == CancellationStep::euler) {
    const double substep = dt.value / static_cast<double>(euler_substeps(dt));
    const Matrix6 growth = Matrix6::Identity() + substep * linear_part(params.master).a;
    const double radius = growth.eigenvalues().cwiseAbs().maxCoeff();
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
  mechanics::QuinticSpring::Params quintic_alone = params.master.hand;
  quintic_alone.stiffness_N_per_m = 0.0;
  quintic_alone.damping_N_s_per_m = 0.0;
  const auto quintic = mechanics::QuinticSpring::make(quintic_alone, dt);
  if (!quintic) return under("master.hand", quintic.error());
  return InducedMotionModel(params, *quintic, dt);
}

InducedMotionModel::InducedMotionModel(const Params& params, const mechanics::QuinticSpring& quintic, Seconds dt)
    : params_(params), quintic_(quintic), dt_s_(dt.value), euler_substeps_(euler_substeps(dt)) {
  // exp of the augmented matrix [A B; 0 0]·dt holds Φ and Γ side by side (Van Loan 1978).
  const LinearPart part = linear_part(params.master);
  Eigen::Matrix<double, 9, 9> augmented = Eigen::Matrix<double, 9, 9>::Zero();
  augmented.topLeftCorner<6, 6>() = part.a * dt.value;
  augmented.topRightCorner<6, 3>() = part.b * dt.value;
  const Eigen::Matrix<double, 9, 9> exponential = augmented.exp();
  for (std::size_t row = 0; row < 6; ++row) {
    const auto r = static_cast<Eigen::Index>(row);
    for (std::size_t column = 0; column < 6; ++column) {
      transition_[column][row] = exponential(r, static_cast<Eigen::Index>(column));
    }
    for (std::size_t column = 0; column < 3; ++column) {
      response_[column][row] = exponential(r, static_cast<Eigen::Index>(column + 6));
    }
  }
}

InducedMotionModel::FrictionRange InducedMotionModel::friction_range(double intended_velocity) const noexcept {
  const double band = params_.friction_band_m_per_s;
  const double w = params_.friction == ModelFriction::total_velocity ? intended_velocity : 0.0;
  const double used = std::clamp(w / band, -1.0, 1.0);
  return {.least_share = used - 1.0, .most_share = used + 1.0, .offset_m_per_s = mechanics::soft_threshold(w, band)};
}

InducedMotionModel::Output InducedMotionModel::step(const Input& input) noexcept {
  const FrictionRange range = friction_range(input.intended_velocity_m_per_s);
  if (params_.step == CancellationStep::exact) {
    step_exact(input.motor_force_N, range);
  } else {
    step_euler(input.motor_force_N, range);
  }
  return state_[0];
}

void InducedMotionModel::step_euler(double motor_force_N, const FrictionRange& range) noexcept {
  const MasterModel& m = params_.master;
  const double h = dt_s_ / static_cast<double>(euler_substeps_);
  const auto rub = [&](double free_velocity, const mechanics::RubbingMass& body) {
    const double most = h * body.friction_N / body.mass_kg;
    return free_velocity +
           std::clamp(-(free_velocity + range.offset_m_per_s), most * range.least_share, most * range.most_share);
  };
  auto& [x_motor, x_drum, x_handle, v_motor, v_drum, v_handle] = state_;
  for (std::size_t i = 0; i < euler_substeps_; ++i) {
    const double cable =
        m.cable.stiffness_N_per_m * (x_motor - x_drum) + m.cable.damping_N_s_per_m * (v_motor - v_drum);
    const double linkage =
        m.linkage.stiffness_N_per_m * (x_drum - x_handle) + m.linkage.damping_N_s_per_m * (v_drum - v_handle);
    const double hand = quintic_.step({.deflection_m = x_handle}) + m.hand.stiffness_N_per_m * x_handle +
                        m.hand.damping_N_s_per_m * v_handle;
    x_motor += h * v_motor;
    x_drum += h * v_drum;
    x_handle += h * v_handle;
    v_motor = rub(v_motor + h / m.motor.mass_kg * (motor_force_N - cable), m.motor);
    v_drum = rub(v_drum + h / m.drum.mass_kg * (cable - linkage), m.drum);
    v_handle += h / m.handle.mass_kg * (linkage - hand);
  }
}

void InducedMotionModel::step_exact(double motor_force_N, const FrictionRange& range) noexcept {
  constexpr std::size_t motor_velocity = 3, drum_velocity = 4, lanes = 8;
  // The quintic force where the handle will be in the middle of the tick: half a tick of lag would cost an order.
  const double quintic = quintic_.step({.deflection_m = state_[2] + 0.5 * dt_s_ * state_[5]});

  Column next{};
  for (std::size_t column = 0; column < 6; ++column) {
    for (std::size_t row = 0; row < lanes; ++row) next[row] += transition_[column][row] * state_[column];
  }
  const auto add = [&next](const Column& response, double force) {
    for (std::size_t row = 0; row < lanes; ++row) next[row] += response[row] * force;
  };
  add(response_[0], motor_force_N);
  add(response_[2], -quintic);

  const Column& on_motor = response_[0];
  const Column& on_drum = response_[1];
  const auto friction = [&](double end_velocity, double response, double most_N) {
    return std::clamp(-(end_velocity + range.offset_m_per_s) / response, most_N * range.least_share,
                      most_N * range.most_share);
  };
  const double motor_most = params_.master.motor.friction_N;
  const double drum_most = params_.master.drum.friction_N;
  double motor = friction(next[motor_velocity], on_motor[motor_velocity], motor_most);
  double drum = friction(next[drum_velocity] + on_motor[drum_velocity] * motor, on_drum[drum_velocity], drum_most);
  motor = friction(next[motor_velocity] + on_drum[motor_velocity] * drum, on_motor[motor_velocity], motor_most);
  drum = friction(next[drum_velocity] + on_motor[drum_velocity] * motor, on_drum[drum_velocity], drum_most);
  add(on_motor, motor);
  add(on_drum, drum);
  std::copy_n(next.begin(), state_.size(), state_.begin());
}

}  // namespace tactus::control
