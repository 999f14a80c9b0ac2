// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/protective_limits.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace tactus::control {

namespace {

struct Unchosen {
  std::string key;
  std::string value;
};

/// Adds the numbers of `params` that are no times and equal their defaults, those of nested groups included.
template <Described T>
void add_unchosen(const T& params, const T& defaults, const std::string& group, std::vector<Unchosen>& found) {
  for_each_field<T>([&](const auto& f) {
    const auto& value = params.*f.member;
    using Value = std::remove_cvref_t<decltype(value)>;
    const std::string key = group + "." + f.name;
    if constexpr (Described<Value>) {
      add_unchosen(value, defaults.*f.member, key, found);
    } else if constexpr (std::is_same_v<Value, double>) {
      const bool time = std::string_view(f.unit.suffix) == units::second.suffix;
      if (!time && value == defaults.*f.member) found.push_back({key, rounded_number(value) + " " + f.unit.symbol});
    }
  });
}

/// What protects any joint as it is: the motion check judges a drive's own report.
void forgive_motion(std::vector<Unchosen>& found) {
  std::erase_if(found, [](const Unchosen& one) { return one.key.find(".motion.") != std::string::npos; });
}

/// What only a force sensor gives a meaning.
void forgive_sensors(std::vector<Unchosen>& found) {
  std::erase_if(found, [](const Unchosen& one) {
    return one.key.ends_with(".unbalanced_force_N") || one.key.find(".reversal.") != std::string::npos;
  });
}

Check refuse(std::vector<Unchosen> found) {
  forgive_motion(found);
  if (found.empty()) return {};
  std::string message = found.front().value + " is the default, which protects no real device";
  if (found.size() > 1) message += "; so are ";
  for (std::size_t i = 1; i < found.size(); ++i) {
    message += (i == 1 ? "" : i + 1 < found.size() ? ", " : " and ") + found[i].key + " = " + found[i].value;
  }
  message += ": set each to what the device, and whoever touches it, can bear";
  return Error{.code = ErrorCode::inconsistent, .parameter = found.front().key, .message = message, .place = {}};
}

/// A motor that gives less gives none.
constexpr double gives_none_N = 1e-6;

/// The error of a `value` of `key` above the `most` that `reach` allows. The value that it recommends is rounded down.
Error unreachable(const std::string& key, double value, const char* unit, double most, const std::string& reach) {
  most = 1e-6 * std::floor(1e6 * most * (1.0 + 1e-12));
  return {.code = ErrorCode::inconsistent,
          .parameter = key,
          .message = rounded_number(value) + " " + unit + " can never be reached: " + reach + "; write at most " +
                     rounded_number(most) + " " + unit,
          .place = {}};
}

/// The force limit of a gate, in words, and which part of it is a good threshold.
std::string force_reach(const SafetyGate::Params& gate, const std::string& name) {
  return "the motor gives at most " + rounded_number(gate.force_limit_N) + " N by " + name +
         ".force_limit_N or the limit of its device, whichever is lower";
}

Check refuse_unreachable(const SafetyGate::Params& gate, const std::string& name, bool sensed) {
  const double most_N = gate.force_limit_N;
  if (most_N < gives_none_N) return {};
  const SafetyGate::Params defaults;
  // It is a change of the force, which may go from one end to the other.
  if (gate.encoder.frozen_force_N > 2.0 * most_N) {
    return unreachable(name + ".encoder.frozen_force_N", gate.encoder.frozen_force_N, "N", 2.0 * most_N,
                       force_reach(gate, name));
  }
  if (sensed && gate.encoder.unbalanced_force_N > most_N) {
    return unreachable(name + ".encoder.unbalanced_force_N", gate.encoder.unbalanced_force_N, "N", most_N,
                       force_reach(gate, name));
  }
  if (gate.reversal.force_N != defaults.reversal.force_N) {
    if (gate.reversal.force_N > most_N) {
      return unreachable(name + ".reversal.force_N", gate.reversal.force_N, "N", most_N, force_reach(gate, name));
    }
    const double latched_m_per_s = SafetyGate::fault_factor * gate.velocity_limit_m_per_s;
    if (gate.reversal.gained_m_per_s >= latched_m_per_s) {
      return unreachable(name + ".reversal.gained_m_per_s", gate.reversal.gained_m_per_s, "m/s",
                         gate.velocity_limit_m_per_s,
                         "the gate latches a velocity of " + rounded_number(latched_m_per_s) + " m/s, 1.25 times " +
                             name + ".velocity_limit_m_per_s or the limit of its device, before");
    }
  }
  const double most_W = most_N * SafetyGate::fault_factor * gate.velocity_limit_m_per_s;
  if (gate.energy.drain_W >= most_W) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = name + ".energy.hold_above_J",
                 .message = rounded_number(gate.energy.hold_above_J) +
                            " J can never be reached: the motor gives at most " + rounded_number(most_W) +
                            " W, its force limit at 1.25 times its velocity limit, and " + name +
                            ".energy.drain_W forgives " + rounded_number(gate.energy.drain_W) +
                            " W; write a drain_W of at most " + rounded_number(0.5 * most_W) + " W",
                 .place = {}};
  }
  return {};
}

}  // namespace

