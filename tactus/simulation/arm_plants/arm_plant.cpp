// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/arm_plant.hpp>
#include <tactus/simulation/arm_plants/internal/mujoco_text.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <mutex>
#include <string>
#include <utility>

#include <mujoco/mujoco.h>

namespace tactus::arm_plants {
namespace {

using arm::Matrix3;

/// How far a transmission is bent beyond its play.
double bend_of(const MotorParams& motor, double apart_rad) noexcept {
  return std::copysign(std::max(std::fabs(apart_rad) - 0.5 * motor.play_rad, 0.0), apart_rad);
}

/// What is stiff and damped pushes back, and never pulls.
double push_back(double stiffness_N_m_per_rad, double damping_N_m_s_per_rad, double into_rad,
                 double rad_per_s) noexcept {
  if (into_rad == 0.0) return 0.0;
  const double torque = -stiffness_N_m_per_rad * into_rad - damping_N_m_s_per_rad * rad_per_s;
  return torque * into_rad < 0.0 ? torque : 0.0;
}

/// Torque of the flanks on the link, against the motor.
double flank_torque(const MotorParams& motor, double apart_rad, double apart_rad_per_s) noexcept {
  return push_back(motor.joint_stiffness_N_m_per_rad, motor.joint_damping_N_m_s_per_rad, bend_of(motor, apart_rad),
                   apart_rad_per_s);
}

/// Where a link cannot go further.
struct EndStops {
  double lower_rad = 0.0;
  double upper_rad = 0.0;
  double stiffness_N_m_per_rad = 0.0;
  double damping_N_m_s_per_rad = 0.0;
  /// How far a link is beyond one of them, negative at the lower; 0 between them.
  [[nodiscard]] double beyond_rad(double link_rad) const noexcept {
    return link_rad - std::clamp(link_rad, lower_rad, upper_rad);
  }
};

/// What goes wrong is asked for (`healthy`); MuJoCo by itself would write a file into the current folder.
void stay_silent(const char*) {}

double in_steps(double value, double step) noexcept { return step > 0.0 ? step * std::round(value / step) : value; }

struct Freed {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using Model = std::unique_ptr<mjModel, Freed>;
using Data = std::unique_ptr<mjData, Freed>;

Result<Model> load(const std::string& text) {
  // The loader of MuJoCo 2.2 keeps what it reads in one place for all. Its table of files is two megabytes.
  static std::mutex one_at_a_time;
  static mjVFS files;
  const std::lock_guard lock(one_at_a_time);
  mju_user_warning = stay_silent;
  constexpr const char* name = "arm.xml";
  mj_defaultVFS(&files);
  mj_makeEmptyFileVFS(&files, name, static_cast<int>(text.size()));
  std::memcpy(files.filedata[mj_findFileVFS(&files, name)], text.data(), text.size());
  std::array<char, 1000> complaint{};
  Model model(mj_loadXML(name, &files, complaint.data(), static_cast<int>(complaint.size())));
  mj_deleteVFS(&files);
  if (model) return model;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = std::string("MuJoCo cannot simulate this arm: ") + complaint.data(),
               .place = {}};
}

Check check(const MotorParams& motor) {
  const auto refused = [](ErrorCode code, const char* key, const char* why) {
    return Error{.code = code, .parameter = key, .message = why, .place = {}};
  };
  if (!(motor.play_rad >= 0.0 && std::isfinite(motor.play_rad))) {
    return refused(ErrorCode::out_of_bounds, "play_rad", "must be 0 or more: write how far the link moves freely");
  }
  if (motor.play_rad > 0.0 && !(motor.joint_stiffness_N_m_per_rad > 0.0)) {
    return refused(ErrorCode::inconsistent, "play_rad",
                   "play ends at something stiff: state the joint's stiffness too, such as 10000 N m/rad");
  }
  if (!(motor.velocity_scale > 0.0 && std::isfinite(motor.velocity_scale))) {
    return refused(ErrorCode::out_of_bounds, "velocity_scale", "must be positive: 1 where the host's table is right");
  }
  if (!(motor.torque_scale > 0.0 && std::isfinite(motor.torque_scale))) {
    return refused(ErrorCode::out_of_bounds, "torque_scale", "must be positive: 1 where the drive's table is right");
  }
  return {};
}

Check check(const ArmPlant::Params& params, const JointVector& position) {
  const std::size_t joints = params.chain.joints.size();
  if (params.motors.size() != joints || static_cast<std::size_t>(position.size()) != joints) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "motors",
                 .message = "an arm of " + std::to_string(joints) + " joints has as many motors and positions",
                 .place = {}};
  }
  for (std::size_t i = 0; i < joints; ++i) {
    if (Check wrong = check(params.motors[i])) return under_joint<Joints<MotorParams>>(i, *std::move(wrong));
    const arm::JointFriction& friction = params.chain.joints[i].friction;
    if (friction.offset_N_m == 0.0 && friction.load == 0.0 && friction.stribeck_N_m == 0.0) continue;
    return under_joint<Joints<MotorParams>>(
        i, {.code = ErrorCode::inconsistent,
            .parameter = "friction",
            .message = "a simulated joint has Coulomb and viscous friction only: set offset, load and Stribeck's to 0",
            .place = {}});
  }
  return {};
}

}  // namespace

