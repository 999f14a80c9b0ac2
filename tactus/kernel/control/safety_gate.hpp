// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/encoder_check.hpp>
#include <tactus/kernel/control/force_gate.hpp>
#include <tactus/kernel/control/motion_check.hpp>
#include <tactus/kernel/control/passivity_monitor.hpp>
#include <tactus/kernel/control/reversal_check.hpp>
#include <tactus/kernel/control/stopping_brake.hpp>
#include <tactus/kernel/control/thermal_limit.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <cmath>
#include <cstdint>
#include <optional>

namespace tactus::control {

/// All that is between a controller and a motor. In this order:
///
/// 1. **finite**: a reading or a command that is not a number latches a fault before any limiter sees it;
/// 2. **encoder**: a reading that cannot be true latches a fault, and the one before is in its place; so does a
///    position that contradicts the velocity that its drive reports, or a drive that repeats itself (`MotionCheck`);
/// 3. **reversal**: speed gained against the force latches a fault;
/// 4. **energy**: `PassivityMonitor` damps, then latches and damps alone;
/// 5. **workspace** and **velocity**: from the limit outward a force that pushes on fades; at 1.25 times the limit it
/// is
///    gone and a fault latched;
/// 6. **thermal**: `ThermalLimit` folds the peak back to what the motor can give for ever;
/// 7. **force** and **rate**: `ForceGate`.
///
/// After a fault the force falls to zero within `stop_time_s`, or sooner at the rate limit, and stays there until the
/// gate is re-armed; after one of energy, damping stays. Every limit has an upper bound, so a configuration can tighten
/// the gate and not remove it. It knows nothing of the controller.
class SafetyGate {
 public:
  struct Params {
    double force_limit_N = 10.0;
    double rate_limit_N_per_s = 1e5;
    double velocity_limit_m_per_s = 50.0;
    double position_limit_m = 10.0;
    double stop_time_s = longest_stop_s;
    EncoderCheck::Params encoder{};
    MotionCheck::Params motion{};
    PassivityMonitor::Params energy{};
    ReversalCheck::Params reversal{};
    ThermalLimit::Params thermal{};
    static constexpr auto fields() {
      return List{
          field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                "Largest force in either direction that reaches the motor."),
          field("rate_limit_N_per_s", &Params::rate_limit_N_per_s, units::newton_per_second, positive_up_to(1e6),
                "Largest rate of change of the force that reaches the motor."),
          field("velocity_limit_m_per_s", &Params::velocity_limit_m_per_s, units::metre_per_second,
                positive_up_to(100.0),
                "Speed above which the gate reduces a force in the direction of motion. At 1.25 times this speed the "
                "gate reports a fault."),
          field("position_limit_m", &Params::position_limit_m, units::metre, positive_up_to(10.0),
                "Distance from zero above which the gate reduces a force that acts away from zero. At 1.25 times this "
                "distance the gate reports a fault."),
          field("stop_time_s", &Params::stop_time_s, units::second, positive_up_to(longest_stop_s), stop_time_doc),
          field("encoder", &Params::encoder, "Check of the measured position."),
          field("motion", &Params::motion,
                "Check of the position against the velocity that the drive reports; only for drives that report one."),
          field("energy", &Params::energy, "Limits of the energy that the motor delivers."),
          field("reversal", &Params::reversal, "Detection of a motor that pushes in the wrong direction."),
          field("thermal", &Params::thermal, "Thermal limit of the motor.")};
    }
  };
  struct Input {
    double command_N = 0.0;
    double position_m = 0.0;  ///< measured, in the direction of the force
  };
  using Output = double;

  /// The velocity that the limit and the damping act on is low-passed here: an encoder step within one tick is fast.
  static constexpr double velocity_cutoff_Hz = 200.0;
  /// A limit times this is a fault.
  static constexpr double fault_factor = 1.25;

