#pragma once

#include <tactus/control/site.hpp>
#include <tactus/mechanics/cable_driven_master.hpp>
#include <tactus/mechanics/electric_slave.hpp>
#include <tactus/mechanics/operator.hpp>
#include <tactus/simulation/clock.hpp>

#include <cstdint>
#include <utility>

/// The two sides of a teleoperator, each a site with what it controls. `Teleoperator` steps both in virtual time; two
/// programs can step one each.
namespace tactus::simulation {

/// Person, master and master site. A value: a copy is a fork of the run.
class MasterSide {
 public:
  struct Controlled {
    mechanics::CableDrivenMaster::Reading reading;
    control::MasterOutput output;
  };

  /// At rest with the master at `start_m`. Errors name parameters under `master` and `operator`.
  static Result<MasterSide> make(const mechanics::CableDrivenMaster::Params& master,
                                 const mechanics::Operator::Params& person, const Clock& clock,
                                 control::MasterSite site, double start_m);

  /// The first half of a tick: sensors and site. Real-time safe.
  Controlled control(const control::Arrival& arrival) noexcept;
  /// The second half: person and plant move on to the next tick, on the previous command until the computation delay
  /// has passed. The person intends to be at `path_m` now and at `path_at_next_tick_m` then. Real-time safe.
  void move(double path_m, double path_at_next_tick_m) noexcept;

  [[nodiscard]] control::GateFault fault() const noexcept { return site_.fault(); }

 private:
  MasterSide(const mechanics::CableDrivenMaster& master, const mechanics::Operator& person, control::MasterSite site,
             const Clock& clock, const mechanics::Operator::Params& params)
      : master_(master),
        person_(person),
        site_(std::move(site)),
        clock_(clock),
        grip_(params.grip),
        grip_change_(params.grip_change) {}

  void change_grip() noexcept;

  mechanics::CableDrivenMaster master_;
  mechanics::Operator person_;
  control::MasterSite site_;
  Clock clock_;
  mechanics::LinearSpring::Params grip_;  ///< before any change
  mechanics::Operator::GripChange grip_change_;
  double grip_factor_ = 1.0;
  std::int64_t ticks_ = 0;
  double motor_command_N_ = 0.0;  ///< of the tick before
  double handle_command_N_ = 0.0;
  control::MasterOutput output_;
};

/// Slave site, slave and wall. A value: a copy is a fork of the run.
class SlaveSide {
 public:
  struct Controlled {
    mechanics::ElectricSlave::Reading reading;
    control::SlaveOutput output;
  };
  /// The wall until the next tick.
  struct Contact {
    double force_N = 0.0;       ///< mean, positive when the wall pushes the tip back
    double peak_force_N = 0.0;  ///< largest substep
    bool touched = false;       ///< the tip met the wall
    double touched_at_s = 0.0;  ///< when, if so
  };

  /// At rest with the slave at `start_m`. Errors name parameters under `slave` and `environment`.
  static Result<SlaveSide> make(const mechanics::ElectricSlave::Params& slave,
                                const mechanics::Environment::Params& environment, const Clock& clock,
                                control::SlaveSite site, double start_m);

  /// The first half of a tick: sensors and site. Real-time safe.
  Controlled control(const control::Arrival& arrival) noexcept;
  /// The second half: the plant moves on from `time_s` to the next tick. Real-time safe.
  Contact move(double time_s) noexcept;

  /// Of the tip, true.
  [[nodiscard]] double tip_position_m() const noexcept { return slave_.mechanism().tip_position_m(); }
  [[nodiscard]] control::GateFault fault() const noexcept { return site_.fault(); }

 private:
  SlaveSide(const mechanics::ElectricSlave& slave, control::SlaveSite site, const Clock& clock)
      : slave_(slave), site_(std::move(site)), clock_(clock) {}

  mechanics::ElectricSlave slave_;
  control::SlaveSite site_;
  Clock clock_;
  double motor_command_N_ = 0.0;  ///< of the tick before
  double next_motor_command_N_ = 0.0;
};

}  // namespace tactus::simulation
