#include <tactus/emulation/emulated_arm.hpp>

#include <cmath>
#include <utility>

namespace tactus::emulation {

using arm::ArmCommand;
using arm::JointVector;
using arm_plants::ArmPlant;

struct EmulatedArm::Body {
  ArmPlant plant;
  JointVector position_rad, velocity_rad_per_s;
  ArmCommand torque;
  bool held = false;
  JointVector weight_Nm;    ///< where it is held
  JointVector friction_Nm;  ///< Coulomb's, and what a motor can't tell from it
  std::function<arm_plants::ToolForce(const arm_plants::ToolState&)> touched;
};

namespace {

constexpr double step_s = 1e-4;

/// Where it comes to rest, with some damping so that this does not take long.
void come_to_rest(ArmPlant& plant) {
  constexpr double damping_Nms_per_rad = 1.0, rests_rad_per_s = 1e-4;
  constexpr int steps_between_looks = 1000, most_looks = 300;
  JointVector none = JointVector::Zero(plant.link_position().size());
  ArmCommand brakes = ArmCommand::of_torque(none);
  brakes.damping.setConstant(damping_Nms_per_rad);
  plant.write(brakes);
  for (int look = 0; look < most_looks; ++look) {
    for (int i = 0; i < steps_between_looks; ++i) plant.step({});
    if (plant.link_velocity().cwiseAbs().maxCoeff() < rests_rad_per_s) return;
  }
}

}  // namespace

EmulatedArm::EmulatedArm(std::unique_ptr<Body> body) : body_(std::move(body)) {}
EmulatedArm::~EmulatedArm() = default;

Result<std::unique_ptr<EmulatedArm>> EmulatedArm::make(const Settings& settings) {
  const auto joints = static_cast<Eigen::Index>(settings.chain.joints.size());
  const JointVector none = JointVector::Zero(joints);
  auto plant = ArmPlant::make({.chain = settings.chain,
                               .motors = Joints<arm_plants::MotorParams>(settings.chain.joints.size()),
                               .tool_m = settings.tool_m,
                               .step_s = step_s},
                              settings.held_at.value_or(none));
  if (!plant) return plant.error();
  if (!settings.held_at) come_to_rest(*plant);
  const JointVector at = plant->link_position(), weight_Nm = plant->bearing_torque();
  JointVector friction = none;
  constexpr double untold_Nm = 0.1;  // of a step of torque
  for (Eigen::Index i = 0; i < joints; ++i) {
    friction[i] = settings.chain.joints[static_cast<std::size_t>(i)].friction.coulomb_N_m + untold_Nm;
  }
  auto body = std::make_unique<Body>(Body{.plant = *std::move(plant),
                                          .position_rad = at,
                                          .velocity_rad_per_s = none,
                                          .torque = ArmCommand::of_torque(none),
                                          .held = settings.held_at.has_value(),
                                          .weight_Nm = weight_Nm,
                                          .friction_Nm = friction,
                                          .touched = settings.touched});
  return std::unique_ptr<EmulatedArm>(new EmulatedArm(std::move(body)));
}

std::size_t EmulatedArm::motors() const noexcept { return static_cast<std::size_t>(body_->position_rad.size()); }
double EmulatedArm::position_rad(std::size_t motor) const noexcept {
  return body_->position_rad[static_cast<Eigen::Index>(motor)];
}
double EmulatedArm::velocity_rad_per_s(std::size_t motor) const noexcept {
  return body_->velocity_rad_per_s[static_cast<Eigen::Index>(motor)];
}
arm_plants::ToolState EmulatedArm::tool() const { return body_->plant.tool(); }
bool EmulatedArm::held() const noexcept { return body_->held; }

void EmulatedArm::step(std::span<const double> torque_Nm) noexcept {
  Body& body = *body_;
  for (Eigen::Index i = 0; i < body.position_rad.size(); ++i) {
    body.torque.torque[i] = torque_Nm[static_cast<std::size_t>(i)];
  }
  if (body.held) {
    const JointVector left_Nm = (body.torque.torque - body.weight_Nm).cwiseAbs();
    body.held = (left_Nm.array() > body.friction_Nm.array()).any();
    if (body.held) return;
  }
  body.plant.write(body.torque);
  body.plant.step(body.touched ? body.touched(body.plant.tool()) : arm_plants::ToolForce{});
  body.position_rad = body.plant.link_position();
  body.velocity_rad_per_s = body.plant.link_velocity();
}

}  // namespace tactus::emulation
