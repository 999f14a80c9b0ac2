// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/servo_pd.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

/// Four-channel control with local force loops: each site sends the other its position and its force.
///
///     F_cm = −C_m x_m − C_4 x_s − C_2 F_e + C_6 F_h     on the master's motor
///     F_cs = −C_s x_s + C_1 x_m − C_5 F_e + C_3 F_h     on the slave's motor
///
/// F_h is the force of the hand on the handle, positive toward the environment; F_e that of the environment on the
/// slave, positive when it pushes back. With D_m, D_s the dynamics of the devices from force to position, λ the
/// position scale and μ the force gain, every environment feels like itself, x_s = λ x_m and F_h = μ F_e, where
///
///     C_1 = λ (D_s + C_s),   C_4 = −(D_m + C_m) / λ,   C_2 = μ (1 + C_6),   C_3 = (1 + C_5) / μ
///
/// and C_5 and C_6 are not both −1. The controllers below keep C_1 and C_4 but for D_s and D_m, which ask for
/// accelerations: each site feeds back the position error by a PD, and a mass times a filtered acceleration can be fed
/// forward. The force channels are gains that may be set apart from the condition; `check_transparency` judges them.
///
/// Sources: D. A. Lawrence, Stability and transparency in bilateral teleoperation, IEEE Trans. Robotics and Automation
/// 9(5), 1993 (C_1 to C_4, C_m, C_s and the condition); K. Hashtrudi-Zaad and S. E. Salcudean, Analysis of control
/// architectures for teleoperation systems with impedance/admittance master and slave manipulators, Int. J. Robotics
/// Research 20(6), 2001 (C_5, C_6). There on velocities, with λ = μ = 1. docs/theory/four-channel.md derives it.
namespace tactus::control {

/// The channels of both sites but for the slave's PD, which all architectures share.
struct FourChannelParams {
  ServoPd::Params master{};
  double environment_force_gain = 1.0;
  double hand_force_gain = 1.0;
  double slave_force_loop_gain = 0.0;
  double master_force_loop_gain = 0.0;
  double master_feedforward_kg = 0.0;
  double slave_feedforward_kg = 0.0;
  signal::FilteredDerivative::Params acceleration{.cutoff_Hz = 30.0};
  static constexpr auto fields() {
    return List{
        field("master", &FourChannelParams::master, "The master's position controller: C_m, and C_4 without inertia."),
        field("environment_force_gain", &FourChannelParams::environment_force_gain, units::none, between(0.0, 1000.0),
              "C_2 divided by the force gain; for transparency set 1 + master_force_loop_gain."),
        field("hand_force_gain", &FourChannelParams::hand_force_gain, units::none, between(0.0, 1000.0),
              "C_3 times the force gain; for transparency set 1 + slave_force_loop_gain."),
        field("slave_force_loop_gain", &FourChannelParams::slave_force_loop_gain, units::none, between(-1.0, 100.0),
              "C_5, local force loop: the slave yields to 1 + C_5 times the tip force."),
        field("master_force_loop_gain", &FourChannelParams::master_force_loop_gain, units::none, between(-1.0, 100.0),
              "C_6, local force loop: the master yields to 1 + C_6 times the hand force."),
        field("master_feedforward_kg", &FourChannelParams::master_feedforward_kg, units::kilogram, between(0.0, 100.0),
              "Mass of the master in C_4, times the slave's filtered acceleration; 0 leaves it out."),
        field("slave_feedforward_kg", &FourChannelParams::slave_feedforward_kg, units::kilogram, between(0.0, 100.0),
              "Mass of the slave in C_1, times the master's filtered acceleration; 0 leaves it out."),
        field("acceleration", &FourChannelParams::acceleration,
              "Filter of the fed-forward accelerations, applied in both derivatives.")};
  }
};

/// An error unless the force channels meet the condition of transparency, C_2 = μ (1 + C_6) and C_3 = (1 + C_5) / μ
/// with C_5 and C_6 not both −1. It names the gain that differs and the value it should have. The position channels
/// meet theirs by construction, but for the inertia. Not for the loop.
Check check_transparency(const FourChannelParams& params);

/// Position through a filtered derivative twice: acceleration, delayed by two filters.
class FilteredAcceleration {
 public:
  explicit FilteredAcceleration(const signal::FilteredDerivative& derivative)
      : velocity_(derivative), acceleration_(derivative) {}
  /// In m/s² from a position in m. Real-time safe.
  double step(double position_m) noexcept { return acceleration_.step(velocity_.step(position_m)); }
  void reset() noexcept {
    velocity_.reset();
    acceleration_.reset();
  }