struct ArmPlant::Engine {
  Model model;
  Data data;
  Joints<MotorParams> motors;
  std::array<int, most_joints> motor_dof{};
  Joints<bool> elastic;
  Joints<EndStops> stops;
  Vector3 tool_m;  ///< on the last link
  int last_body = 0;
  Vector3 carry_N;  ///< holds the carried mass up
  ArmCommand command;
  JointVector torque;  ///< of the motors, at the latest step
  using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor, 3, 2 * arm::most>;
  struct ToolJacobian {
    Rows moving, turning;
  };
  ToolJacobian jacobian;  ///< of the tool, for a velocity of each of MuJoCo's own coordinates

  [[nodiscard]] int joints() const noexcept { return static_cast<int>(motors.size()); }
  [[nodiscard]] std::size_t dof(int joint) const noexcept {
    return static_cast<std::size_t>(motor_dof[static_cast<std::size_t>(joint)]);
  }
  [[nodiscard]] JointVector motor_side(const mjtNum* of) const {
    JointVector found(joints());
    for (int i = 0; i < joints(); ++i) found[i] = of[dof(i)];
    return found;
  }
  [[nodiscard]] double link_side(const mjtNum* of, int joint) const noexcept {
    return elastic[static_cast<std::size_t>(joint)] ? of[dof(joint)] + of[dof(joint) + 1] : of[dof(joint)];
  }
  [[nodiscard]] JointVector link_side(const mjtNum* of) const {
    JointVector found(joints());
    for (int i = 0; i < joints(); ++i) found[i] = link_side(of, i);
    return found;
  }
  /// A torque on a link acts on both of an elastic joint's coordinates, which add up to where the link is.
  void add_on_link(mjtNum* to, int joint, double torque_N_m) const noexcept {
    to[dof(joint)] += torque_N_m;
    if (elastic[static_cast<std::size_t>(joint)]) to[dof(joint) + 1] += torque_N_m;
  }
  /// What a torque on a link accelerates where the arm is now and its other joints are free.
  [[nodiscard]] double inertia_kg_m2(int joint) const {
    using Each = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2 * arm::most, 1>;
    Each pushed = Each::Zero(model->nv), acceleration(model->nv);
    add_on_link(pushed.data(), joint, 1.0);
    mj_solveM(model.get(), data.get(), acceleration.data(), pushed.data(), 1);
    return 1.0 / link_side(acceleration.data(), joint);
  }
  /// Of an end stop on a link, positive where the position grows.
  [[nodiscard]] double stop_torque(int joint) const {
    const EndStops& stop = stops[static_cast<std::size_t>(joint)];
    const double beyond = stop.beyond_rad(link_side(data->qpos, joint));
    if (beyond == 0.0) return 0.0;
    // In a pose in which little moves with the joint, more would throw it back within a step.
    const double most_damping = 0.5 * inertia_kg_m2(joint) / model->opt.timestep;
    return push_back(stop.stiffness_N_m_per_rad, std::min(stop.damping_N_m_s_per_rad, most_damping), beyond,
                     link_side(data->qvel, joint));
  }
  [[nodiscard]] Vector3 tool_position() const {
    const auto at = static_cast<std::size_t>(last_body);
    const Eigen::Map<const Vector3> origin(data->xpos + 3 * at);
    return origin + rotation() * tool_m;
  }
  [[nodiscard]] Matrix3 rotation() const {
    const auto at = static_cast<std::size_t>(last_body);
    return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data->xmat + 9 * at);
  }
  /// Where the arm is now, for the next step to begin there.
  void look() {
    mj_step1(model.get(), data.get());
    const Vector3 point = tool_position();
    mj_jac(model.get(), data.get(), jacobian.moving.data(), jacobian.turning.data(), point.data(), last_body);
  }
  [[nodiscard]] auto velocities() const { return Eigen::Map<const Eigen::VectorXd>(data->qvel, model->nv); }
};

