#pragma once

#include <tactus/arm_control/arm_follower.hpp>
#include <tactus/arm_control/arm_leader.hpp>
#include <tactus/arm_control/motor_watch.hpp>
#include <tactus/arm_plants/person.hpp>
#include <tactus/control/safety_gate.hpp>
#include <tactus/control/supervision.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/experiments/faults/harm_bounds.hpp>
#include <tactus/mechanics/environment.hpp>

#include <array>
#include <cstdint>
#include <string>

/// A person taps a stiff surface through two robot arms.
namespace tactus::experiments {

/// A joint and its drive: what its URDF does not say, and where it begins.
struct ArmJoint {
  double start_rad = 0.0;
  double armature_kg_m2 = 0.0;
  double stiffness_share = 1.0;
  double position_step_rad = 0.0;
  double velocity_step_rad_per_s = 0.0;
  double torque_step_N_m = 0.0;
  static constexpr auto fields() {
    using J = ArmJoint;
    namespace u = arm::units;
    return List{field("start_rad", &J::start_rad, u::radian, any_finite,
                      "Position at the start of a tap; of a follower that is led joint by joint it is the leader's."),
                field("armature_kg_m2", &J::armature_kg_m2, u::kilogram_metre2, non_negative,
                      "Inertia of the rotor at the joint's side of the gear."),
                field("stiffness_share", &J::stiffness_share, units::none, positive_up_to(100.0),
                      "Stiffness of an elastic joint over joint_stiffness_N_m_per_rad of its arm."),
                field("position_step_rad", &J::position_step_rad, u::radian, between(0.0, 0.1),
                      "Step in which the drive tells position; 0 is exact."),
                field("velocity_step_rad_per_s", &J::velocity_step_rad_per_s, u::radian_per_second, between(0.0, 1.0),
                      "Step in which it tells velocity."),
                field("torque_step_N_m", &J::torque_step_N_m, u::newton_metre, between(0.0, 1.0),
                      "Step in which it tells torque.")};
  }
};

struct ToolPoint {
  double x_m = 0.0;
  double y_m = 0.0;
  double z_m = 0.0;
  static constexpr auto fields() {
    return List{field("x_m", &ToolPoint::x_m, units::metre, any_finite, "Along x of the last link."),
                field("y_m", &ToolPoint::y_m, units::metre, any_finite, "Along y of the last link."),
                field("z_m", &ToolPoint::z_m, units::metre, any_finite, "Along z of the last link.")};
  }
};

/// An arm as its URDF and its file have it. Of joints that slide rad stands for m, and N m for N.
struct ArmParams {
  std::string urdf;
  ToolPoint tool;
  double joint_stiffness_N_m_per_rad = 0.0;
  double joint_damping_N_m_s_per_rad = 0.0;
  arm_control::EachJoint<ArmJoint> joints;
  static constexpr auto fields() {
    using A = ArmParams;
    return List{
        field("urdf", &A::urdf,
              "URDF of the arm, z up; its path counts from the experiment's file. Effort limits bound "
              "the motors, damping and friction rub at them."),
        field("tool", &A::tool, "The point that the person holds, or that touches."),
        field("joint_stiffness_N_m_per_rad", &A::joint_stiffness_N_m_per_rad, Unit{"N m/rad", "_N_m_per_rad"},
              between(0.0, 1e6), "Of the transmission between motor and link; 0 is rigid."),
        field("joint_damping_N_m_s_per_rad", &A::joint_damping_N_m_s_per_rad,
              arm::units::newton_metre_second_per_radian, between(0.0, 100.0), "Damping beside that stiffness."),
        field("joints", &A::joints, "What the URDF does not say of each joint.")};
  }
};

/// Leader and follower. Joint i of the leader, counted from the base on, commands joint i of the follower, angle for
/// angle, so both have as many joints, with the same zero and sense; or it leads the follower's tool
/// (`arm_control::Coupling`), and both are what they are.
struct ArmPairParams : ArmParams {
  ArmParams follower;
  static constexpr auto fields() {
    return joined(ArmParams::fields(),
                  List{field("follower", &ArmPairParams::follower,
                             "The follower where it is another arm than the leader: then all of it stands here. "
                             "Without a urdf here it is like the leader. Joint i of the leader, counted from the base, "
                             "commands joint i of the follower, angle for angle, unless control.follower.coupling "
                             "says tool.")});
  }
};

struct ArmControlParams : arm_control::ArmLeader::Params {
  arm_control::ArmFollower::Params follower = {};
  static constexpr auto fields() {
    return joined(arm_control::ArmLeader::Params::fields(),
                  List{field("follower", &ArmControlParams::follower, "The follower's site.")});
  }
};

struct ArmClockParams {
  double rate_Hz = 1000.0;
  double plant_step_s = 1e-4;
  static constexpr auto fields() {
    return List{field("rate_Hz", &ArmClockParams::rate_Hz, units::hertz, between(100.0, 10000.0),
                      "Ticks per second; a command acts from the next tick on."),
                field("plant_step_s", &ArmClockParams::plant_step_s, units::second, between(1e-6, 5e-4),
                      "Step of the simulated arms, rounded so that a tick is a whole number of them.")};
  }
};

/// Which law the surface pushes back with: those of `mechanics::ContactLaw` that let go.
enum class SurfaceLaw { kelvin_voigt, hunt_crossley };
constexpr auto enumerators(SurfaceLaw) {
  return std::array{Enumerator{SurfaceLaw::kelvin_voigt, "kelvin-voigt"},
                    Enumerator{SurfaceLaw::hunt_crossley, "hunt-crossley"}};
}

struct ArmWallParams {
  SurfaceLaw law = SurfaceLaw::kelvin_voigt;
  double stiffness_N_per_m = 20000.0;
  double damping_N_s_per_m = 20.0;
  double exponent = 1.5;
  double dissipation_s_per_m = 0.5;
  static constexpr auto fields() {
    using W = ArmWallParams;
    return List{field("law", &W::law, "Contact law of the flat surface that the follower's tool meets."),
                field("stiffness_N_per_m", &W::stiffness_N_per_m, units::newton_per_metre, between(100.0, 1e6),
                      "Stiffness of the surface; with Hunt-Crossley the secant stiffness at a depth of 0.1 mm."),
                field("damping_N_s_per_m", &W::damping_N_s_per_m, units::newton_second_per_metre, between(0.0, 1e4),
                      "Its damping (not with Hunt-Crossley)."),
                field("exponent", &W::exponent, units::none, between(1.0, 2.5),
                      "Growth of the force with depth (Hunt-Crossley only)."),
                field("dissipation_s_per_m", &W::dissipation_s_per_m, units::second_per_metre, between(0.0, 100.0),
                      "Relative growth of the force with the rate of depth (Hunt-Crossley only).")};
  }
  /// The law along the depth, its surface at 0.
  [[nodiscard]] mechanics::Environment::Params environment() const noexcept {
    return {.law = law == SurfaceLaw::kelvin_voigt ? mechanics::ContactLaw::kelvin_voigt
                                                   : mechanics::ContactLaw::hunt_crossley,
            .stiffness_N_per_m = stiffness_N_per_m,
            .damping_N_s_per_m = damping_N_s_per_m,
            .exponent = exponent,
            .dissipation_s_per_m = dissipation_s_per_m};
  }
};

struct ProbeTorque {
  double torque_N_m = 0.0;
  static constexpr auto fields() {
    return List{field("torque_N_m", &ProbeTorque::torque_N_m, arm::units::newton_metre, between(0.0, 100.0),
                      "Peak of the torque with which its motor is tried, above its friction; 0: that of "
                      "supervision.probe.")};
  }
};

/// A gripper, or any joint beside an arm: both drives pull it to where the other side's is.
struct GripperParams : arm_control::DriveGains {
  double leader_share = 0.0;
  static constexpr auto fields() {
    return joined(arm_control::DriveGains::fields(),
                  List{field("leader_share", &GripperParams::leader_share, units::none, between(0.0, 1.0),
                             "The leader's gains over these, which are the follower's.")});
  }
};

/// How the motors of an arm take over its weight on arming (`control::SupportCheck`).
struct ArmSupportParams {
  double raise_s = 4.0;
  double weight_share = 0.3;
  double most_rad = 0.02;
  double most_rad_per_s = 0.4;
  static constexpr auto fields() {
    using P = ArmSupportParams;
    return List{
        field("raise_s", &P::raise_s, units::second, between(0.5, 30.0),
              "Time in which gravity compensation comes in, from nothing to all of it."),
        field("weight_share", &P::weight_share, units::none, positive_up_to(1.0),
              "Share of a joint's gravity torque by which it may be wrong; or else the torque with which the motor is "
              "tried, whichever is more. Beyond it the arm is released."),
        field("most_rad", &P::most_rad, arm::units::radian, positive_up_to(0.03),
              "Travel of a joint meanwhile beyond which the arm is released; m of one that slides."),
        field("most_rad_per_s", &P::most_rad_per_s, arm::units::radian_per_second, positive_up_to(0.5),
              "Speed of a joint meanwhile beyond which it is; m/s of one that slides.")};
  }
};

/// What stands between the sites and the motors of a rig, and in `tactus faults`. Taps in virtual time have none of it.
struct ArmRigParams {
  control::SafetyGate::Params leader_gate;
  control::SafetyGate::Params follower_gate;
  control::SupervisionParams supervision;
  ArmSupportParams support;
  arm_control::EachJoint<ProbeTorque> probe_torque;
  arm_control::MotorWatch::Params motor_watch;
  GripperParams gripper{{.stiffness_N_m_per_rad = 0.0, .damping_N_m_s_per_rad = 0.0}};
  static constexpr auto fields() {
    using P = ArmRigParams;
    return List{
        field("leader_gate", &P::leader_gate,
              "The safety gate of each of the leader's joints; what the rig file allows a joint holds beside it."),
        field("follower_gate", &P::follower_gate, "The same of the follower's."),
        field("supervision", &P::supervision, "What the sites make of one another and of their own state."),
        field("support", &P::support, "How gravity compensation comes in on arming, and how it is judged."),
        field("probe_torque", &P::probe_torque, "With which torque each motor's sign is tried on arming."),
        field("motor_watch", &P::motor_watch, "When a motor does not give the torque that it is commanded."),
        field("gripper", &P::gripper,
              "How joints of the rig are driven that the arm does not have; with no gains such a joint is refused.")};
  }
};

/// What a fault in one of two arms may do to the person who holds the leader and to whoever is at the follower's tool.
struct ArmHarmBounds : HarmBounds {
  double sank_m = 0.025;
  static constexpr auto fields() {
    return joined(HarmBounds::fields(),
                  List{field("sank_m", &ArmHarmBounds::sank_m, units::metre, positive,
                             "How far a tool that nobody holds may sink while its site promises to carry the arm.")});
  }
};

/// `tactus faults` on two arms.
struct ArmFaultsParams {
  std::int64_t seeds = 100;
  std::string only;
  ArmHarmBounds bounds{{.given_J = 0.5,
                        .speed_m_per_s = 1.5,
                        .strayed_m = 0.1,
                        .hand_force_N = 140.0,
                        .tool_force_N = 280.0,
                        .pressing_N = 140.0,
                        .release_s = 1.0}};
  static constexpr auto fields() {
    using P = ArmFaultsParams;
    return List{field("seeds", &P::seeds, between(1, 1000000), "Runs of each fault; task.seed draws them."),
                field("only", &P::only, "The id of one row, where not all are wanted; empty is all."),
                field("bounds", &P::bounds, "What a fault may do to people, measured at the tools.")};
  }
};

enum class ArmTappingKind { arm_tapping };
constexpr auto enumerators(ArmTappingKind) {
  return std::array{Enumerator{ArmTappingKind::arm_tapping, "arm-tapping"}};
}

/// Where the surface lies that the tool goes to, along the axes of the base.
enum class TapDirection { down, along_x, along_y };
constexpr auto enumerators(TapDirection) {
  return std::array{Enumerator{TapDirection::down, "down"}, Enumerator{TapDirection::along_x, "along-x"},
                    Enumerator{TapDirection::along_y, "along-y"}};
}

/// The taps, each with a speed, a depth and errors of the model of its own.
struct ArmTappingTask {
  ArmTappingKind kind = ArmTappingKind::arm_tapping;
  std::int64_t taps = 32;
  std::int64_t seed = 1;
  std::int64_t pose = 0;
  TapDirection direction = TapDirection::down;
  double slowest_m_per_s = 0.08;
  double fastest_m_per_s = 0.16;
  double shallowest_m = 0.006;
  double deepest_m = 0.012;
  double observation_s = 0.6;
  double model_error = 0.2;
  static constexpr auto fields() {
    using T = ArmTappingTask;
    return List{
        field("kind", &T::kind, "Which experiment this is."),
        field("taps", &T::taps, between(1, 100000), "Number of taps in the ensemble."),
        field("seed", &T::seed, non_negative, "Seed that draws the ensemble."),
        field("pose", &T::pose, between(0, 1000),
              "Where both arms begin: 0 at start_rad of each joint, and others drawn within 0.6 rad of it by this "
              "number, "
              "no nearer to a singular pose than three quarters of it."),
        field("direction", &T::direction, "Where the surface lies that the person goes to."),
        field("slowest_m_per_s", &T::slowest_m_per_s, units::metre_per_second, between(0.001, 2.0),
              "Slowest approach: intended speed at the surface."),
        field("fastest_m_per_s", &T::fastest_m_per_s, units::metre_per_second, between(0.001, 2.0),
              "Fastest approach."),
        field("shallowest_m", &T::shallowest_m, units::metre, between(1e-4, 0.1),
              "Smallest depth: how far beyond the surface the person means to go."),
        field("deepest_m", &T::deepest_m, units::metre, between(1e-4, 0.1), "Largest depth."),
        field("observation_s", &T::observation_s, units::second, between(0.25, 10.0),
              "How long a tap is observed from first touch, while the person keeps pressing."),
        field(
            "model_error", &T::model_error, units::none, between(0.0, 0.5),
            "Every tap draws the errors of the model of induced motion (mass and inertia of each link, armature and "
            "friction of each joint, mass, stiffness and damping of the hand) evenly from minus to plus this share.")};
  }
};

struct ArmTappingParams {
  ArmTappingTask task;
  ArmPairParams arm;
  arm_plants::Person::Params person;
  ArmControlParams control;
  ArmWallParams wall;
  ArmClockParams servo;
  ArmRigParams rig;
  ArmFaultsParams faults;
  static constexpr auto fields() {
    using P = ArmTappingParams;
    return List{
        field("task", &P::task, "The taps."),
        field("arm", &P::arm, "The leader; and the follower, which is like it unless arm.follower says otherwise."),
        field("operator", &P::person, "The person who holds the leader's tool."),
        field("control", &P::control, "The sites of both arms."),
        field("wall", &P::wall, "What the follower's tool meets."),
        field("servo", &P::servo, "The clocks."),
        field("rig", &P::rig,
              "With --device and tactus faults alone: what stands between the sites and the motors of a rig. Where a "
              "key says N, m "
              "or m/s, N m, rad or rad/s are meant."),
        field("faults", &P::faults, "With tactus faults alone: how often each is tried, and what it may do.")};
  }
};

}  // namespace tactus::experiments
