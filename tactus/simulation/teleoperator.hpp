#pragma once

#include <tactus/core/parameters.hpp>
#include <tactus/core/signals.hpp>
#include <tactus/simulation/clock.hpp>
#include <tactus/simulation/site_plants.hpp>
#include <tactus/station/site_pair.hpp>

#include <cstdint>
#include <utility>

namespace tactus::simulation {

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
    station::LinkParams channel;
    ServoParams servo;
    PlantClockParams plant;
    control::ControlParams control;
    static constexpr auto fields() {
      return List{field("master", &Params::master, "The master device."),
                  field("slave", &Params::slave, "The slave device."),
                  field("environment", &Params::environment, "The wall before the slave."),
                  field("operator", &Params::person, "The person at the master."),
                  field("channel", &Params::channel, "The link between the sites."),
                  field("servo", &Params::servo, "The servo clock."),
                  field("plant", &Params::plant, "The clock of the simulated plants."),
                  field("control", &Params::control, "The controllers of both sites.")};
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
    double displayed_force_N = 0.0;     ///< at the motor, positive when it pushes the hand back
    double handle_force_N = 0.0;        ///< to the handle's actuator, positive toward the environment
    double hand_force_N = 0.0;          ///< measured, positive when the hand pushes toward the environment
    double told_force_N = 0.0;          ///< tip force that the slave sent, positive when the slave is pushed back
    double contact_force_N = 0.0;       ///< true, mean until the next tick
    double peak_contact_force_N = 0.0;  ///< true, largest substep until the next tick
    bool touched = false;               ///< the tip met the wall before the next tick
    double touched_at_s = 0.0;          ///< when, if so
    /// For logs and exports. All is translated to the operator's hand.
    static constexpr auto signals() {
      constexpr const char* onward = "toward the environment";
      constexpr const char* back = "pushes the hand back";
      return List{
          observed("time_s", &Record::time_s, units::second, "", "", "", "Virtual time of the tick."),
          observed("master_position_m", &Record::master_position_m, units::metre, "master", "hand", onward,
                   "Measured, at the motor."),
          observed("induced_position_m", &Record::induced_position_m, units::metre, "master", "hand", onward,
                   "The model's estimate of what the displayed force did to the master's position."),
          observed("command_m", &Record::command_m, units::metre, "master", "slave", onward,
                   "Position command that left the master."),
          observed("slave_position_m", &Record::slave_position_m, units::metre, "slave", "slave", onward,
                   "Measured, at the motor."),
          observed("tip_position_m", &Record::tip_position_m, units::metre, "slave", "slave", onward,
                   "Of the slave's tip, true."),
          observed("displayed_force_N", &Record::displayed_force_N, units::newton, "master", "hand", back,
                   "Force that the gate let through to the master's motor."),
          observed("handle_force_N", &Record::handle_force_N, units::newton, "master", "hand", onward,
                   "Force of the actuator on the handle."),
          observed("hand_force_N", &Record::hand_force_N, units::newton, "master", "hand", onward,
                   "Measured force of the hand on the handle."),
          observed("told_force_N", &Record::told_force_N, units::newton, "slave", "slave", "the slave is pushed back",
                   "Tip force that the slave sent to the master, measured or estimated."),
          observed("contact_force_N", &Record::contact_force_N, units::newton, "environment", "slave",
                   "the wall is pressed", "True, mean until the next tick."),
          observed("peak_contact_force_N", &Record::peak_contact_force_N, units::newton, "environment", "slave",
                   "the wall is pressed", "True, largest substep until the next tick."),
          observed("touched", &Record::touched, units::none, "environment", "", "",
                   "The tip met the wall before the next tick."),
          observed("touched_at_s", &Record::touched_at_s, units::second, "environment", "", "",
                   "When the tip met the wall, where it did; else 0.")};
    }
  };

  /// At rest with both devices at `start_m` of the master; the slave at `start_m` times the position scale.
  static Result<Teleoperator> make(const Params& params, double start_m);

  /// Advances by one tick while the person intends to be at `path_m` now and at `path_at_next_tick_m` then. `share` as
  /// in `BarePair::step`: 0 lets go.
  Record step(double path_m, double path_at_next_tick_m, double share = 1.0) noexcept;

  /// What `exchange` takes over.
  struct Parts {
    bool grip = false;         ///< how the person holds the handle
    bool environment = false;  ///< the wall
    bool channel = false;      ///< both ways; what was on its way is lost
    bool controllers = false;  ///< of both sites; the gates stay
    bool operator==(const Parts&) const = default;
  };
  /// Goes on with these parts of `made`, a teleoperator of the same clock and devices that has not been stepped; `made`
  /// keeps what was in their place. Devices and person stay where they are. Controllers are first brought to rest at
  /// this very instant (`Site::exchange_controller`), those of another architecture cannot be: what is in the channel
  /// means nothing to them. Between ticks; does not allocate, but takes about as long as 1000 ticks of the sites.
  void exchange(Teleoperator& made, const Parts& parts) noexcept;

  /// The record of a tick as far as it is known before the plants go on; `add_contact` adds what they do,
  /// `tip_position_m` is the caller's to fill in.
  static Record recorded(double time_s, const station::BarePair::Output& output) noexcept;
  static void add_contact(Record& record, const SlavePlant::Contact& contact, const Clock& clock) noexcept;

  [[nodiscard]] double tick_s() const noexcept { return clock_.tick_s; }
  /// Neither site commanded a force at the latest tick.
  [[nodiscard]] bool at_rest() const noexcept { return sites_.at_rest(); }
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept { return sites_.healthy(); }

 private:
  Teleoperator(const MasterPlant& master, const SlavePlant& slave, station::BarePair sites, const Clock& clock)
      : master_(master), slave_(slave), sites_(std::move(sites)), clock_(clock) {}

  MasterPlant master_;
  SlavePlant slave_;
  station::BarePair sites_;
  Clock clock_;
  std::int64_t ticks_ = 0;
};

}  // namespace tactus::simulation
