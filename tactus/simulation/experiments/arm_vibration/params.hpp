// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>
#include <tactus/simulation/experiments/arm_vibration/released_law.hpp>

#include <array>
#include <cstdint>

/// Two arms that are coupled by position: does a joint vibrate, and by what?
namespace tactus::experiments {

enum class ArmVibrationKind { arm_vibration };
constexpr auto enumerators(ArmVibrationKind) {
  return std::array{Enumerator{ArmVibrationKind::arm_vibration, "arm-vibration"}};
}

/// Who holds the leader.
enum class HeldBy { hand, nobody };
constexpr auto enumerators(HeldBy) {
  return std::array{Enumerator{HeldBy::hand, "operator"}, Enumerator{HeldBy::nobody, "nobody"}};
}

/// What happens to the pair, and which joint is looked at.
struct ArmVibrationTask {
  ArmVibrationKind kind = ArmVibrationKind::arm_vibration;
  std::int64_t joint = 2;
  HeldBy held_by = HeldBy::hand;
  double reach_m = 0.2;
  double push_N = 10.0;
  double duration_s = 4.0;
  std::int64_t seed = 1;
  static constexpr auto fields() {
    using T = ArmVibrationTask;
    return List{
        field("kind", &T::kind, "Kind of the experiment."),
        field("joint", &T::joint, between(1, 8), "The joint that is judged, and that the faults under [cause] affect."),
        field("held_by", &T::held_by, "Whether the operator holds the leader's tool."),
        field("reach_m", &T::reach_m, units::metre, between(0.0, 0.5),
              "The operator moves the tool by this distance within two seconds, in the direction in which the joint "
              "moves it, and then holds the tool still."),
        field("push_N", &T::push_N, units::newton, between(0.0, 100.0),
              "If nobody holds the tool: largest force of a push of 0.1 s on the leader's tool, in the direction in "
              "which the joint moves it."),
        field("duration_s", &T::duration_s, units::second, between(3.5, 60.0),
              "Duration of the run. The reach or push starts at 0.5 s. The interval from 1 s to 2 s and the last "
              "second are judged."),
        field("seed", &T::seed, non_negative, "Seed from which lost frames and late control cycles are drawn.")};
  }
};

/// What may be wrong with a pair. As shipped nothing is.
struct VibrationCauses {
  double play_rad = 0.0;
  double flank_stiffness_N_m_per_rad = 10000.0;
  double flank_damping_N_m_s_per_rad = 2.0;
  double velocity_scale = 1.0;
  double friction_share = 1.0;
  double lost_share = 0.0;
  double outage_s = 0.0;
  static constexpr auto fields() {
    using C = VibrationCauses;
    return List{
        field("play_rad", &C::play_rad, arm::units::radian, between(0.0, 0.1),
              "Backlash between motor and link of the joint, from end to end, in both arms."),
        field("flank_stiffness_N_m_per_rad", &C::flank_stiffness_N_m_per_rad, Unit{"N m/rad", "_N_m_per_rad"},
              between(100.0, 1e5), "Stiffness of the transmission at the ends of the backlash."),
        field("flank_damping_N_m_s_per_rad", &C::flank_damping_N_m_s_per_rad,
              arm::units::newton_metre_second_per_radian, between(0.0, 20.0),
              "Damping in parallel with flank_stiffness_N_m_per_rad."),
        field("velocity_scale", &C::velocity_scale, units::none, between(0.1, 10.0),
              "Velocity range (VMAX) in the host's table divided by the range of the drive itself, for the leader's "
              "joint. The host reads the velocity too large by this factor and commands it too small by it."),
        field("friction_share", &C::friction_share, units::none, between(0.0, 2.0),
              "Friction of all joints divided by the value in their URDF; below 1 the feed-forward is too large."),
        field("lost_share", &C::lost_share, units::none, between(0.0, 0.98),
              "Share of the control cycles without a reply of the joint's drives, drawn for each arm."),
        field("outage_s", &C::outage_s, units::second, between(0.0, 1.0),
              "Mean length of an outage; 0, or less than a control cycle, draws each control cycle independently.")};
  }
};

/// The program that polls both arms: a loop for each arm and one that hands readings over, each by a clock of its own.
struct VibrationHost {
  double rate_Hz = 1000.0;
  std::int64_t answer_ticks = 2;
  double follower_phase = 0.4;
  double exchange_phase = 0.7;
  double late_s = 0.0;
  double plant_step_s = 1e-4;
  static constexpr auto fields() {
    using H = VibrationHost;
    return List{
        field("rate_Hz", &H::rate_Hz, units::hertz, between(20.0, 5000.0), "Control cycles per second of each loop."),
        field("answer_ticks", &H::answer_ticks, between(1, 200),
              "Control cycles from a command to the cycle that uses its reply: 1 if a cycle waits for the replies, 2 "
              "if it ends before they arrive, more if an adapter delays them."),
        field("follower_phase", &H::follower_phase, units::none, between(0.0, 0.999),
              "Delay of the follower's loop after the leader's, as a share of a control cycle."),
        field("exchange_phase", &H::exchange_phase, units::none, between(0.0, 0.999),
              "Delay of the loop that transfers readings between the arms after the leader's loop, as a share of a "
              "control cycle. If this key and follower_phase are 0, all loops run on one clock and this loop runs "
              "first."),
        field("late_s", &H::late_s, units::second, between(0.0, 0.1),
              "Largest lateness of a control cycle, drawn uniformly, as on a kernel without real-time scheduling."),
        field("plant_step_s", &H::plant_step_s, units::second, between(1e-5, 2e-4), "Step of the simulated arms.")};
  }
};

struct ArmVibrationParams {
  ArmVibrationTask task;
  VibrationCauses cause;
  VibrationHost host;
  ReleasedLaw::Params control;
  ArmParams arm;
  arm_plants::ToolOperator::Params person;
  static constexpr auto fields() {
    using P = ArmVibrationParams;
    return List{field("task", &P::task, "The course of the run."),
                field("cause", &P::cause, "Possible faults of the pair; by default it has no fault."),
                field("host", &P::host, "The program that polls both arms."),
                field("control", &P::control, "Commands to the drives of both arms."),
                field("arm", &P::arm, "Leader and follower, which are identical."),
                field("operator", &P::person, "The operator who holds the leader's tool.")};
  }
};

}  // namespace tactus::experiments
