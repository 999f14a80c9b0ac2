#pragma once

#include <tactus/core/signals.hpp>
#include <tactus/station/site_pair.hpp>

#include <cstdint>

namespace tactus::runtime {

/// All that the sites read and all that they gave in one step: with the configuration, enough to step them again.
struct SitesRecord {
  std::int64_t tap = 0;
  std::int64_t tick = 0;
  std::int64_t missed = 0;
  double master_position_m = 0.0;
  double hand_force_N = 0.0;
  double grip = 0.0;
  double slave_position_m = 0.0;
  double tip_force_N = 0.0;
  double master_force_N = 0.0;
  double handle_force_N = 0.0;
  double induced_position_m = 0.0;
  double intended_position_m = 0.0;
  double to_slave_position_m = 0.0;
  double to_slave_velocity_m_per_s = 0.0;
  double to_slave_force_N = 0.0;
  double to_slave_wave = 0.0;
  double to_slave_energy_J = 0.0;
  double slave_force_N = 0.0;
  double to_master_position_m = 0.0;
  double to_master_velocity_m_per_s = 0.0;
  double to_master_force_N = 0.0;
  double to_master_wave = 0.0;
  double to_master_energy_J = 0.0;
  static constexpr auto signals() {
    return std::tuple{
        observed("tap", &SitesRecord::tap, units::none, "", "", "", "Number of the tap, from 0."),
        observed("tick", &SitesRecord::tick, units::none, "", "", "",
                 "Number of the deadline in the tap, missed ones counted."),
        observed("missed", &SitesRecord::missed, units::none, "", "", "", "Deadlines missed right before this one."),
        observed("master_position_m", &SitesRecord::master_position_m, units::metre, "master", "hand",
                 "toward the environment", "Read at the motor."),
        observed("hand_force_N", &SitesRecord::hand_force_N, units::newton, "master", "hand", "toward the environment",
                 "Read on the handle."),
        observed("grip", &SitesRecord::grip, units::none, "master", "", "",
                 "Read: how firmly the person holds, over nominal."),
        observed("slave_position_m", &SitesRecord::slave_position_m, units::metre, "slave", "slave",
                 "toward the environment", "Read at the motor."),
        observed("tip_force_N", &SitesRecord::tip_force_N, units::newton, "slave", "slave", "the slave is pushed back",
                 "Read at the tip."),
        observed("master_force_N", &SitesRecord::master_force_N, units::newton, "master", "hand",
                 "toward the environment", "Commanded to the motor."),
        observed("handle_force_N", &SitesRecord::handle_force_N, units::newton, "master", "hand",
                 "toward the environment", "Commanded to the actuator on the handle."),
        observed("induced_position_m", &SitesRecord::induced_position_m, units::metre, "master", "hand",
                 "toward the environment", "Estimated effect of the displayed force."),
        observed("intended_position_m", &SitesRecord::intended_position_m, units::metre, "master", "hand",
                 "toward the environment", "Measured less induced."),
        observed("to_slave_position_m", &SitesRecord::to_slave_position_m, units::metre, "master", "slave", "",
                 "Told to the slave."),
        observed("to_slave_velocity_m_per_s", &SitesRecord::to_slave_velocity_m_per_s, units::metre_per_second,
                 "master", "slave", "", "Told to the slave."),
        observed("to_slave_force_N", &SitesRecord::to_slave_force_N, units::newton, "master", "slave", "",
                 "Told to the slave."),
        observed("to_slave_wave", &SitesRecord::to_slave_wave, units::none, "master", "slave", "",
                 "Told to the slave."),
        observed("to_slave_energy_J", &SitesRecord::to_slave_energy_J, units::joule, "master", "slave", "",
                 "Told to the slave."),
        observed("slave_force_N", &SitesRecord::slave_force_N, units::newton, "slave", "slave",
                 "toward the environment", "Commanded to the motor."),
        observed("to_master_position_m", &SitesRecord::to_master_position_m, units::metre, "slave", "slave", "",
                 "Told to the master."),
        observed("to_master_velocity_m_per_s", &SitesRecord::to_master_velocity_m_per_s, units::metre_per_second,
                 "slave", "slave", "", "Told to the master."),
        observed("to_master_force_N", &SitesRecord::to_master_force_N, units::newton, "slave", "slave", "",
                 "Told to the master."),
        observed("to_master_wave", &SitesRecord::to_master_wave, units::none, "slave", "slave", "",
                 "Told to the master."),
        observed("to_master_energy_J", &SitesRecord::to_master_energy_J, units::joule, "slave", "slave", "",
                 "Told to the master.")};
  }
};

/// The record of a step. Real-time safe.
SitesRecord recorded(std::int64_t tap, const station::Tick& tick, const station::BarePair::Output& step) noexcept;

}  // namespace tactus::runtime
