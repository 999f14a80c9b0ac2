// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstdint>
#include <string>

/// A description with every kind of parameter, nested two levels deep, for the tests of this module.
namespace tactus::configuration::testing {

enum class Cancellation { off, model, adaptive };
constexpr std::array<Enumerator<Cancellation>, 3> enumerators(Cancellation) {
  return {{{Cancellation::off, "off"}, {Cancellation::model, "model"}, {Cancellation::adaptive, "adaptive"}}};
}

struct Filter {
  double cutoff_Hz = 80.0;
  bool enabled = true;
  bool operator==(const Filter&) const = default;
  static constexpr auto fields() {
    return List{field("cutoff_Hz", &Filter::cutoff_Hz, units::hertz, positive_up_to(20000), "The -3 dB point."),
                field("enabled", &Filter::enabled, "Whether it filters at all.")};
  }
};

struct Slave {
  Filter velocity_filter;
  double mass_kg = 0.5;
  double offset_m = 0.0;
  double stiffness_N_per_m = 3950.0;
  bool operator==(const Slave&) const = default;
  static constexpr auto fields() {
    return List{
        field("velocity_filter", &Slave::velocity_filter, "Filters the measured velocity."),
        field("mass_kg", &Slave::mass_kg, units::kilogram, positive, "Moving mass."),
        field("offset_m", &Slave::offset_m, units::metre, any_finite, "Where it rests | at the start."),
        field("stiffness_N_per_m", &Slave::stiffness_N_per_m, units::newton_per_metre, non_negative, "Stiffness.")};
  }
};

struct Control {
  double force_gain = 1.0;
  Cancellation cancellation = Cancellation::model;
  std::int64_t taps = 32;
  std::int64_t seed = 1;
  bool operator==(const Control&) const = default;
  static constexpr auto fields() {
    return List{field("force_gain", &Control::force_gain, units::none, between(0, 10), "Force scale."),
                field("cancellation", &Control::cancellation, "How the induced motion is cancelled."),
                field("taps", &Control::taps, between(1, 4096), "Number of taps."),
                field("seed", &Control::seed, any_finite, "Seed of the noise.")};
  }
};

struct Task {
  std::string kind = "tapping";
  std::string recording;
  bool operator==(const Task&) const = default;
  static constexpr auto fields() {
    return List{field("kind", &Task::kind, "What is done."),
                field("recording", &Task::recording, "File of a recording.")};
  }
};

struct Experiment {
  Slave slave;
  Control control;
  Task task;
  double duration_s = 2.0;
  bool operator==(const Experiment&) const = default;
  static constexpr auto fields() {
    return List{field("slave", &Experiment::slave, "The slave."),
                field("control", &Experiment::control, "The controller."),
                field("task", &Experiment::task, "The task."),
                field("duration_s", &Experiment::duration_s, units::second, positive_up_to(3600), "How long it runs.")};
  }
};

}  // namespace tactus::configuration::testing
