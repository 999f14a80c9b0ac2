#pragma once

#include <tactus/core/parameters.hpp>
#include <tactus/core/signals.hpp>
#include <tactus/simulation/clock.hpp>
#include <tactus/simulation/site_plants.hpp>
#include <tactus/station/site_pair.hpp>

#include <concepts>
#include <cstdint>
#include <optional>
#include <utility>

namespace tactus::simulation {

/// What a one-axis teleoperator is made of.
struct TeleoperatorParams {
  mechanics::CableDrivenMaster::Params master;
  mechanics::ElectricSlave::Params slave;
  mechanics::Environment::Params environment;
  mechanics::Operator::Params person;
  station::LinkParams channel;
  ServoParams servo;
  PlantClockParams plant;
  control::ControlParams control;
  static constexpr auto fields() {
    return List{field("master", &TeleoperatorParams::master, "The master device."),
                field("slave", &TeleoperatorParams::slave, "The slave device."),
                field("environment", &TeleoperatorParams::environment, "The wall in front of the slave."),
                field("operator", &TeleoperatorParams::person, "The operator at the master."),
                field("channel", &TeleoperatorParams::channel, "The link between the sites."),
                field("servo", &TeleoperatorParams::servo, "The servo clock."),
                field("plant", &TeleoperatorParams::plant, "The clock of the simulated plants."),
                field("control", &TeleoperatorParams::control, "The controllers of both sites.")};
  }
};

/// What one tick showed. Positions and forces as at the tick; contact over the tick that follows.
struct TeleoperatorRecord {
  double time_s = 0.0;
  double master_position_m = 0.0;         ///< measured, at the motor
  double induced_position_m = 0.0;        ///< the model's estimate of what the force did to it
  double command_m = 0.0;                 ///< position command that left the master
  double slave_position_m = 0.0;          ///< measured, at the motor
  double tip_position_m = 0.0;            ///< of the slave, true
  double displayed_force_N = 0.0;         ///< at the motor, positive when it pushes the hand back
  double handle_force_N = 0.0;            ///< to the handle's actuator, positive toward the environment
  double hand_force_N = 0.0;              ///< measured, positive when the hand pushes toward the environment
  double sent_force_N = 0.0;              ///< tip force that the slave sent, positive when the slave is pushed back
  double contact_force_N = 0.0;           ///< true, mean until the next tick
  double peak_contact_force_N = 0.0;      ///< true, largest substep until the next tick
  bool touched = false;                   ///< the tip met the wall by the next tick
  double touched_at_s = 0.0;              ///< when, if so
  double estimated_grip = 1.0;            ///< of the hand, over identified, as the master's controller assumes
  double estimated_grip_deviation = 0.0;  ///< standard deviation of that; 0 where nothing is estimated
  /// For logs and exports. All is translated to the operator's hand.
  static constexpr auto signals() {
    constexpr const char* onward = "toward the environment";
    constexpr const char* back = "pushes the hand back";
    return List{
        observed("time_s", &TeleoperatorRecord::time_s, units::second, "", "", "",
                 "Virtual time of the control cycle."),
        observed("master_position_m", &TeleoperatorRecord::master_position_m, units::metre, "master", "hand", onward,
                 "Measured, at the motor."),
        observed("induced_position_m", &TeleoperatorRecord::induced_position_m, units::metre, "master", "hand", onward,
                 "The model's estimate of what the displayed force did to the master's position."),
        observed("command_m", &TeleoperatorRecord::command_m, units::metre, "master", "slave", onward,
                 "Position command that left the master."),
        observed("slave_position_m", &TeleoperatorRecord::slave_position_m, units::metre, "slave", "slave", onward,
                 "Measured, at the motor."),
        observed("tip_position_m", &TeleoperatorRecord::tip_position_m, units::metre, "slave", "slave", onward,
                 "Of the slave's tip, true."),
        observed("displayed_force_N", &TeleoperatorRecord::displayed_force_N, units::newton, "master", "hand", back,
                 "Force that the gate let through to the master's motor."),
        observed("handle_force_N", &TeleoperatorRecord::handle_force_N, units::newton, "master", "hand", onward,
                 "Force of the actuator on the handle."),
        observed("hand_force_N", &TeleoperatorRecord::hand_force_N, units::newton, "master", "hand", onward,
                 "Measured force of the hand on the handle."),
        observed("sent_force_N", &TeleoperatorRecord::sent_force_N, units::newton, "slave", "slave",
                 "the slave is pushed back", "Tip force that the slave sent to the master, measured or estimated."),
        observed("contact_force_N", &TeleoperatorRecord::contact_force_N, units::newton, "environment", "slave",
                 "the wall is pressed", "True, mean until the next control cycle."),
        observed("peak_contact_force_N", &TeleoperatorRecord::peak_contact_force_N, units::newton, "environment",
                 "slave", "the wall is pressed", "True, largest substep until the next control cycle."),
        observed("touched", &TeleoperatorRecord::touched, units::none, "environment", "", "",
                 "The tip met the wall by the next control cycle."),
        observed("touched_at_s", &TeleoperatorRecord::touched_at_s, units::second, "environment", "", "",
                 "When the tip met the wall, where it did; else 0."),
        observed("estimated_grip", &TeleoperatorRecord::estimated_grip, units::none, "master", "hand", "",
                 "How firmly the operator holds, over identified, as the master's controller assumes."),
        observed("estimated_grip_deviation", &TeleoperatorRecord::estimated_grip_deviation, units::none, "master",
                 "hand", "", "Standard deviation of that; 0 where nothing is estimated.")};
  }
};

/// A site that does not follow any more, and why.
struct StoppedSite {
  control::SiteRole site;
  control::SiteCause cause;
  bool operator==(const StoppedSite&) const = default;
};

/// A one-axis teleoperator in virtual time: operator, master, two sites, channel, slave and wall.
///
/// The sites step once a tick, the plants in substeps between ticks. Within a tick everything is sampled first, then
/// the master steps, then the slave. A message to the slave with no channel delay arrives in the same tick, one to the
/// master at the next: on one computer the loop closes with one tick of delay plus the computation delay.
///
/// A value: a copy is a fork of the run. Runs are equal bit for bit for equal parameters and input.
template <class Pair>
class TeleoperatorOf {
 public:
  using Params = TeleoperatorParams;
  using Record = TeleoperatorRecord;

