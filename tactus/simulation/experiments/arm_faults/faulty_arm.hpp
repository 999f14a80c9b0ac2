// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/watched_arm.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/arm_faults/injection.hpp>
#include <tactus/simulation/experiments/faults/process.hpp>
#include <tactus/simulation/experiments/faults/witness.hpp>
#include <tactus/simulation/teleoperator/packet_relay.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tactus::experiments {

/// One site of a run: its arm, the process that it runs in, and what a witness saw of both. Until its site
/// compensates gravity, the arm lies on a rest.
template <class SupervisedSite>
class FaultyArm {
 public:
  /// Drives that receive nothing for this time release, as the watchdogs of a rig's motors.
  static constexpr double drive_watchdog_s = 0.05;

  FaultyArm(FaultSite at, SupervisedSite first, SupervisedSite again, const arm_plants::ArmDevice& device,
            const Joints<control::SafetyGate::Params>& gates, const DescribedArm& described,
            const arm_control::MotorWatch& motor_watch, const FaultPlan& plan,
            const control::PacketJudgeParams& packets, double tick_s)
      : where(at),
        arm(device),
        motors(motor_watch),
        site(std::move(first)),
        restarted{std::move(again)},
        process(at),
        inbox({simulation::ImpairedLink(
                  plan.impairment,
                  signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(at == FaultSite::slave ? 1 : 2))},
              plan.impairment.delay_s + plan.impairment.jitter_s, tick_s),
        sent(packets.longest_age_s, tick_s),
        commanded(gates.size(), {.enabled = false}),
        driven_(commanded),
        gates_(gates),
        stands_(plan.kind != FaultKind::model_wrong),
        began_at_(arm.plant().link_position()) {
    stood_m_ = had_power_m_ = arm.plant().tool().position_m.z();
    // The law is entered in another order than the gate does: the last digits.
    constexpr double rounding = 1.0 + 1e-9;
    for (std::size_t i = 0; i < gates.size(); ++i) {
      motors_.emplace_back(rounding * gates[i].force_limit_N, rounding * gates[i].rate_limit_N_per_s,
                           gates[i].stop_time_s, tick_s);
      friction_N_m_.push_back(described.arm.chain.joints[i].friction.coulomb_N_m);
    }
  }

  FaultSite where;
  arm_plants::ArmDevice arm;
  arm_control::MotorWatch motors;  ///< whether they do as they are commanded
  SupervisedSite site;
  std::vector<SupervisedSite> restarted;  ///< what a process that is started again runs
  FaultProcessOf<control::JointPacket> process;
  simulation::JointPacketRelay inbox;        ///< the channel from the other site
  PacketWitness sent;                        ///< what this site sent, and what the other applied of it
  Joints<station::DeviceReading> sensed{};   ///< at this tick, faults included
  Joints<station::DeviceCommand> commanded;  ///< last, before any fault of the drives
  bool loses_power = false;                  ///< at this tick, by the fault
  double worked_J = 0.0;                     ///< on who touches its tool, at the tick before

  /// What the drives report at this tick, without any fault of theirs. An arm that lies on a rest does not move,
  /// whatever its motors give.
  [[nodiscard]] Joints<station::DeviceReading> read(std::int64_t tick) {
    Joints<station::DeviceReading> read = arm.read({.number = tick});
    for (std::size_t i = 0; stands_ && i < read.size(); ++i) {
      const station::DeviceCommand& joint = driven_[i];
      control::DriveReport& report = read[i].motor_report;
      report.force_N =
          joint.enabled ? joint.force_N + joint.law.force_N(read[i].position_m, report.velocity_m_per_s) : 0.0;
    }
    return read;
  }
  /// The site compares what its motors report with what it commanded last.
  void looks(std::int64_t elapsed_ticks) noexcept { station::watch(motors, sensed, commanded, elapsed_ticks); }
  /// A command of the site reaches its drives.
  void obeys(ArmFaultInjection& injection, const Joints<station::DeviceCommand>& command) {
    commanded = command;
    unheard_s_ = 0.0;
    drive(injection);
  }
  /// No command comes at this tick: the drives continue with the one they have, until they have waited too long.
  void goes_on(ArmFaultInjection& injection, double tick_s) {
    unheard_s_ += tick_s;
    drive(injection);
  }
  /// Whether the drives of all joints have power.
  [[nodiscard]] bool has_power() const { return commanded[0].enabled && !waited_too_long() && !loses_power; }

