// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

/// Two layers: position-force control states what force would be transparent, and a tank of energy at each site states
/// how much of it may be had.
///
/// The motor's work is paid from the site's own tank and what the world does to the motor flows into it. So no site
/// gives more than it got, whatever the other layer, the channel or the other site do. Sites send each other packets of
/// energy, which only ever become available after they have left the other tank.
///
/// Sources: M. Franken, S. Stramigioli, S. Misra, C. Secchi, A. Macchelli, Bilateral telemanipulation with time delays:
/// a two-layer approach combining passivity and transparency, IEEE Trans. Robotics 27(4), 2011.
namespace tactus::control {

/// The tank of one site. Energies are those at this site's motor, unscaled.
///
/// Once a tick, in this order: `settle` enters the work of the force that was held since the last tick, exactly
/// F·(x(k) − x(k−1)), and what arrived; a fixed share of the level leaves as a packet; `limit` bounds the next force.
///
/// The published bound divides the level by the velocity of the last tick. Here it is the level over the longest step
/// that the motor can make in a tick, |F| ≤ H / (v_max T): however the motor moves up to that speed, the level never
/// falls below zero. It also lets the force fade with the level instead of cutting it off.
class EnergyTank {
 public:
  struct Params {
    double desired_level_J = 2e-3;
    double capacity_J = 2e-2;
    double transfer_per_s = 20.0;
    double refill_damping_N_s_per_m = 5.0;
    double fastest_m_per_s = 1.0;
    signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
    static constexpr auto fields() {
      return List{field("desired_level_J", &Params::desired_level_J, units::joule, positive_up_to(100.0),
                        "Level at the start; below this level the master draws energy from the hand."),
                  field("capacity_J", &Params::capacity_J, units::joule, positive_up_to(1000.0),
                        "Level above which energy is discarded. Without this limit a long press would store the energy "
                        "for a long instability."),
                  field("transfer_per_s", &Params::transfer_per_s, units::per_second, between(0.0, 1e4),
                        "Share of the level that is sent to the other site per second."),
                  field("refill_damping_N_s_per_m", &Params::refill_damping_N_s_per_m, units::newton_second_per_metre,
                        between(0.0, 1000.0),
                        "Damping with which the master draws energy when its tank is empty; it decreases linearly to "
                        "zero at the desired level."),
                  field("fastest_m_per_s", &Params::fastest_m_per_s, units::metre_per_second, positive_up_to(100.0),
                        "Highest speed at which the motor can move, plus one encoder step per control cycle."),
                  field("velocity", &Params::velocity, "Filter of the velocity for the damping that draws energy.")};
    }
  };

  static Result<EnergyTank> make(const Params& params, Seconds dt);

  /// Enters the motor's work since the last tick and what arrived, and sends a packet. Real-time safe.
  void settle(double motor_position_m, const Arrival& arrival) noexcept;
  /// The part of `motor_force_N` that the level pays for. Real-time safe.
  [[nodiscard]] double limit(double motor_force_N) const noexcept;
  /// Damping in N s/m that draws energy: none from the desired level up. Real-time safe.
  [[nodiscard]] double refill_damping() const noexcept;
  /// The force that works along the motor's next step. Real-time safe.
  void applied(double motor_force_N) noexcept { applied_N_ = motor_force_N; }
  void reset() noexcept;

  [[nodiscard]] double level_J() const noexcept { return level_J_; }
  /// Sent to the other site so far.
  [[nodiscard]] double sent_J() const noexcept { return sent_J_; }

 private:
  EnergyTank(const Params& params, Seconds dt);

  double desired_level_J_;
  double capacity_J_;
  double transfer_share_;  ///< of the level, in a tick
  double refill_damping_N_s_per_m_;
  double longest_step_m_;
  double level_J_;
  double received_J_ = 0.0;
  double sent_J_ = 0.0;
  double applied_N_ = 0.0;
  double position_before_m_ = 0.0;
  bool started_ = false;
};

/// The master site: position-force control, the damper that fills the tank, then the tank's limit.
class TankMaster {
 public:
  struct Params {
    PositionForceMaster::Params display;
    EnergyTank::Params tank;
    static constexpr auto fields() {
      return List{field("display", &Params::display, "The master of position-force control."),
                  field("tank", &Params::tank, "The tank.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<TankMaster> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  /// Real-time safe.
  void applied(double motor_force_N) noexcept {
    tank_.applied(motor_force_N);
    display_.applied(motor_force_N);
  }
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept;
  [[nodiscard]] double level_J() const noexcept { return tank_.level_J(); }

 private:
  TankMaster(const PositionForceMaster& display, const EnergyTank& tank, const signal::FilteredDerivative& velocity)
      : display_(display), tank_(tank), velocity_(velocity) {}

  PositionForceMaster display_;
  EnergyTank tank_;
  signal::FilteredDerivative velocity_;
};

/// The slave site: its servo behind the tank's limit.
class TankSlave {
 public:
  struct Params {
    ServoPd::Params slave;
    EnergyTank::Params tank;
    static constexpr auto fields() {
      return List{field("slave", &Params::slave, "The servo."), field("tank", &Params::tank, "The tank.")};
    }
  };
  using Input = SlaveInput;
  using Output = SlaveOutput;

  static Result<TankSlave> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept;
  void applied(double motor_force_N) noexcept { tank_.applied(motor_force_N); }
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept;
  [[nodiscard]] double level_J() const noexcept { return tank_.level_J(); }

 private:
  TankSlave(const PositionForceSlave& site, const EnergyTank& tank) : site_(site), tank_(tank) {}

  PositionForceSlave site_;
  EnergyTank tank_;
};

}  // namespace tactus::control