  /// At rest with both devices at `start_m` of the master; the slave at `start_m` times the position scale. One that is
  /// supervised has been armed by an operator who rests there: time 0 is when both sites follow with their whole force.
  /// Errors: those of its parts, and `inconsistent` where it could not be armed, which name site and cause.
  static Result<TeleoperatorOf> make(const Params& params, double start_m);

  /// Advances by one tick while the operator intends to be at `path_m` now and at `path_at_next_tick_m` then. `share`
  /// is that of the controllers' forces; 0 releases them, under supervision with the dead-man switch.
  Record step(double path_m, double path_at_next_tick_m, double share = 1.0) noexcept;

  /// What `exchange` takes over.
  struct Parts {
    bool grip = false;         ///< how the operator holds the handle
    bool environment = false;  ///< the wall
    bool channel = false;      ///< both ways; what was on its way is lost
    bool controllers = false;  ///< of both sites; the gates stay
    bool operator==(const Parts&) const = default;
  };
  /// Continues with these parts of `made`, a teleoperator of the same clock and devices that has not been stepped;
  /// `made` keeps what was in their place. Devices and operator stay where they are. Controllers are first brought to
  /// rest at this very instant (`Site::exchange_controller`), those of another architecture cannot be: what is in the
  /// channel means nothing to them. Between ticks; does not allocate, but takes about as long as 1000 ticks of the
  /// sites.
  void exchange(TeleoperatorOf& made, const Parts& parts) noexcept requires std::same_as<Pair, station::BarePair> {
    if (parts.grip) master_.exchange_grip(made.master_);
    if (parts.environment) slave_.exchange_wall(made.slave_);
    if (parts.channel) sites_.exchange_channels(made.sites_);
    if (parts.controllers) sites_.exchange_controllers(made.sites_);
  }

  /// The record of a tick as far as it is known before the plants continue; `add_contact` adds what they do,
  /// `tip_position_m` is the caller's to fill in.
  static Record recorded(double time_s, const typename Pair::Output& output) noexcept;
  static void add_contact(Record& record, const SlavePlant::Contact& contact, const Clock& clock) noexcept;

  [[nodiscard]] double tick_s() const noexcept { return clock_.tick_s; }
  /// Neither site commanded a force at the latest tick.
  [[nodiscard]] bool at_rest() const noexcept { return sites_.at_rest(); }
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept { return sites_.healthy(); }
  /// The site that supervision has stopped, the master where it was both; none as long as both follow, and of bare
  /// ones.
  [[nodiscard]] std::optional<StoppedSite> stopped() const noexcept;

 private:
  TeleoperatorOf(const MasterPlant& master, const SlavePlant& slave, Pair sites, const Clock& clock)
      : master_(master), slave_(slave), sites_(std::move(sites)), clock_(clock) {}
  Check arm(double start_m, double blend_s);
  Record advance(double path_m, double path_at_next_tick_m, const typename Pair::Request& request) noexcept;

  MasterPlant master_;
  SlavePlant slave_;
  Pair sites_;
  Clock clock_;
  std::int64_t ticks_ = 0;
};

/// As in the papers: at work from the first tick on.
using Teleoperator = TeleoperatorOf<station::BarePair>;
/// As on a machine.
using SupervisedTeleoperator = TeleoperatorOf<station::SupervisedPair>;

}  // namespace tactus::simulation