ArmPlant::ArmPlant(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}
ArmPlant::ArmPlant(ArmPlant&& other) noexcept = default;
ArmPlant& ArmPlant::operator=(ArmPlant other) noexcept {
  std::swap(engine_, other.engine_);
  return *this;
}
ArmPlant::~ArmPlant() = default;

ArmPlant::ArmPlant(const ArmPlant& other)
    : engine_(std::make_unique<Engine>(
          Engine{.model = Model(mj_copyModel(nullptr, other.engine_->model.get())),
                 .data = Data(mj_copyData(nullptr, other.engine_->model.get(), other.engine_->data.get())),
                 .motors = other.engine_->motors,
                 .motor_dof = other.engine_->motor_dof,
                 .elastic = other.engine_->elastic,
                 .stops = other.engine_->stops,
                 .tool_m = other.engine_->tool_m,
                 .last_body = other.engine_->last_body,
                 .carry_N = other.engine_->carry_N,
                 .command = other.engine_->command,
                 .torque = other.engine_->torque,
                 .jacobian = other.engine_->jacobian})) {}

Result<ArmPlant> ArmPlant::make(const Params& params, const JointVector& position) {
  const Result<arm::Chain> chain = arm::Chain::make(params.chain);
  if (!chain) return chain.error();
  if (Check wrong = check(params, position)) return *std::move(wrong);
  Result<Model> model = load(mujoco_text(params));
  if (!model) return model.error();
  const int joints = chain->joints();
  const arm::Gravity& g = params.chain.gravity;
  auto engine = std::make_unique<Engine>();
  engine->model = *std::move(model);
  engine->data = Data(mj_makeData(engine->model.get()));
  engine->motors = params.motors;
  engine->elastic = Joints<bool>(params.motors.size());
  engine->tool_m = params.tool_m;
  engine->last_body = joints;  // body 0 is the world
  engine->carry_N = -params.carried_kg * Vector3(g.x_m_per_s2, g.y_m_per_s2, g.z_m_per_s2);
  const JointVector weight = chain->gravity_torque(position);
  int dof = 0;
  for (int i = 0; i < joints; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double stiffness = params.motors[at].joint_stiffness_N_m_per_rad;
    engine->motor_dof[at] = dof;
    engine->elastic[at] = stiffness > 0.0;
    const double free = weight[i] == 0.0 ? 0.0 : std::copysign(0.5 * params.motors[at].play_rad, -weight[i]);
    const double bend = stiffness > 0.0 ? free - weight[i] / stiffness : 0.0;
    engine->data->qpos[dof] = position[i] - bend;
    if (stiffness > 0.0) engine->data->qpos[++dof] = bend;
    ++dof;
  }
  engine->command = ArmCommand::of_torque(JointVector::Zero(joints));
  engine->torque = JointVector::Zero(joints);
  engine->jacobian = {Engine::Rows(3, engine->model->nv), Engine::Rows(3, engine->model->nv)};
  engine->look();
  engine->stops = Joints<EndStops>(params.motors.size());
  for (int i = 0; i < joints; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const arm::JointLimits& limits = params.chain.joints[at].limits;
    const double inertia_kg_m2 = engine->inertia_kg_m2(i);
    engine->stops[at] = {.lower_rad = std::min(limits.lower_rad, position[i]),
                         .upper_rad = std::max(limits.upper_rad, position[i]),
                         .stiffness_N_m_per_rad = inertia_kg_m2 * end_stop_rad_per_s * end_stop_rad_per_s,
                         .damping_N_m_s_per_rad = 2.0 * end_stop_damping_ratio * inertia_kg_m2 * end_stop_rad_per_s};
  }
  return ArmPlant(std::move(engine));
}

ArmReading ArmPlant::read() const {
  const Engine& e = *engine_;
  ArmReading reading{
      .position = e.motor_side(e.data->qpos), .velocity = e.motor_side(e.data->qvel), .torque = e.torque};
  for (int i = 0; i < e.joints(); ++i) {
    const MotorParams& motor = e.motors[static_cast<std::size_t>(i)];
    reading.position[i] = in_steps(reading.position[i], motor.position_step_rad);
    reading.velocity[i] = motor.velocity_scale * in_steps(reading.velocity[i], motor.velocity_step_rad_per_s);
    reading.torque[i] = in_steps(reading.torque[i], motor.torque_step_N_m);
  }
  return reading;
}