Check refuse_unreachable(const SafetyGate::Params& gate, const std::string& name) {
  return refuse_unreachable(gate, name, false);
}

Check refuse_unreachable(const ControlParams& params, SiteRole role, bool senses_force) {
  const bool master = role == SiteRole::master;
  const bool sensed = senses_force && !master && params.slave_force.source == SlaveForceSource::sensor;
  const SafetyGate::Params& gate = master ? params.gate : params.slave_gate;
  const std::string name = master ? "gate" : "slave_gate";
  if (auto error = refuse_unreachable(gate, name, sensed)) return error;
  if (gate.force_limit_N < gives_none_N) return {};
  const auto& supervision = params.supervision;
  if (sensed && supervision.force_sensor.residual_limit_N > gate.force_limit_N) {
    return unreachable("supervision.force_sensor.residual_limit_N", supervision.force_sensor.residual_limit_N, "N",
                       gate.force_limit_N, force_reach(gate, name));
  }
  if (supervision.probe.force_N > gate.force_limit_N) {
    return unreachable("supervision.probe.force_N", supervision.probe.force_N, "N", gate.force_limit_N,
                       force_reach(gate, name));
  }
  return {};
}

Check refuse_default_limits(const SafetyGate::Params& gate, const std::string& name) {
  std::vector<Unchosen> found;
  add_unchosen(gate, SafetyGate::Params{}, name, found);
  forgive_sensors(found);
  return refuse(found);
}

Check refuse_default_limits(const ControlParams& params, SiteRole role, bool senses_force) {
  const ControlParams defaults;
  const bool master = role == SiteRole::master;
  const bool sensed = senses_force && !master && params.slave_force.source == SlaveForceSource::sensor;
  std::vector<Unchosen> found;
  if (master) {
    add_unchosen(params.gate, defaults.gate, "gate", found);
    if (params.crossover.frequency_Hz > 0.0) {
      add_unchosen(params.handle_gate, defaults.handle_gate, "handle_gate", found);
    }
  } else {
    add_unchosen(params.slave_gate, defaults.slave_gate, "slave_gate", found);
  }
  if (!sensed) forgive_sensors(found);
  const auto& supervision = params.supervision;
  if (sensed && supervision.force_sensor.residual_limit_N == defaults.supervision.force_sensor.residual_limit_N) {
    found.push_back({"supervision.force_sensor.residual_limit_N",
                     rounded_number(supervision.force_sensor.residual_limit_N) + " N"});
  }
  if (supervision.probe.force_N == 0.0) found.push_back({"supervision.probe.force_N", "0 N"});
  return refuse(found);
}

}  // namespace tactus::control