  /// Somebody puts an arm that has no power onto a rest: it does not move until its site compensates gravity. `made`
  /// are the parameters of such an arm.
  void is_caught(const arm_plants::ArmPlant::Params& made) {
    if (stands_ || has_power()) return;
    arm = {*arm_plants::ArmPlant::make(made, arm.plant().link_position()), arm.limits()};
    stands_ = true;
    carried_s_ = 0.0;
  }
  /// Once a tick, after the site: the rest is taken away when gravity compensation has ramped in, over `blend_s`.
  void is_carried(double tick_s, double blend_s) {
    carried_s_ = has_power() ? carried_s_ + tick_s : 0.0;
    stands_ = stands_ && carried_s_ <= blend_s;
  }
  /// One step of the arm.
  void step(const arm_plants::ToolForce& on_tool) {
    if (stands_) return;
    const arm::Vector3 before_m = arm.plant().tool().position_m;
    arm.step(on_tool);
    worked_J -= on_tool.force_N.dot(arm.plant().tool().position_m - before_m);
  }

  /// The witness at each motor: the torque that the site commanded at this tick, its law at the joint position that the
  /// site knows.
  void witness(FaultOutcome& outcome) {
    step_N_ = 0.0;
    for (std::size_t i = 0; i < motors_.size(); ++i) {
      const station::DeviceCommand& joint = commanded[i];
      double given_N_m = process.killed() || !joint.enabled ? 0.0 : joint.force_N;
      if (!process.stands_still() && joint.enabled && joint.law.acts()) {
        given_N_m += joint.law.force_N(sensed[i].position_m, sensed[i].motor_report.velocity_m_per_s);
        law_N_m_[i] = given_N_m - joint.force_N;
      } else if (process.stands_still() && !process.killed() && joint.enabled) {
        given_N_m += law_N_m_[i];
      } else {
        law_N_m_[i] = 0.0;
      }
      motors_[i].see(given_N_m, process.excused(), outcome);
      step_N_ = std::max(step_N_, motors_[i].step_N());
    }
  }
  /// Largest change of a motor's torque at this tick.
  [[nodiscard]] double step_N() const { return step_N_; }

  /// The fastest joint, over the velocity limit of its gate; of an arm without power 0.
  [[nodiscard]] double fastest_joint_share() const {
    const arm::JointVector velocity = arm.plant().link_velocity();
    double share = 0.0;
    for (std::size_t i = 0; has_power() && i < gates_.size(); ++i) {
      share = std::max(share, std::fabs(velocity[static_cast<Eigen::Index>(i)]) / gates_[i].velocity_limit_m_per_s);
    }
    return share;
  }
  /// How far and how fast the joints go from where the arm lay, until its site released them.
  void leaps(ArmHarm& harm) {
    for (const auto& gate : site.site().gates()) released_ = released_ || gate.motor().has_released();
    if (!has_power() || released_) return;
    harm.had_power = true;
    harm.moved_rad = std::max(harm.moved_rad, (arm.plant().link_position() - began_at_).cwiseAbs().maxCoeff());
    harm.leapt_rad_per_s = std::max(harm.leapt_rad_per_s, arm.plant().link_velocity().cwiseAbs().maxCoeff());
  }
  /// Whether a joint is farther than so many times the position limit of its gate.
  [[nodiscard]] bool is_beyond(double factor) const {
    const arm::JointVector position = arm.plant().link_position();
    for (std::size_t i = 0; i < gates_.size(); ++i) {
      if (std::fabs(position[static_cast<Eigen::Index>(i)]) >= factor * gates_[i].position_limit_m) return true;
    }
    return false;
  }
  /// Puts the torque with which the worst motor pushes, and how fast its joint goes, in a truth: what its motor really
  /// gives beyond anything between nothing and what bears the arm, and beyond what rubs there. In N m of a motor as
  /// strong as the gate of all joints lets one be.
  void put_push(SiteTruth& truth, double force_limit_N) const {
    const arm::JointVector bearing = arm.plant().bearing_torque(), velocity = arm.plant().link_velocity();
    const arm::JointVector given = arm.plant().read().torque;
    double worst = 0.0;
    for (std::size_t i = 0; i < gates_.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      const double over = given[at] - std::clamp(given[at], std::min(bearing[at], 0.0), std::max(bearing[at], 0.0));
      const double share = std::max(std::fabs(over) - friction_N_m_[i], 0.0) / gates_[i].force_limit_N;
      if (share <= worst) continue;
      worst = share;
      truth.drive_N = std::copysign(share * force_limit_N, over);
      truth.motor_m_per_s = velocity[at];
    }
  }
  /// How far the tool has sunk while its site compensates gravity without following, and fallen since it has no power.
  struct Sunk {
    double carried_m = 0.0;
    double fell_m = 0.0;
  };
  /// Once a tick; `free` where nobody holds the tool and no motor is tried, which moves it.
  Sunk sinks(double height_m, bool free) {
    const bool stands = has_power() && site.state() != control::SiteState::active && free;
    if (!stands) stood_m_ = height_m;
    if (has_power()) had_power_m_ = height_m;
    return {.carried_m = stood_m_ - height_m, .fell_m = had_power_m_ - height_m};
  }