void ArmPlant::write(const ArmCommand& command) { engine_->command = command; }

ToolState ArmPlant::tool() const {
  const Engine& e = *engine_;
  return {.position_m = e.tool_position(),
          .rotation = e.rotation(),
          .velocity_m_per_s = e.jacobian.moving * e.velocities(),
          .turning_rad_per_s = e.jacobian.turning * e.velocities()};
}

void ArmPlant::step(const ToolForce& on_tool) {
  Engine& e = *engine_;
  Eigen::Map<Eigen::VectorXd> applied(e.data->qfrc_applied, e.model->nv);
  applied.noalias() = e.jacobian.moving.transpose() * (on_tool.force_N + e.carry_N);
  applied.noalias() += e.jacobian.turning.transpose() * on_tool.moment_N_m;
  for (int i = 0; i < e.joints(); ++i) {
    const MotorParams& motor = e.motors[static_cast<std::size_t>(i)];
    const double limit = motor.torque_limit_N_m;
    const ArmCommand& c = e.command;
    const double wanted = c.torque[i] + c.stiffness[i] * (c.position[i] - e.data->qpos[e.dof(i)]) +
                          c.damping[i] * (c.velocity[i] / motor.velocity_scale - e.data->qvel[e.dof(i)]);
    e.torque[i] = std::clamp(wanted, -limit, limit);
    e.data->qfrc_applied[e.dof(i)] += motor.torque_scale * e.torque[i];
    if (motor.play_rad > 0.0) {
      const std::size_t apart = e.dof(i) + 1;
      e.data->qfrc_applied[apart] += flank_torque(motor, e.data->qpos[apart], e.data->qvel[apart]);
    }
    if (const double stop = e.stop_torque(i); stop != 0.0) e.add_on_link(e.data->qfrc_applied, i, stop);
  }
  mj_step2(e.model.get(), e.data.get());
  e.look();
}

JointVector ArmPlant::link_position() const { return engine_->link_side(engine_->data->qpos); }
JointVector ArmPlant::link_velocity() const { return engine_->link_side(engine_->data->qvel); }

JointVector ArmPlant::bearing_torque() const {
  const Engine& e = *engine_;
  const Eigen::Map<const Eigen::VectorXd> all(e.data->qfrc_bias, e.model->nv);
  const Eigen::VectorXd left = all - e.jacobian.moving.transpose() * e.carry_N;
  return e.motor_side(left.data());
}

JointVector ArmPlant::torque_of(const ToolForce& on_tool) const {
  const Engine& e = *engine_;
  // Of motors and, where joints are elastic, of links: in a place of its own size, for a tick does not allocate.
  const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2 * arm::most, 1> all =
      e.jacobian.moving.transpose().lazyProduct(on_tool.force_N) +
      e.jacobian.turning.transpose().lazyProduct(on_tool.moment_N_m);
  return e.motor_side(all.data());
}

double ArmPlant::energy_J() const {
  const Engine& e = *engine_;
  // Summed only where it is switched on, which every step would pay for.
  e.model->opt.enableflags |= mjENBL_ENERGY;
  mj_energyPos(e.model.get(), e.data.get());
  mj_energyVel(e.model.get(), e.data.get());
  e.model->opt.enableflags &= ~mjENBL_ENERGY;
  const double hand_J = -e.carry_N.dot(e.tool_position());  // what it seems to weigh in MuJoCo, it does not
  double pressed_J = 0.0;                                   // into flanks and end stops
  for (int i = 0; i < e.joints(); ++i) {
    const MotorParams& motor = e.motors[static_cast<std::size_t>(i)];
    const EndStops& stops = e.stops[static_cast<std::size_t>(i)];
    const double beyond = stops.beyond_rad(e.link_side(e.data->qpos, i));
    pressed_J += 0.5 * stops.stiffness_N_m_per_rad * beyond * beyond;
    if (motor.play_rad == 0.0) continue;
    const double bend = bend_of(motor, e.data->qpos[e.dof(i) + 1]);
    pressed_J += 0.5 * motor.joint_stiffness_N_m_per_rad * bend * bend;
  }
  return e.data->energy[0] + e.data->energy[1] + hand_J + pressed_J;
}

bool ArmPlant::healthy() const {
  const auto& warnings = engine_->data->warning;
  return warnings[mjWARN_BADQPOS].number == 0 && warnings[mjWARN_BADQVEL].number == 0 &&
         warnings[mjWARN_BADQACC].number == 0;
}

}  // namespace tactus::arm_plants
