// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/arm_loop.hpp>
#include <tactus/analysis/arm_stability/internal/site_parts.hpp>
#include <tactus/analysis/stability/linear_plant.hpp>

#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace tactus::arm_stability {
namespace {

using arm_control::ArmMethod;
using arm_control::ToolLimit;
using experiments::ArmPairSetup;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

Check refuse_what_is_not_linear(const arm_control::ArmLeader::Params& control) {
  if (control.passivity.port != arm_control::PassivePort::none) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "control.passivity.port",
                 .message =
                     "its dampers go by energy, so no loop of it is linear: write none, or look at taps, as in "
                     "tactus run",
                 .place = {}};
  }
  const ArmMethod method = control.method;
  if (method == ArmMethod::position_force || method == ArmMethod::cancellation) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "control.method",
               .message = "the loop of " + std::string(name_of(method)) +
                          " has not been made linear: judge position-force or cancellation, or look at taps, as in "
                          "tactus run",
               .place = {}};
}

/// The surface for small motions.
Result<stability::TipLoad> linear_wall(const experiments::ArmWallParams& wall, std::optional<double> preload_N) {
  if (wall.law == experiments::SurfaceLaw::kelvin_voigt) {
    return stability::TipLoad{.stiffness_N_per_m = wall.stiffness_N_per_m, .damping_N_s_per_m = wall.damping_N_s_per_m};
  }
  if (preload_N) return stability::wall_load(wall.environment(), *preload_N);
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "wall.law",
               .message = "a surface of the law " + std::string(name_of(wall.law)) +
                          " is the stiffer the harder it is pressed, so its loop is linear about a contact force "
                          "alone: judge it by tactus stability margins, where --preload gives the force, or write "
                          "kelvin-voigt",
               .place = {}};
}

/// What a limit at the tool takes away of gains, as a matrix of the joints.
Matrix taken_away(const Vector& gains, double most, const Matrix& moving) {
  const ToolLimit limit{arm::JointVector(gains), most};
  if (!limit.limits()) return Matrix::Zero(gains.size(), gains.size());
  return moving.transpose() * limit.excess(arm_control::ToolJacobian(moving)) * moving;
}

Matrix6 of_hand(double along, double lever_m) {
  Matrix6 impedance = Matrix6::Zero();
  impedance.diagonal().head<3>().setConstant(along);
  impedance.diagonal().tail<3>().setConstant(along * lever_m * lever_m);
  return impedance;
}

Matrix6 of_wall(double into, const arm::Vector3& normal) {
  Matrix6 impedance = Matrix6::Zero();
  impedance.topLeftCorner<3, 3>() = into * normal * normal.transpose();
  return impedance;
}

/// A site's arm, sampled, and how it gives what it is asked for.
struct SampledArm {
  stability::StateSpace system;
  Stretch state;

  [[nodiscard]] Vector signal(const Vector& all, int which) const {
    const Eigen::Index n = system.inputs();
    return system.c.middleRows(which * n, n) * state.of(all);
  }
  [[nodiscard]] Vector motor(const Vector& all) const { return signal(all, 0); }
  [[nodiscard]] Vector motor_velocity(const Vector& all) const { return signal(all, 1); }
  [[nodiscard]] Vector link(const Vector& all) const { return signal(all, 2); }
  [[nodiscard]] Vector link_velocity(const Vector& all) const { return signal(all, 3); }
  void step(const Vector& torque, const Vector& all, Vector& next) const {
    state.of(next) = system.a * state.of(all) + system.b * torque;
  }
};

Result<SampledArm> sampled_arm(const arm_plants::ArmPlant::Params& arm, const arm::JointVector& start,
                               const Holding& holding, double tick_s, Allotment& states) {
  const auto continuous = linear_arm(arm, start, holding);
  if (!continuous) return continuous.error();
  return SampledArm{.system = stability::sampled(*continuous, tick_s, 0.0), .state = states.take(continuous->states())};
}

/// What the site of the leader gives its own motion by itself, and the drives of it.
struct LeaderGains {
  Vector drive_damping;
  Matrix given_back;  ///< over the bus, of the drives' damping
  Matrix position;    ///< torque over the bus for a position and a velocity
  Matrix velocity;
};