  /// Errors: a value out of bounds; those of the parts, under their groups; a servo rate below 455 Hz.
  static Result<SafetyGate> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const auto force = ForceGate::make({.force_limit_N = params.force_limit_N,
                                        .rate_limit_N_per_s = params.rate_limit_N_per_s,
                                        .stop_time_s = params.stop_time_s},
                                       dt);
    if (!force) return force.error();
    const auto encoder = EncoderCheck::make(params.encoder, dt);
    if (!encoder) return under("encoder", encoder.error());
    const auto motion = MotionCheck::make(params.motion, dt);
    if (!motion) return under("motion", motion.error());
    const auto energy = PassivityMonitor::make(params.energy, dt);
    if (!energy) return under("energy", energy.error());
    const auto reversal = ReversalCheck::make(params.reversal, dt);
    if (!reversal) return under("reversal", reversal.error());
    const auto thermal = ThermalLimit::make(params.thermal, dt);
    if (!thermal) return under("thermal", thermal.error());
    const auto brake = StoppingBrake::make({.damping_N_s_per_m = params.energy.damping_N_s_per_m}, dt);
    if (!brake) return under("energy", brake.error());
    const auto velocity = signal::FilteredDerivative::make({.cutoff_Hz = velocity_cutoff_Hz}, dt);
    if (!velocity) return velocity.error();
    return SafetyGate(params, *force, *encoder, *motion, *energy, *reversal, *brake, *thermal, *velocity, dt);
  }

  /// Looks at a reading, before the controller does: the position in m to assume, which is the last good one where
  /// this one is not. `elapsed_ticks` is more than 1 after a stall: all checks count the time that really passed.
  /// `resisting_N` is what a sensor states that pushes back against the motor: at a slave what is at its tip, at a
  /// master the hand. `age_s` is how old the position is at this tick, negative where it is younger. Speed and jump are
  /// judged over the time between two measurements, which is not that between two ticks where a bus has a cycle of its
  /// own; a position that was read before states nothing new of them. `tells` is what the drive reports alongside the
  /// position. Real-time safe.
  double believe(double position_m, std::int64_t elapsed_ticks = 1, std::optional<double> resisting_N = std::nullopt,
                 double age_s = 0.0, const DriveReport& tells = {}) noexcept;
  /// The force in N that may reach the motor instead of `command_N`. Always finite. Once a tick, after `believe`.
  /// `stops` where the site gives its force up: it then falls within `stop_time_s`, as after a fault. Real-time safe.
  double pass(double command_N, bool stops = false) noexcept;
  /// Both. Real-time safe.
  double step(const Input& input) noexcept {
    believe(input.position_m);
    return pass(input.command_N);
  }

  /// No fault, no force, a cool motor, as made.
  void reset() noexcept {
    rearm();
    force_.reset();
    thermal_.reset();
    allowed_N_ = force_limit_N_;
  }
  /// No fault any more and an empty account of energy; the force continues from where it is, and the motor is as warm.
  void rearm() noexcept;
  /// Latches `not_finite`, for what is found elsewhere.
  void refuse() noexcept { latch(GateFault::not_finite); }
  /// No force from now on, damping neither, until the gate is re-armed; no fault.
  void release() noexcept {
    released_ = true;
    brakes_ = false;
  }
  /// No force from now on but that of `StoppingBrake`, with the damping of `energy`, and where a fault is latched not
  /// that either, until the gate is re-armed; no fault.
  void brake() noexcept { released_ = brakes_ = true; }

  [[nodiscard]] GateFault fault() const noexcept { return fault_ != GateFault::none ? fault_ : force_.fault(); }
  /// Whether no command passes any more, for a fault or because it was commanded to release the force.
  [[nodiscard]] bool has_released() const noexcept { return released_ || fault() != GateFault::none; }
  [[nodiscard]] ActiveLimit limit() const noexcept { return limit_; }
  /// Of the reading that is assumed, low-passed.
  [[nodiscard]] double velocity_m_per_s() const noexcept { return velocity_m_per_s_; }
  /// What the motor gave, as `PassivityMonitor` counts it.
  [[nodiscard]] double given_J() const noexcept { return energy_.given_J(); }
  /// What `contradicted`, or `encoder_frozen` of a drive that repeats itself, was latched by; no time where neither
  /// was.
  [[nodiscard]] const MotionCheck::Evidence& evidence() const noexcept { return motion_.evidence(); }
  /// What passed last.
  [[nodiscard]] double passed_N() const noexcept { return force_.passed_N(); }
  /// The last stage alone, for an actuator that nobody measures.
  [[nodiscard]] const ForceGate& force_gate() const noexcept { return force_; }

 private:
  SafetyGate(const Params& params, const ForceGate& force, const EncoderCheck& encoder, const MotionCheck& motion,
             const PassivityMonitor& energy, const ReversalCheck& reversal, const StoppingBrake& brake,
             const ThermalLimit& thermal, const signal::FilteredDerivative& velocity, Seconds dt)
      : dt_s_(dt.value),
        velocity_limit_m_per_s_(params.velocity_limit_m_per_s),
        position_limit_m_(params.position_limit_m),
        force_limit_N_(params.force_limit_N),
        force_(force),
        encoder_(encoder),
        motion_(motion),
        energy_(energy),
        reversal_(reversal),
        brake_(brake),
        thermal_(thermal),
        derivative_(velocity) {}

  /// The first fault stays, but for one of energy, after which damping needs what any other fault takes away.
  void latch(GateFault fault) noexcept {
    if (this->fault() == GateFault::none || this->fault() == GateFault::energy) fault_ = fault;
  }

  double dt_s_;
  double velocity_limit_m_per_s_;
  double position_limit_m_;
  double force_limit_N_;
  ForceGate force_;
  EncoderCheck encoder_;
  MotionCheck motion_;
  PassivityMonitor energy_;
  ReversalCheck reversal_;
  StoppingBrake brake_;
  ThermalLimit thermal_;
  signal::FilteredDerivative derivative_;
  double believed_m_ = 0.0;
  std::int64_t elapsed_ticks_ = 1;
  double age_s_ = 0.0;  ///< of what was read last, at its tick
  double velocity_m_per_s_ = 0.0;
  double damping_N_s_per_m_ = 0.0;
  double allowed_N_ = force_limit_N_;  ///< by the warmth of the motor
  bool released_ = false;
  bool brakes_ = false;
  GateFault fault_ = GateFault::none;
  ActiveLimit limit_ = ActiveLimit::none;
};

}  // namespace tactus::control
