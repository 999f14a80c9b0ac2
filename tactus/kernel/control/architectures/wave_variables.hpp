// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/servo_pd.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

/// Wave variables: the sites exchange u and v instead of velocity and force, so that no delay makes energy.
///
///     u = (b ẋ + F) / √(2b)        v = (b ẋ − F) / √(2b)        F ẋ = (u² − v²) / 2
///
/// b is the wave impedance, F positive when it resists the master and drives the slave. The power that enters the line
/// at one end is half the square of one number, so whatever the line does to that number short of enlarging it (delay,
/// filter, loss) is passive. The obvious alternative, sending ẋ and F themselves, makes energy with any delay.
///
/// Each site solves its pair for what it may choose. The master measures ẋ and displays F = b ẋ − √(2b) v; the slave
/// solves for the velocity ẋ = √(2/b) u − F/b that its own servo, whose force is F, has to follow.
///
/// Scales: the line carries the slave's scale, λ ẋ and F/μ of the master. A constant factor between the powers of the
/// two ends takes nothing from stability.
///
/// Sources: R. J. Anderson and M. W. Spong, Bilateral control of teleoperators with time delay, IEEE Trans. Automatic
/// Control 34(5), 1989; G. Niemeyer and J.-J. E. Slotine, Stable adaptive teleoperation, IEEE J. Oceanic Engineering
/// 16(1), 1991, and Telemanipulation with time delays, Int. J. Robotics Research 23(9), 2004.
namespace tactus::control {

/// The group `[control.wave]`.
struct WaveParams {
  double impedance_N_s_per_m = 5.0;
  double cutoff_Hz = 300.0;
  double correction_time_s = 0.05;
  signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
  static constexpr auto fields() {
    return List{field("impedance_N_s_per_m", &WaveParams::impedance_N_s_per_m, units::newton_second_per_metre,
                      positive_up_to(1000.0),
                      "Wave impedance b, for force and velocity at the slave; a larger value feels stiffer in contact "
                      "and heavier in free motion."),
                field("cutoff_Hz", &WaveParams::cutoff_Hz, units::hertz, positive,
                      "Cutoff of the first-order low-pass of the arriving wave; below half the sample rate."),
                field("correction_time_s", &WaveParams::correction_time_s, units::second, between(0.002, 10.0),
                      "Time constant with which a receiver corrects the position error that lost waves cause."),
                field("velocity", &WaveParams::velocity, "Filter of the master's velocity.")};
  }
};

/// The receiving end of one way of the line. What it gives out carries no more energy than was sent, over a channel
/// that delays, reorders or loses:
///
/// - A tick without a fresh message takes a zero wave. Holding the last one would make energy.
/// - The wave then goes through the low-pass y += α (u − y), whose gain is nowhere above 1.
/// - Lost waves are lost displacement, so the slave would drift. Each message therefore also carries the displacement
///   √(2/b) ∫u dt that all waves up to it carry, and the energy that was sent in all. What is missing of the
///   displacement is added over the correction time, as long as the energy that was sent and not yet given out pays
///   for it. (Integral and energy of the wave: G. Niemeyer and J.-J. E. Slotine, Towards force-reflecting
///   teleoperation over the Internet, ICRA 1998.)
class WaveReceiver {
 public:
  static Result<WaveReceiver> make(const WaveParams& params, Seconds dt);

  /// The wave to act on in this tick. `start_m` is the displacement from which the sender counts, as far as this site
  /// can determine, read at the first call: a difference between the two is made up for like a lost wave. Real-time
  /// safe.
  double step(const Arrival& arrival, double start_m) noexcept;
  void reset() noexcept { state_ = {}; }

 private:
  struct State {
    bool started = false;
    double filtered = 0.0;
    double sent_m = 0.0;   ///< displacement that the waves carried that were sent up to the newest message
    double taken_m = 0.0;  ///< displacement that was given out
    double purse_J = 0.0;  ///< energy sent less energy given out
    double sent_J = 0.0;
  };
  WaveReceiver(const WaveParams& params, double smoothing, Seconds dt);

  double dt_s_;
  double smoothing_;
  double metres_per_wave_;      ///< displacement that a wave carries in a tick
  double correction_per_tick_;  ///< share of what is missing that is made up for in a tick
  State state_;
};

/// The master site.
class WaveMaster {
 public:
  struct Params {
    double position_scale = 1.0;
    double force_gain = 1.0;
    double force_limit_N = 1.0;
    WaveParams wave;
    static constexpr auto fields() {
      return List{field("position_scale", &Params::position_scale, units::none, positive_up_to(1000.0),
                        "Slave motion divided by master motion, lambda."),
                  field("force_gain", &Params::force_gain, units::none, positive_up_to(1000.0),
                        "Displayed force over the slave's, mu."),
                  field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                        "Where the displayed force saturates."),
                  field("wave", &Params::wave, "Wave variables.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<WaveMaster> make(const Params& params, Seconds dt);

  /// Force, and the wave that leaves: u = √(2b) λẋ − v. A force that saturates takes less from the hand than that wave
  /// would carry, so the energy that is sent is what is really there, v²/2 + F λẋ/μ, and the receiver gives out no
  /// more. Real-time safe.
  Output respond(const Input& input) noexcept;
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept;

 private:
  WaveMaster(const Params& params, const WaveReceiver& receiver, const signal::FilteredDerivative& velocity,
             Seconds dt);

  double position_scale_;
  double force_gain_;
  double force_limit_N_;
  double impedance_N_s_per_m_;
  double dt_s_;
  WaveReceiver receiver_;
  signal::FilteredDerivative velocity_;
  bool started_ = false;
  double sent_m_ = 0.0;
  double sent_J_ = 0.0;
};

/// The slave site. Its servo is a spring and a damper from the position x_d that the waves ask for to the motor:
/// F = k (x_d − x) + d (ẋ_d − ẋ). Position and velocity of x_d are taken at the end of the tick, so F and ẋ_d are
/// solved for together. The line ends without reflection where the damper d equals the wave impedance.
class WaveSlave {
 public:
  struct Params {
    ServoPd::Params slave;
    WaveParams wave;
    static constexpr auto fields() {
      return List{field("slave", &Params::slave, "The servo."), field("wave", &Params::wave, "Wave variables.")};
    }
  };
  using Input = SlaveInput;
  using Output = SlaveOutput;

  static Result<WaveSlave> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept;

 private:
  WaveSlave(const Params& params, const WaveReceiver& receiver, const signal::FilteredDerivative& velocity, Seconds dt);

  double proportional_N_per_m_;
  double derivative_N_s_per_m_;
  double impedance_N_s_per_m_;
  double dt_s_;
  WaveReceiver receiver_;
  signal::FilteredDerivative velocity_;
  bool started_ = false;
  double wanted_m_ = 0.0;  ///< x_d
  double sent_m_ = 0.0;
  double sent_J_ = 0.0;
};

}  // namespace tactus::control
