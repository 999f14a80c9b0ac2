// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/station/device.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tactus::simulation {

/// One input, one value, one state of the site that reads it.
struct BadNumber {
  /// What a device reads. After these the inputs are each number of a message, and last the age of its packet.
  static constexpr std::array read{&station::DeviceReading::position_m, &station::DeviceReading::force_N,
                                   &station::DeviceReading::grip};
  static constexpr std::int64_t grip = 2;  ///< which a slave has not
  static constexpr std::int64_t first_told = read.size();
  static constexpr std::int64_t age = first_told + decltype(control::Message::signals())::size();
  static constexpr std::int64_t master_inputs = age + 1;
  static constexpr std::int64_t slave_inputs = master_inputs - 1;
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
  std::int64_t input = 0;  ///< its number
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
    bad.input = bad.at_master ? input : of_slave + (of_slave >= grip ? 1 : 0);
    return bad;
  }

  void spoil(station::DeviceReading& reading) const {
    if (input < first_told) reading.*read[static_cast<std::size_t>(input)] = value;
  }
  void spoil(control::Packet& packet) const {
    if (input == age) packet.age_s = value;
    std::int64_t number = first_told;
    for_each_signal<control::Message>([&](const auto& each) {
      if (number++ == input) packet.message.*each.member = value;
    });
  }
};

}  // namespace tactus::simulation
