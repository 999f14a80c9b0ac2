// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/tool_operator.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::real_time {

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
  std::optional<Led> led;
  JointVector led_about_rad;
  JointVector inertia_kg_m2;  ///< of each joint there, the others at rest
  double led_s = 0.0;         ///< since the motors carry the arm
  std::optional<Tapping> tapping;
  std::optional<arm::Vector3> taps_from_m;  ///< once it does
  std::optional<arm_plants::Wall> wall;
  double contact_N = 0.0;

  /// What the hand that leads gives each joint.
  [[nodiscard]] double hand_Nm(Eigen::Index joint) const noexcept;
  /// What the hand that taps does to the tool.
  [[nodiscard]] arm::Vector3 tap_N(const arm_plants::ToolState& tool) noexcept;
  /// All that acts on the tool.
  [[nodiscard]] arm_plants::ToolForce on_tool() noexcept;
};

namespace {

constexpr double step_s = 1e-4;

/// Where the hand wants a joint, over the reach, and how fast.
struct Wanted {
  double place = 0.0, per_s = 0.0;
};
Wanted path_of(Eigen::Index joint, double t_s) noexcept {
  constexpr double slowest_Hz = 0.2, apart_Hz = 0.043, quicker = 2.3, share = 0.65;
  const double slow = 2.0 * std::numbers::pi * (slowest_Hz + apart_Hz * static_cast<double>(joint));
  const double fast = quicker * slow;
  return {.place = share * std::sin(slow * t_s) + (1.0 - share) * std::sin(fast * t_s),
          .per_s = share * slow * std::cos(slow * t_s) + (1.0 - share) * fast * std::cos(fast * t_s)};
}

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

double EmulatedArm::Body::hand_Nm(Eigen::Index joint) const noexcept {
  const double t_s = led ? led_s - led->after_s : 0.0;
  if (!(t_s > 0.0)) return 0.0;
  constexpr double firm_Hz = 3.0, comes_in_s = 2.0;
  const double firm = 2.0 * std::numbers::pi * firm_Hz;
  const Wanted wanted = path_of(joint, t_s);
  const double away_rad = led_about_rad[joint] + led->reach_rad * wanted.place - position_rad[joint];
  const double slower_rad_per_s = led->reach_rad * wanted.per_s - velocity_rad_per_s[joint];
  return std::min(1.0, t_s / comes_in_s) * inertia_kg_m2[joint] *
         (firm * firm * away_rad + 2.0 * firm * slower_rad_per_s);
}

arm::Vector3 EmulatedArm::Body::tap_N(const arm_plants::ToolState& tool) noexcept {
  const double t_s = tapping ? led_s - tapping->after_s : 0.0;
  if (!(t_s > 0.0)) return arm::Vector3::Zero();
  if (!taps_from_m) taps_from_m = tool.position_m;
  constexpr double stiffness_N_per_m = 400.0, damping_N_s_per_m = 30.0, longest_away_s = 1.0, comes_in_s = 2.0;
  const double away_s = std::min(0.5 * tapping->period_s, longest_away_s), turn = 2.0 * std::numbers::pi / away_s;
  // The first one comes once the hand holds the tool firmly.
  const double phase_s = t_s > comes_in_s ? std::fmod(t_s - comes_in_s, tapping->period_s) : tapping->period_s;
  arm::Vector3 aim_m = *taps_from_m, aim_m_per_s = arm::Vector3::Zero();
  if (phase_s < away_s) {
    aim_m.z() -= 0.5 * tapping->depth_m * (1.0 - std::cos(turn * phase_s));
    aim_m_per_s.z() = -0.5 * tapping->depth_m * turn * std::sin(turn * phase_s);
  }
  return std::min(1.0, t_s / comes_in_s) *
         (stiffness_N_per_m * (aim_m - tool.position_m) + damping_N_s_per_m * (aim_m_per_s - tool.velocity_m_per_s));
}

arm_plants::ToolForce EmulatedArm::Body::on_tool() noexcept {
  if (!touched && !tapping && !wall) return {};
  const arm_plants::ToolState tool = plant.tool();
  arm_plants::ToolForce force = touched ? touched(tool) : arm_plants::ToolForce{};
  force.force_N += tap_N(tool);
  if (wall) {
    const arm::Vector3 contact = wall->force_N(tool);
    contact_N = contact.norm();
    force.force_N += contact;
  }
  return force;
}

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
  // Of it counts only how firm the hand that leads is.
  const auto chain = arm::Chain::make(settings.chain);
  if (!chain) return chain.error();
  const JointVector at = plant->link_position(), weight_Nm = plant->bearing_torque();
  JointVector friction = none;
  constexpr double untold_Nm = 0.1;  // of a step of torque
  for (Eigen::Index i = 0; i < joints; ++i) {
    friction[i] = settings.chain.joints[static_cast<std::size_t>(i)].friction.coulomb_N_m + untold_Nm;
  }
  std::optional<arm_plants::Wall> wall;
  if (settings.surface) {
    const auto contact = mechanics::Environment::make({.stiffness_N_per_m = settings.surface->stiffness_N_per_m,
                                                       .damping_N_s_per_m = settings.surface->damping_N_s_per_m},
                                                      Seconds{step_s});
    if (!contact) return under("surface", contact.error());
    wall = arm_plants::Wall{.point_m = plant->tool().position_m - settings.surface->gap_m * arm::Vector3::UnitZ(),
                            .normal = arm::Vector3::UnitZ(),
                            .contact = *contact};
  }
  auto body = std::make_unique<Body>(Body{.plant = *std::move(plant),
                                          .position_rad = at,
                                          .velocity_rad_per_s = none,
                                          .torque = ArmCommand::of_torque(none),
                                          .held = settings.held_at.has_value(),
                                          .weight_Nm = weight_Nm,
                                          .friction_Nm = friction,
                                          .touched = settings.touched,
                                          .led = settings.led,
                                          .led_about_rad = at,
                                          .inertia_kg_m2 = chain->mass_matrix(at).diagonal(),
                                          .tapping = settings.tapping,
                                          .taps_from_m = {},
                                          .wall = wall});
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
double EmulatedArm::contact_N() const noexcept { return body_->contact_N; }
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
  body.led_s += step_s;
  for (Eigen::Index i = 0; i < body.position_rad.size(); ++i) body.torque.torque[i] += body.hand_Nm(i);
  body.plant.write(body.torque);
  body.plant.step(body.on_tool());
  body.position_rad = body.plant.link_position();
  body.velocity_rad_per_s = body.plant.link_velocity();
}

}  // namespace tactus::real_time
