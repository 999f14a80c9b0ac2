#pragma once

#include <tactus/control/packet.hpp>
#include <tactus/station/device.hpp>

#include <array>
#include <cstdint>
#include <limits>

namespace tactus::simulation {

/// One input, one value, one state of the site that reads it.
struct BadNumber {
  enum class Input { position, force, grip, told_position, told_velocity, told_force, told_wave, told_energy, age };
  static constexpr std::int64_t master_inputs = 9;
  static constexpr std::int64_t slave_inputs = 8;  ///< no grip
  static constexpr std::array values{std::numeric_limits<double>::quiet_NaN(),
                                     std::numeric_limits<double>::infinity(),
                                     -std::numeric_limits<double>::infinity(),
                                     1e300,
                                     -1e300,
                                     1e12};
  static constexpr std::array states{control::SiteState::configure, control::SiteState::align,
                                     control::SiteState::armed,     control::SiteState::active,
                                     control::SiteState::hold,      control::SiteState::fault};
  static constexpr std::int64_t choices =
      (master_inputs + slave_inputs) * static_cast<std::int64_t>(values.size() * states.size());

  bool at_master = true;
  Input input = Input::position;
  double value = 0.0;
  control::SiteState state = control::SiteState::active;

  /// Every combination comes once in `choices` consecutive numbers.
  static BadNumber of(std::int64_t choice) {
    BadNumber bad;
    const auto take = [&choice](std::int64_t count) {
      const std::int64_t digit = choice % count;
      choice /= count;
      return digit;
    };
    bad.state = states[static_cast<std::size_t>(take(static_cast<std::int64_t>(states.size())))];
    bad.value = values[static_cast<std::size_t>(take(static_cast<std::int64_t>(values.size())))];
    const std::int64_t input = take(master_inputs + slave_inputs);
    bad.at_master = input < master_inputs;
    const std::int64_t of_slave = input - master_inputs;
    const std::int64_t skipped = of_slave >= static_cast<std::int64_t>(Input::grip) ? 1 : 0;
    bad.input = static_cast<Input>(bad.at_master ? input : of_slave + skipped);
    return bad;
  }

  void spoil(station::DeviceReading& reading) const {
    if (input == Input::position) reading.position_m = value;
    if (input == Input::force) reading.force_N = value;
    if (input == Input::grip) reading.grip = value;
  }
  void spoil(control::Packet& packet) const {
    if (input == Input::told_position) packet.message.position_m = value;
    if (input == Input::told_velocity) packet.message.velocity_m_per_s = value;
    if (input == Input::told_force) packet.message.force_N = value;
    if (input == Input::told_wave) packet.message.wave = value;
    if (input == Input::told_energy) packet.message.energy_J = value;
    if (input == Input::age) packet.age_s = value;
  }
};

}  // namespace tactus::simulation
