// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/mechanics/environment.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/simulation/arm_plants/tool_operator.hpp>
#include <tactus/simulation/experiments/faults/harm_bounds.hpp>

#include <array>
#include <cstdint>
#include <string>

/// An operator taps a stiff surface through two robot arms.
namespace tactus::experiments {

using station::ArmClockParams;
using station::ArmControlParams;
using station::ArmJoint;
using station::ArmPairParams;
using station::ArmParams;
using station::ArmRigParams;

/// The law of the surface's force: those of `mechanics::ContactLaw` that do not pull.
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
                      "Damping of the surface (not with Hunt-Crossley)."),
                field("exponent", &W::exponent, units::none, between(1.0, 2.5),
                      "Exponent of the force as a function of depth (Hunt-Crossley only)."),
                field("dissipation_s_per_m", &W::dissipation_s_per_m, units::second_per_metre, between(0.0, 100.0),
                      "c: the force of the spring is multiplied by 1 + c times the rate of penetration, at least by 0 "
                      "(Hunt-Crossley only).")};
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

/// What a fault in one of two arms may do to the operator at the leader and to whoever is at the follower's tool.
struct ArmHarmBounds : HarmBounds {
  double sank_m = 0.025;
  static constexpr auto fields() {
    return joined(HarmBounds::fields(),
                  List{field("sank_m", &ArmHarmBounds::sank_m, units::metre, positive,
                             "Distance that a tool that nobody holds may sink while its site compensates gravity.")});
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
    return List{field("seeds", &P::seeds, between(1, 1000000), "Number of runs of each fault, drawn from task.seed."),
                field("only", &P::only, "Identifier of the only fault to run; empty: all."),
                field("bounds", &P::bounds, "Limits of the effects of a fault on people, measured at the tools.")};
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

/// Errors of what both sites compute gravity, external torque and wanted motion with, and of their drives. Each tap
/// draws its own for each joint of each arm, evenly from minus to plus these. Those of the model of induced motion are
/// `ArmTappingTask::model_error`.
struct ArmModelErrors {
  double mass = 0.0;
  double centre_m = 0.0;
  double friction = 0.0;
  double torque_constant = 0.0;
  double payload_kg = 0.0;
  static constexpr auto fields() {
    using E = ArmModelErrors;
    return List{field("mass", &E::mass, units::none, between(0.0, 0.5),
                      "Largest error of the mass and the inertia of each link, as a share."),
                field("centre_m", &E::centre_m, units::metre, between(0.0, 0.1),
                      "Largest error of the centre of mass of each link, along each axis."),
                field("friction", &E::friction, units::none, between(0.0, 1.0),
                      "Largest error of each joint's Coulomb and viscous friction, as a share."),
                field("torque_constant", &E::torque_constant, units::none, between(0.0, 0.5),
                      "Largest error of each motor's torque constant in its drive, as a share."),
                field("payload_kg", &E::payload_kg, units::kilogram, between(0.0, 10.0),
                      "Largest difference between the true mass at each tool and the mass that the models assume "
                      "there. Each tap draws it from minus to plus this value.")};
  }
  [[nodiscard]] bool any() const noexcept {
    return mass > 0.0 || centre_m > 0.0 || friction > 0.0 || torque_constant > 0.0 || payload_kg > 0.0;
  }
};

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
  double hold_s = 10.0;
  double model_error = 0.2;
  ArmModelErrors errors;
  static constexpr auto fields() {
    using T = ArmTappingTask;
    return List{
        field("kind", &T::kind, "Kind of the experiment."),
        field("taps", &T::taps, between(1, 100000), "Number of taps in the ensemble."),
        field("seed", &T::seed, non_negative, "Seed from which the ensemble is drawn."),
        field("pose", &T::pose, between(0, 1000),
              "Initial pose of both arms. 0: start_rad of each joint. Other numbers: seed of a random pose within 0.6 "
              "rad of start_rad and at least three quarters as far from a singular pose as start_rad. With the "
              "coupling tool only the follower's pose is random."),
        field("direction", &T::direction,
              "Direction in which the operator moves to the surface: down, or along the x or y axis of the base."),
        field("slowest_m_per_s", &T::slowest_m_per_s, units::metre_per_second, between(0.001, 2.0),
              "Slowest approach: intended speed at the surface."),
        field("fastest_m_per_s", &T::fastest_m_per_s, units::metre_per_second, between(0.001, 2.0),
              "Fastest approach."),
        field("shallowest_m", &T::shallowest_m, units::metre, between(1e-4, 0.1),
              "Smallest depth: how far beyond the surface the operator aims."),
        field("deepest_m", &T::deepest_m, units::metre, between(1e-4, 0.1), "Largest depth."),
        field("observation_s", &T::observation_s, units::second, between(0.25, 10.0),
              "Time for which a tap is observed from the first touch, while the operator keeps pressing."),
        field("hold_s", &T::hold_s, units::second, between(1.0, 60.0),
              "Time for which the operator holds still in the air, to measure the force on the hand and the "
              "drift at rest."),
        field("model_error", &T::model_error, units::none, between(0.0, 0.5),
              "Largest error of the model of induced motion, as a share. It applies to mass and inertia of "
              "each link, armature and friction of each joint, and mass, stiffness and damping of the hand. "
              "Each tap draws each error uniformly from minus to plus this share."),
        field("errors", &T::errors, "Errors of the sites' other model parameters, drawn for each tap.")};
  }
};

struct ArmTappingParams : station::ArmTeleoperatorParams {
  ArmTappingTask task;
  arm_plants::ToolOperator::Params person;
  ArmWallParams wall;
  ArmFaultsParams faults;
  static constexpr auto fields() {
    using P = ArmTappingParams;
    constexpr auto sites = station::ArmTeleoperatorParams::fields();  // arm, control, servo, rig
    return List{field("task", &P::task, "The taps."),
                at<0>(sites),
                field("operator", &P::person, "The operator who holds the leader's tool."),
                at<1>(sites),
                field("wall", &P::wall, "The surface that the follower's tool touches."),
                at<2>(sites),
                at<3>(sites),
                field("faults", &P::faults, "Only with tactus faults: number of runs, and limits of the effects.")};
  }
};

}  // namespace tactus::experiments