 private:
  signal::FilteredDerivative velocity_;
  signal::FilteredDerivative acceleration_;
};

/// The master site. Its motor force is what it displays, so the whole of it saturates at `force_limit_N`.
class FourChannelMaster {
 public:
  struct Params {
    double position_scale = 1.0;
    double force_gain = 1.0;
    double force_limit_N = 1.0;
    FourChannelParams four_channel{};
    static constexpr auto fields() {
      return List{
          field("position_scale", &Params::position_scale, units::none, positive_up_to(1000.0),
                "Slave motion divided by master motion, lambda."),
          field("force_gain", &Params::force_gain, units::none, between(0.0, 1000.0), "Hand force over tip force, mu."),
          field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                "Where the displayed force saturates."),
          field("four_channel", &Params::four_channel, "The channels.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<FourChannelMaster> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept {
    servo_.reset();
    slave_acceleration_.reset();
  }

 private:
  FourChannelMaster(const Params& params, const ServoPd& servo, const FilteredAcceleration& slave_acceleration)
      : params_(params), servo_(servo), slave_acceleration_(slave_acceleration) {}

  Params params_;
  ServoPd servo_;
  FilteredAcceleration slave_acceleration_;
};

/// The slave site. The positions that it receives are in its own scale.
class FourChannelSlave {
 public:
  struct Params {
    double force_gain = 1.0;
    ServoPd::Params slave{};
    FourChannelParams four_channel{};
    static constexpr auto fields() {
      return List{
          field("force_gain", &Params::force_gain, units::none, between(0.0, 1000.0), "Hand force over tip force, mu."),
          field("slave", &Params::slave, "The slave's position controller: C_s, and C_1 without inertia."),
          field("four_channel", &Params::four_channel, "The channels.")};
    }
  };
  using Input = SlaveInput;
  using Output = SlaveOutput;

  /// Fails where a value is out of bounds, and for a force gain of 0 that `hand_force_gain` would be divided by.
  static Result<FourChannelSlave> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept {
    servo_.reset();
    master_acceleration_.reset();
  }

 private:
  FourChannelSlave(const FourChannelParams& channels, double hand_force_gain, const ServoPd& servo,
                   const FilteredAcceleration& master_acceleration)
      : feedforward_kg_(channels.slave_feedforward_kg),
        force_loop_gain_(channels.slave_force_loop_gain),
        hand_force_gain_(hand_force_gain),
        servo_(servo),
        master_acceleration_(master_acceleration) {}

  double feedforward_kg_;
  double force_loop_gain_;
  double hand_force_gain_;  ///< C_3
  ServoPd servo_;
  FilteredAcceleration master_acceleration_;
};

/// Position-force control with cancellation of induced master motion, as paper A's appendix draws it: C_1 and C_2, and
/// cancellation as the slave's local force loop C_5. The master site is a plain `PositionForceMaster`.
///
///     C_1 = λ C_s,   C_2 = μ,   C_5 = −C_1 C_2 Ĝ,   Ĝ = 1 / (D̂_m + D̂_h): the model of master and hand, N to m
///
/// The slave knows what force it sent and so what the master displays a tick later; it runs the model on that and takes
/// the induced motion out of the position that it receives. Its command then equals that of the cancelling master to
/// round-off, nonlinear model or not, as long as the way forth and back takes one tick and no gate intervenes. With
/// more delay it subtracts the right motion at the wrong time, and `PositionForceMaster` is the one to use.
class CancellingSlave {
 public:
  struct Params {
    PositionForceMaster::Params master;
    ServoPd::Params slave;
    static constexpr auto fields() {
      return List{field("master", &Params::master, "What the slave knows of the master."),
                  field("slave", &Params::slave, "The slave's position controller.")};
    }
  };
  using Input = SlaveInput;
  using Output = SlaveOutput;

  /// `master.cancellation` has no effect: this slave cancels.
  static Result<CancellingSlave> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept {
    master_.reset();
    servo_.reset();
    sent_force_N_ = 0.0;
  }

 private:
  CancellingSlave(double position_scale, const PositionForceMaster& master, const ServoPd& servo)
      : position_scale_(position_scale), master_(master), servo_(servo) {}

  double position_scale_;
  PositionForceMaster master_;  ///< as it would answer if it cancelled
  ServoPd servo_;
  double sent_force_N_ = 0.0;  ///< at the last tick, so displayed from this one on
};

}  // namespace tactus::control
