#include <tactus/control/protective_limits.hpp>

#include <algorithm>
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
      if (!time && value == defaults.*f.member) found.push_back({key, format_number(value) + " " + f.unit.symbol});
    }
  });
}

/// What only a force sensor gives a meaning.
void forgive_sensors(std::vector<Unchosen>& found) {
  std::erase_if(found, [](const Unchosen& one) {
    return one.key.ends_with(".unbalanced_force_N") || one.key.find(".reversal.") != std::string::npos;
  });
}

Check refuse(const std::vector<Unchosen>& found) {
  if (found.empty()) return {};
  std::string message = found.front().value + " is the default, which protects no real device";
  if (found.size() > 1) message += "; so are ";
  for (std::size_t i = 1; i < found.size(); ++i) {
    message += (i == 1 ? "" : i + 1 < found.size() ? ", " : " and ") + found[i].key + " = " + found[i].value;
  }
  message += ": set each to what the device, and whoever touches it, can stand";
  return Error{.code = ErrorCode::inconsistent, .parameter = found.front().key, .message = message, .place = {}};
}

}  // namespace

Check refuse_default_limits(const SafetyGate::Params& gate, const std::string& name) {
  std::vector<Unchosen> found;
  add_unchosen(gate, SafetyGate::Params{}, name, found);
  forgive_sensors(found);
  return refuse(found);
}

Check refuse_default_limits(const ControlParams& params, SiteRole role) {
  const ControlParams defaults;
  const bool master = role == SiteRole::master;
  const bool sensed = !master && params.slave_force.source == SlaveForceSource::sensor;
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
    found.push_back(
        {"supervision.force_sensor.residual_limit_N", format_number(supervision.force_sensor.residual_limit_N) + " N"});
  }
  if (supervision.probe.force_N == 0.0) found.push_back({"supervision.probe.force_N", "0 N"});
  return refuse(found);
}

}  // namespace tactus::control
