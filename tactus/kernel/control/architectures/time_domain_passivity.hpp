// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/servo_pd.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

/// Time-domain passivity control of two ports: position-force control between two observers that count energy and two
/// dampers that remove what there is too much of.
///
/// Each site counts the energy that flowed into the line at its port and the energy that flowed out of it, apart, both
/// only growing. It sends the other site what flowed in so far. What a site may give out is what the other's newest
/// message states went in:
///
///     W(k) = E_in of the other site, as arrived − E_out(k) + E_PC(k−1) ≥ 0
///
/// A net balance could not be delayed, a growing total can: the total that arrives is never more than the present one,
/// whatever the delay does, and a lost message loses no energy. So W ≥ 0 at both ports makes the line passive.
///
/// Where W < 0, the passivity controller dissipates exactly the lack within a tick T:
///
/// - at the master, whose port takes a velocity and gives a force, by a damper: f = f̂ + α v, α = −W / (T v²);
/// - at the slave, whose port takes a force and gives a velocity, by a slip: v = v̂ − β f, β = −W / (T f²).
///
/// E_PC is what they dissipated so far. Energies are in the slave's scale: λẋ and f/μ at the master. The step that the
/// master's held force f(k−1) works along is x(k) − x(k−1), which is the work that was really done; the first papers
/// pair f(k) with that step.
///
/// The slave's port is the position that its servo follows and the reflected force, so its energy is exact and never
/// lacks. At the master the force has to be chosen before it is known where the hand goes in the next tick: W falls
/// below zero by what one tick's work is, and is made good in the next.
///
/// Near standstill α grows without bound, and a sampled damper is passive up to a point only. So the damping is
/// limited, but never to less than what cancels a force f̂ that drives the hand.
///
/// A slip leaves the slave behind. The difference is closed with the recovery time constant as the balance permits.
///
/// Sources: B. Hannaford and J.-H. Ryu, Time-domain passivity control of haptic interfaces, IEEE Trans. Robotics and
/// Automation 18(1), 2002; J.-H. Ryu, D.-S. Kwon, B. Hannaford, Stable teleoperation with time-domain passivity
/// control, IEEE Trans. Robotics and Automation 20(2), 2004; J.-H. Ryu, J. Artigas, C. Preusche, A passive bilateral
/// control scheme for a teleoperator with time-varying communication delay, Mechatronics 20(7), 2010.
namespace tactus::control {

/// Which force the slave sends back: that at its tip, or that of its servo. Seen from the line, servo, slave and
/// environment are a passive load for the servo's force alone. A force sensor feels steeper: see docs/theory.
enum class ReflectedForce { tip, servo };
constexpr auto enumerators(ReflectedForce) {
  return std::array{Enumerator{ReflectedForce::tip, "tip"}, Enumerator{ReflectedForce::servo, "servo"}};
}

/// The group `[control.passivity]`.
struct PassivityParams {
  ReflectedForce reflected_force = ReflectedForce::tip;
  double damping_limit_N_s_per_m = 20.0;
  double recovery_time_s = 0.05;
  signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
  static constexpr auto fields() {
    return List{
        field("reflected_force", &PassivityParams::reflected_force, "Force that the slave sends back."),
        field("damping_limit_N_s_per_m", &PassivityParams::damping_limit_N_s_per_m, units::newton_second_per_metre,
              between(0.0, 1000.0),
              "Largest damping at the master's motor. The damping force may be larger only as far as it cancels a "
              "displayed force in the direction of motion."),
        field("recovery_time_s", &PassivityParams::recovery_time_s, units::second, between(0.002, 10.0),
              "Time constant with which the slave corrects the position error that its passivity controller causes."),
        field("velocity", &PassivityParams::velocity, "Filter of the velocity on which the master's damping acts.")};
  }
};

/// The energy account of one port.
class PortObserver {
 public:
  /// Counts `work_J` that flowed into the line at this port, negative when it flowed out.
  void count(double work_J) noexcept { (work_J >= 0.0 ? in_J_ : out_J_) += work_J >= 0.0 ? work_J : -work_J; }
  /// Counts what the passivity controller dissipated.
  void dissipate(double work_J) noexcept { dissipated_J_ += work_J; }
  /// W: what may flow out while `other_in_J` is known to have flowed in at the other port.
  [[nodiscard]] double available_J(double other_in_J) const noexcept { return other_in_J - out_J_ + dissipated_J_; }
  /// What flowed into the line so far.
  [[nodiscard]] double in_J() const noexcept { return in_J_; }

 private:
  double in_J_ = 0.0;
  double out_J_ = 0.0;
  double dissipated_J_ = 0.0;
};

/// The master site: that of position-force control, its force damped where the observer asks for it.
class PassivityMaster {
 public:
  struct Params {
    PositionForceMaster::Params display;
    PassivityParams passivity;
    static constexpr auto fields() {
      return List{field("display", &Params::display, "The master of position-force control."),
                  field("passivity", &Params::passivity, "Observer and controller.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  /// Errors: those of the parts; a force gain of 0, by which the energy could not be scaled.
  static Result<PassivityMaster> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  /// The force that works along the next step of the motor. Real-time safe.
  void applied(double motor_force_N) noexcept;
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept;

 private:
  PassivityMaster(const Params& params, const PositionForceMaster& display, const signal::FilteredDerivative& velocity,
                  Seconds dt);

  double power_scale_;  ///< energy in the slave's scale over energy at the master's motor
  double damping_limit_N_s_per_m_;
  double dt_s_;
  PositionForceMaster display_;
  signal::FilteredDerivative velocity_;
  PortObserver port_;
  bool started_ = false;
  double position_before_m_ = 0.0;
  double reflected_N_ = 0.0;  ///< f̂ since the last tick
  double applied_N_ = 0.0;    ///< f since the last tick
};

/// The slave site.
class PassivitySlave {
 public:
  struct Params {
    ServoPd::Params slave;
    PassivityParams passivity;
    static constexpr auto fields() {
      return List{field("slave", &Params::slave, "The servo."),
                  field("passivity", &Params::passivity, "Observer and controller.")};
    }
  };
  using Input = SlaveInput;
  using Output = SlaveOutput;

  static Result<PassivitySlave> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  void applied(double motor_force_N) noexcept { applied_N_ = motor_force_N; }
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept;

 private:
  PassivitySlave(const Params& params, const ServoPd& servo, Seconds dt);

  ReflectedForce reflected_force_;
  double recovery_per_tick_;
  ServoPd servo_;
  PortObserver port_;
  bool started_ = false;
  double command_before_m_ = 0.0;
  double wanted_m_ = 0.0;  ///< what the servo follows
  double applied_N_ = 0.0;
};

}  // namespace tactus::control