 private:
  [[nodiscard]] bool waited_too_long() const { return unheard_s_ > drive_watchdog_s; }
  void drive(ArmFaultInjection& injection) {
    driven_ = commanded;
    if (waited_too_long()) {
      for (station::DeviceCommand& joint : driven_) joint.enabled = false;
    }
    injection.misdrive(where, driven_);
    arm.write(driven_);
  }

  Joints<station::DeviceCommand> driven_;  ///< last, with any fault of the drives
  Joints<control::SafetyGate::Params> gates_;
  std::vector<ForceWitness> motors_;
  std::vector<double> friction_N_m_;
  std::array<double, most_joints> law_N_m_{};  ///< what their laws gave when the site was stepped last
  double step_N_ = 0.0;
  double unheard_s_ = 0.0;
  double carried_s_ = 0.0;  ///< since its drives have power
  bool stands_;
  bool released_ = false;  ///< by its gates, once
  arm::JointVector began_at_;
  double stood_m_ = 0.0, had_power_m_ = 0.0;  ///< where the tool was
};

/// The drives of a site's arm, as `station::step` sees them.
template <class Here>
struct ArmDrives {
  Here& arm;
  ArmFaultInjection& injection;

  Joints<station::DeviceReading> read(const station::Tick&) noexcept { return arm.sensed; }
  void write(const Joints<station::DeviceCommand>& command) noexcept { arm.obeys(injection, command); }
  [[nodiscard]] station::DeviceHealth health() const noexcept {
    const bool disobeyed = arm.motors.found().what != arm_control::MotorFinding::none;
    return arm.loses_power || disobeyed ? station::DeviceHealth::lost : station::DeviceHealth::good;
  }
};

/// The channel of a site: the packets that wait for its process, and what the network does to those that it sends.
template <class Here, class There>
struct ArmFaultWay {
  Here& here;
  There& there;
  const ArmFaultInjection& injection;
  double tick_s;

  template <class Take>
  void receive(const station::Tick&, Take&& take) noexcept {
    here.process.hand_over(tick_s, [&](control::JointPacket packet) {
      // A control blinds the site to what differs.
      if (injection.hides_disagreement()) packet.agreement = here.site.agreement().own().excerpt(packet.sequence);
      take(packet);
    });
  }
  void send(const control::JointPacket& packet, const station::Tick& tick) noexcept {
    here.sent.sent(packet, tick.number);
    // To the leader it arrives at the next tick at the earliest.
    const std::int64_t arrives = tick.number + (there.where == FaultSite::master ? 1 : 0);
    const auto share = [this](std::size_t) { return injection.moment().during ? 1.0 : 0.0; };
    if (!injection.cuts()) there.inbox.send(packet, arrives, share);
  }
};

}  // namespace tactus::experiments