LeaderGains leader_gains(const ArmPairSetup& setup, const Rubbing& rubbing, const Matrix& weight,
                         const Matrix& moving) {
  const auto& control = setup.params.control;
  const int joints = static_cast<int>(setup.leader.joints.size());
  LeaderGains found;
  found.drive_damping = control.drive_damping.of(joints, &arm_control::DriveDamping::damping_N_m_s_per_rad);
  found.given_back = taken_away(found.drive_damping, control.drive_damping_limit_N_s_per_m, moving);
  found.position = weight;
  const auto& forward = control.feed_forward;
  found.velocity = forward.friction_share * rubbing.fed_forward(forward.friction_velocity_rad_per_s).asDiagonal();
  found.velocity += found.given_back - control.damping_N_s_per_m * moving.transpose() * moving;
  return found;
}

/// The model of induced motion as its site believes, at the pose.
Result<LinearInducedMotion::Matrices> believed(const ArmPairSetup& setup,
                                               const experiments::ArmModelParams& model_params,
                                               const LeaderGains& leader, double friction_speed_rad_per_s) {
  const auto& control = setup.params.control;
  const auto chain = arm::Chain::make(model_params.induced.chain);
  if (!chain) return chain.error();
  const Matrix tool = chain->jacobian(setup.leader.start, chain->joints() - 1, model_params.induced.tool_m);
  const Matrix moving = tool.topRows(3);
  const arm::HandImpedance& hand = model_params.hand;
  Matrix inertia = chain->mass_matrix(setup.leader.start);
  if (control.model.inertia == arm_control::InertiaModel::diagonal) inertia = Matrix(inertia.diagonal().asDiagonal());
  inertia += hand.mass_kg * moving.transpose() * moving;
  const Matrix stiffness = tool.transpose() * of_hand(hand.stiffness_N_per_m, hand.lever_m) * tool;
  const Matrix held = tool.transpose() * of_hand(hand.damping_N_s_per_m, hand.lever_m) * tool;
  Matrix of_site = control.damping_N_s_per_m * moving.transpose() * moving - leader.given_back;
  of_site.diagonal() += leader.drive_damping;
  const Vector rubbing =
      Rubbing(model_params.induced.chain, friction_speed_rad_per_s)
          .left(control.feed_forward.friction_share, control.feed_forward.friction_velocity_rad_per_s);
  if (control.model.joints == arm_control::JointModel::rigid) {
    return LinearInducedMotion::Matrices{
        .inertia = inertia, .damping = held + of_site, .stiffness = stiffness, .rubbing = rubbing};
  }
  const Eigen::Index n = inertia.rows();
  Vector armature(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    armature[i] = model_params.induced.chain.joints[static_cast<std::size_t>(i)].drive.reflected_kg_m2();
  }
  const auto two = [n](const Matrix& of_motors, const Matrix& of_links, const Vector& between) {
    const Matrix joins = between.asDiagonal();
    Matrix all(2 * n, 2 * n);
    all << of_motors + joins, -joins, -joins, of_links + joins;
    return all;
  };
  const Matrix motors = armature.asDiagonal();
  const Matrix none = Matrix::Zero(n, n);
  return LinearInducedMotion::Matrices{
      .inertia = two(motors, inertia - motors, Vector::Zero(n)),
      .damping = two(of_site, held, model_params.induced.joint_damping_N_m_s_per_rad),
      .stiffness = two(none, stiffness, model_params.induced.joint_stiffness_N_m_per_rad),
      .rubbing = rubbing};
}

/// The follower's site tells what its sensors do, or an observer.
using Observer = std::variant<std::monostate, LinearRigidObserver, LinearElasticObserver>;

