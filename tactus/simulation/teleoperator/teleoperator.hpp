// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/site_pair.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>
#include <tactus/kernel/station/teleoperator_record.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>
#include <tactus/simulation/teleoperator/site_plants.hpp>

#include <concepts>
#include <cstdint>
#include <optional>
#include <utility>

namespace tactus::simulation {

/// What a one-axis teleoperator is made of: its sites, and what is simulated around them.
struct TeleoperatorParams : station::TeleoperatorParams {
  mechanics::CableDrivenMaster::Params master;
  mechanics::ElectricSlave::Params slave;
  mechanics::Environment::Params environment;
  mechanics::Operator::Params person;
  PlantClockParams plant;
  static constexpr auto fields() {
    constexpr auto sites = station::TeleoperatorParams::fields();  // channel, servo, control
    return List{field("master", &TeleoperatorParams::master, "The master device."),
                field("slave", &TeleoperatorParams::slave, "The slave device."),
                field("environment", &TeleoperatorParams::environment, "The wall in front of the slave."),
                field("operator", &TeleoperatorParams::person, "The operator at the master."),
                at<0>(sites),
                at<1>(sites),
                field("plant", &TeleoperatorParams::plant, "The clock of the simulated plants."),
                at<2>(sites)};
  }
};

using station::TeleoperatorRecord;

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
