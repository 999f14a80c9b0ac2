// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/channel.hpp>

/// Parameters of a teleoperator of one axis, whether its sites drive motors or simulated plants: `[channel]`, `[servo]`
/// and `[control]` of an experiment's file.
namespace tactus::station {

/// The servo clock of the sites.
struct ServoParams {
  double rate_Hz = 5000.0;
  double computation_delay_s = 20e-6;
  static constexpr auto fields() {
    return List{
        field("rate_Hz", &ServoParams::rate_Hz, units::hertz, between(500.0, 20000.0), "Control cycles per second."),
        field("computation_delay_s", &ServoParams::computation_delay_s, units::second, between(0.0, 0.002),
              "Time from a sample to the change of the command that results from it, rounded to whole plant "
              "steps; less than a control cycle.")};
  }
};

/// What the two sites compute with. Kinds of experiments add plants, operator and task.
struct TeleoperatorParams {
  LinkParams channel;
  ServoParams servo;
  control::ControlParams control;
  static constexpr auto fields() {
    return List{field("channel", &TeleoperatorParams::channel, "The link between the sites."),
                field("servo", &TeleoperatorParams::servo, "The servo clock."),
                field("control", &TeleoperatorParams::control, "The controllers of both sites.")};
  }
};

}  // namespace tactus::station