Observer observer_of(const ArmPairSetup& setup, const experiments::ArmModelParams& model_params, const Matrix& inertia,
                     double tick_s, Allotment& states) {
  const auto& follower = setup.params.control.follower;
  if (follower.torque == arm_control::TorqueSource::sensor) return {};
  const Vector cutoff_Hz = arm_control::cutoffs(follower.observer.cutoff_Hz, follower.observer.cutoff_each,
                                                static_cast<int>(inertia.rows()));
  if (follower.observer.joints == arm_control::JointModel::rigid) {
    return LinearRigidObserver(cutoff_Hz, tick_s, inertia, states);
  }
  Vector armature(inertia.rows());
  for (Eigen::Index i = 0; i < armature.size(); ++i) {
    armature[i] = setup.follower.arm.chain.joints[static_cast<std::size_t>(i)].drive.reflected_kg_m2();
  }
  return LinearElasticObserver(cutoff_Hz, tick_s, inertia - Matrix(armature.asDiagonal()), armature,
                               model_params.follower_joint_stiffness_N_m_per_rad, states);
}

}  // namespace

Result<ArmLoop> ArmLoop::make(const ArmPairSetup& setup, const experiments::ArmModelParams& model_params,
                              const ArmLinearisation& linearisation) {
  const experiments::ArmTappingParams& params = setup.params;
  const auto& control = params.control;
  if (Check refused = refuse_what_is_not_linear(control)) return *std::move(refused);
  if (Check refused = station::refuse_tool_coupling(params, "tactus stability")) return *std::move(refused);
  if (params.servo.extra_delay_cycles > 0) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "servo.extra_delay_cycles",
                 .message = std::to_string(params.servo.extra_delay_cycles) +
                            ": the linear loop of tactus stability has no further delay of the drives; write 0",
                 .place = {}};
  }
  const auto wall = linear_wall(params.wall, linearisation.preload_N);
  if (!wall) return wall.error();
  const auto chain = arm::Chain::make(setup.leader.arm.chain);
  if (!chain) return chain.error();
  const auto follower_chain = arm::Chain::make(setup.follower.arm.chain);
  if (!follower_chain) return follower_chain.error();
  const double tick_s = 1.0 / params.servo.rate_Hz;
  const auto n = static_cast<Eigen::Index>(chain->joints());
  const int joints = chain->joints();
  Allotment states;

  // The leader: its arm in the hand, and its site.
  const arm::JointVector& start = setup.leader.start;
  const Matrix held_at = chain->jacobian(start, chain->joints() - 1, setup.leader.arm.tool_m).topRows<3>();
  const Rubbing leader_rubbing(setup.leader.arm.chain, linearisation.friction_speed_rad_per_s);
  const LeaderGains leader_site = leader_gains(setup, leader_rubbing, weight_slope(*chain, start), held_at);
  arm_plants::ArmPlant::Params held = setup.leader.arm;
  const arm::HandImpedance& hand = params.person.hand;
  held.carried_kg = hand.mass_kg;
  const auto leader = sampled_arm(held, start,
                                  {.stiffness = of_hand(hand.stiffness_N_per_m, hand.lever_m),
                                   .damping = of_hand(hand.damping_N_s_per_m, hand.lever_m),
                                   .drive_stiffness = Vector::Zero(n),
                                   .drive_damping = leader_site.drive_damping,
                                   .rubbing = leader_rubbing.of_motors()},
                                  tick_s, states);
  if (!leader) return leader.error();
  const Stretch on_leaders_bus = states.take(n), heard = states.take(n);
  const Vector force_Hz = arm_control::cutoffs(control.force_low_pass_Hz, control.force_low_pass_each, joints);
  const Vector command_Hz = arm_control::cutoffs(control.command_low_pass_Hz, control.command_low_pass_each, joints);
  const LinearLowPass force(force_Hz, tick_s, states);
  const LinearLowPass command_position(command_Hz, tick_s, states);
  const LinearLowPass command_velocity(command_Hz, tick_s, states);
  std::optional<LinearInducedMotion> model;
  Stretch acting;
  if (control.method == ArmMethod::cancellation) {
    const auto matrices = believed(setup, model_params, leader_site, linearisation.friction_speed_rad_per_s);
    if (!matrices) return matrices.error();
    model.emplace(*matrices, control.model.washout_Hz, tick_s, n, states);
    acting = states.take(n);
  }

  // The follower: its arm on the wall, and its site.
  using arm_control::DriveGains;
  const arm::JointVector& touches = setup.follower.start;
  const Matrix tool = follower_chain->jacobian(touches, follower_chain->joints() - 1, setup.follower.arm.tool_m);
  const Matrix moving = tool.topRows(3);
  const Matrix weight = weight_slope(*follower_chain, touches);
  const Rubbing rubbing(setup.follower.arm.chain, linearisation.friction_speed_rad_per_s);
  const Vector stiffness =
      control.follower.stiffness_share * control.follower.gains.of(joints, &DriveGains::stiffness_N_m_per_rad);
  const Vector damping = control.follower.gains.of(joints, &DriveGains::damping_N_m_s_per_rad);
  const Matrix soft = taken_away(stiffness, control.follower.tool_stiffness_limit_N_per_m, moving);
  const Matrix undamped = taken_away(damping, control.follower.tool_damping_limit_N_s_per_m, moving);
  const Matrix wall_stiffness = of_wall(wall->stiffness_N_per_m, setup.outward);
  const Matrix wall_damping = of_wall(wall->damping_N_s_per_m, setup.outward);
  const auto follower = sampled_arm(setup.follower.arm, touches,
                                    {.stiffness = wall_stiffness,
                                     .damping = wall_damping,
                                     .drive_stiffness = stiffness,
                                     .drive_damping = damping,
                                     .rubbing = rubbing.of_motors()},
                                    tick_s, states);
  if (!follower) return follower.error();
  const Stretch on_followers_bus = states.take(n), told_torque = states.take(n);
  const auto& forward = control.follower.feed_forward;
  const Vector overcome = forward.friction_share * rubbing.fed_forward(forward.friction_velocity_rad_per_s);
  const Matrix inertia = follower_chain->mass_matrix(touches);
  const Observer observer = observer_of(setup, model_params, inertia, tick_s, states);

  const auto tick = [&](const Vector& state, const Vector& displayed, Vector& next, Vector& output) {
    output = force.step(heard.of(state), state, next);

    const Vector at = leader->motor(state), moves = leader->motor_velocity(state);
    on_leaders_bus.of(next) = leader_site.position * at + leader_site.velocity * moves + displayed;
    Vector position = at, velocity = moves;
    if (model) {
      position -= model->position(state);
      velocity -= model->velocity(state);
      model->step(acting.of(state), state, next);
      acting.of(next) = displayed;
    }
    position = command_position.step(position, state, next);
    velocity = command_velocity.step(velocity, state, next);

    const Vector follows = follower->motor(state), speed = follower->motor_velocity(state);
    on_followers_bus.of(next) = stiffness.cwiseProduct(position) + damping.cwiseProduct(velocity) + weight * follows +
                                overcome.cwiseProduct(speed) - soft * (position - follows) -
                                undamped * (velocity - speed);
    const Vector unmoved = told_torque.of(state) - weight * follows - rubbing.observed().cwiseProduct(speed);
    if (const auto* rigid = std::get_if<LinearRigidObserver>(&observer)) {
      heard.of(next) = rigid->step(speed, unmoved, state, next);
    } else if (const auto* elastic = std::get_if<LinearElasticObserver>(&observer)) {
      heard.of(next) = elastic->step(speed, unmoved, state, next);
    } else {
      heard.of(next) = -tool.transpose() * (wall_stiffness * (tool * follower->link(state)) +
                                            wall_damping * (tool * follower->link_velocity(state)));
    }

    leader->step(on_leaders_bus.of(state), state, next);
    follower->step(on_followers_bus.of(state), state, next);
    // At the end of a tick the drives still give what the command before asks for.
    told_torque.of(next) = on_followers_bus.of(state) - stiffness.cwiseProduct(follower->motor(next)) -
                           damping.cwiseProduct(follower->motor_velocity(next));
  };
  ArmLoop loop;
  loop.open_ = stability::assemble(states.used(), n, n, tick);
  loop.leader_velocity_ = leader->system.c.bottomRows(n);
  loop.follower_velocity_ = follower->system.c.bottomRows(n);
  loop.leader_at_ = leader->state.at;
  loop.follower_at_ = follower->state.at;
  loop.leader_inertia_ = chain->mass_matrix(start);
  loop.follower_inertia_ = inertia;
  loop.tick_s_ = tick_s;
  loop.wall_stiffness_N_per_m_ = wall->stiffness_N_per_m;
  return loop;
}

}  // namespace tactus::arm_stability
