#pragma once

#include <tactus/control/position_force.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/mechanics/cable_driven_master.hpp>
#include <tactus/mechanics/electric_slave.hpp>
#include <tactus/mechanics/operator.hpp>
#include <tactus/signal/delay_line.hpp>
#include <tactus/simulation/clock.hpp>

#include <cstdint>

namespace tactus::simulation {

/// The link between the sites: a constant delay each way, rounded to whole ticks.
struct ChannelParams {
  double to_slave_delay_s = 0.0;
  double to_master_delay_s = 0.0;
  static constexpr auto fields() {
    return std::tuple{field("to_slave_delay_s", &ChannelParams::to_slave_delay_s, units::second, between(0.0, 1.0),
                            "Delay of the position command, rounded to whole ticks."),
                      field("to_master_delay_s", &ChannelParams::to_master_delay_s, units::second, between(0.0, 1.0),
                            "Delay of the tip force, rounded to whole ticks; a message arrives at the next tick "
                            "at the earliest.")};
  }
};

/// A one-axis teleoperator in virtual time: person, master, two sites, channel, slave and wall.
///
/// The sites step once a tick, the plants in substeps between ticks. Within a tick everything is sampled first, then
/// the master steps, then the slave. A message to the slave with no channel delay arrives in the same tick, one to the
/// master at the next: on one computer the loop closes with one tick of delay plus the computation delay.
///
/// A value: a copy is a fork of the run. Runs are equal bit for bit for equal parameters and input.
class Teleoperator {
 public:
  struct Params {
    mechanics::CableDrivenMaster::Params master;
    mechanics::ElectricSlave::Params slave;
    mechanics::Environment::Params environment;
    mechanics::Operator::Params person;
    ChannelParams channel;
    ServoParams servo;
    PlantClockParams plant;
    control::PositionForce control;
    static constexpr auto fields() {
      return std::tuple{field("master", &Params::master, "The master device."),
                        field("slave", &Params::slave, "The slave device."),
                        field("environment", &Params::environment, "The wall before the slave."),
                        field("operator", &Params::person, "The person at the master."),
                        field("channel", &Params::channel, "The link between the sites."),
                        field("servo", &Params::servo, "The servo clock."),
                        field("plant", &Params::plant, "The clock of the simulated plants."),
                        field("control", &Params::control, "Both sites of position-force control.")};
    }
  };

  /// What one tick showed. Positions and forces as at the tick; contact over the tick that follows.
  struct Record {
    double time_s = 0.0;
    double master_position_m = 0.0;     ///< measured, at the motor
    double induced_position_m = 0.0;    ///< the model's estimate of what the force did to it
    double command_m = 0.0;             ///< position command that left the master
    double slave_position_m = 0.0;      ///< measured, at the motor
    double tip_position_m = 0.0;        ///< of the slave, true
    double displayed_force_N = 0.0;     ///< positive when it pushes the hand back
    double contact_force_N = 0.0;       ///< true, mean until the next tick
    double peak_contact_force_N = 0.0;  ///< true, largest substep until the next tick
    bool touched = false;               ///< the tip met the wall before the next tick
    double touched_at_s = 0.0;          ///< when, if so
  };

  /// At rest with both devices at `start_m` of the master; the slave at `start_m` times the position scale.
  static Result<Teleoperator> make(const Params& params, double start_m);

  /// Advances by one tick while the person intends to be at `path_m` now and at `path_at_next_tick_m` then.
  Record step(double path_m, double path_at_next_tick_m) noexcept;

  [[nodiscard]] double tick_s() const noexcept { return clock_.tick_s; }
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept;

 private:
  /// A delay of one second at the fastest rate.
  static constexpr std::size_t longest_delay_ticks = 20000;
  template <class Message>
  using Delay = signal::DelayLine<Message, longest_delay_ticks>;

  /// What a run is made of, each already valid.
  struct Parts {
    mechanics::CableDrivenMaster master;
    mechanics::ElectricSlave slave;
    mechanics::Operator person;
    control::PositionForceMaster master_site;
    control::PositionForceSlave slave_site;
    Delay<control::MasterMessage> to_slave;
    Delay<control::SlaveMessage> to_master;
  };

  Teleoperator(const Parts& parts, const Clock& clock) : parts_(parts), clock_(clock) {}

  Parts parts_;
  Clock clock_;
  std::int64_t ticks_ = 0;
  double master_command_N_ = 0.0;
  double slave_command_N_ = 0.0;
  control::SlaveMessage arrived_;  ///< at the master, for its next tick
};

}  // namespace tactus::simulation
