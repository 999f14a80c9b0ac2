// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/inverse3/inverse3_service.hpp>

#include <algorithm>

#include <nlohmann/json.hpp>

namespace tactus::emulation::inverse3 {

namespace {

using nlohmann::json;

/// No page states the peak force; more than this is cut to it, so that every state is a number.
constexpr double mass_kg = 0.25, drag_N_s_per_m = 1.0, most_N = 10.0;
constexpr std::int64_t step_ns = 100'000, longest_ns = 1'000'000'000;
constexpr double step_s = 1e-4;
constexpr std::array<const char*, 4> ids{"049D", "04A2", "0511", "0C3E"};
constexpr std::array<const char*, 3> axes{"x", "y", "z"};

json of_axes(const Inverse3Service::Vector& vector) { return {{"x", vector[0]}, {"y", vector[1]}, {"z", vector[2]}}; }

/// The vector under one of these keys, where it is whole; else nothing happened.
bool read_vector(const json& command, const std::vector<const char*>& keys, Inverse3Service::Vector& vector) {
  for (const char* key : keys) {
    const auto found = command.find(key);
    if (found == command.end() || !found->is_object()) continue;
    Inverse3Service::Vector read{};
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const auto number = found->find(axes[i]);
      if (number == found->end() || !number->is_number()) return false;
      read[i] = std::clamp(number->get<double>(), -most_N, most_N);
    }
    vector = read;
    return true;
  }
  return false;
}

}  // namespace

Result<Inverse3Service> Inverse3Service::make(const Params& params) {
  if (params.devices < 1 || params.devices > static_cast<std::int64_t>(ids.size())) {
    return Error{ErrorCode::out_of_bounds, "devices", "1 to 4 devices can be there", {}};
  }
  return Inverse3Service(params);
}

Inverse3Service::Inverse3Service(const Params& params)
    : params_(params), random_(static_cast<std::uint64_t>(params.seed)) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(params.devices); ++i) {
    Device device;
    device.id = ids[i];
    devices_.push_back(device);
  }
}

void Inverse3Service::advance(std::int64_t now_ns) {
  now_ns_ = std::max(now_ns_, now_ns - longest_ns);  // what was before has come to rest
  for (; now_ns_ + step_ns <= now_ns; now_ns_ += step_ns) {
    const bool silent = now_ns_ - message_ns_ >= params_.silence_ns;
    for (Device& device : devices_) {
      if (silent) {
        device.force_N = {};
        device.driven = false;
      }
      for (std::size_t i = 0; i < axes.size(); ++i) {
        double& velocity = device.velocity_m_per_s[i];
        velocity += (device.force_N[i] - drag_N_s_per_m * velocity) / mass_kg * step_s;
        device.position_m[i] += velocity * step_s;
      }
    }
  }
}

void Inverse3Service::inject(Fault fault, std::int64_t now_ns) {
  fault.from_ns += now_ns;
  faults_.push_back(std::move(fault));
  begin_faults(now_ns);
}

void Inverse3Service::begin_faults(std::int64_t now_ns) {
  std::erase_if(faults_, [this, now_ns](const Fault& fault) {
    if (fault.from_ns > now_ns) return false;
    switch (fault.kind) {
      case FaultKind::mode:
        params_.mode = fault.mode;
        break;
      case FaultKind::calibrated:
        calibrated_ = fault.flag;
        break;
      case FaultKind::power_supply:
        power_supply_ = fault.flag;
        break;
      case FaultKind::ready:
        ready_ = fault.flag;
        break;
      case FaultKind::keeps_force:
        params_.keeps_force = true;
        break;
    }
    return true;
  });
}

bool Inverse3Service::gives_force(std::size_t device, std::int64_t now_ns) {
  advance(now_ns);
  return devices_[device].force_N != Vector{};
}

void Inverse3Service::obey(std::string_view message, std::int64_t now_ns) {
  message_ns_ = now_ns;
  for (Device& device : devices_) {
    if (params_.keeps_force) continue;
    device.force_N = {};  // a command is for its tick
    device.driven = false;
  }
  const json said = json::parse(message, nullptr, false);
  const auto all = said.is_object() ? said.find("inverse3") : said.end();
  if (!said.is_object() || all == said.end() || !all->is_array()) return;
  for (const json& one : *all) {
    const auto id = one.is_object() ? one.find("device_id") : one.end();
    if (!one.is_object() || id == one.end() || !id->is_string()) continue;
    const auto device = std::ranges::find(devices_, id->get<std::string>(), &Device::id);
    const auto commands = one.find("commands");
    if (device == devices_.end() || commands == one.end() || !commands->is_object() || commands->empty()) continue;
    const auto force = commands->find("set_cursor_force");
    if (force != commands->end() && force->is_object() && params_.calibrated) {
      std::vector<const char*> keys{"values"};
      if (params_.dialect == Dialect::v3_5) keys.insert(keys.begin(), "vector");
      device->driven = read_vector(*force, keys, device->force_N);
    }
    device->told_position_m = device->position_m;
    device->told_velocity_m_per_s = device->velocity_m_per_s;
    device->told_force_N = device->force_N;
  }
}

std::string Inverse3Service::told(bool with_config) const {
  const bool new_keys = params_.dialect == Dialect::v3_5;
  json all = json::array();
  for (const Device& device : devices_) {
    json state{{"cursor_position", of_axes(device.told_position_m)},
               {"cursor_velocity", of_axes(device.told_velocity_m_per_s)},
               {"angular_position", {{"a0", 0.0}, {"a1", 0.0}, {"a2", 0.0}}},
               {"angular_velocity", {{"a0", 0.0}, {"a1", 0.0}, {"a2", 0.0}}},
               {"current_cursor_force", of_axes(device.told_force_N)}};
    if (!params_.partial) state["body_orientation"] = {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}};
    const std::string mode = params_.mode.value_or(device.driven ? "force" : "idle");
    if (new_keys) state["control_domain"] = device.driven ? "cartesian" : "idle";
    if (!mode.empty()) state[new_keys ? "control_mode" : "mode"] = mode;
    json one{{"device_id", device.id},
             {"state", std::move(state)},
             {"status",
              {{"calibrated", calibrated_.value_or(params_.calibrated)},
               {"in_use", true},
               {"power_supply", power_supply_.value_or(true)},
               {"ready", ready_.value_or(params_.calibrated)},
               {"started", true}}}};
    if (with_config) {
      one["config"] = {{"device_info",
                        {{"major_version", 3},
                         {"minor_version", new_keys ? 5 : 1},
                         {"id", device.id},
                         {new_keys ? "device_type" : "model", "inverse3"},
                         {"uuid", "00000000-0000-0000-0000-00000000" + device.id}}},
                       {"handedness", "right"},
                       {"gravity_compensation", {{"enabled", device.gravity_compensation}, {"scaling_factor", 1.0}}},
                       {"torque_scaling", {{"enabled", false}}},
                       {"home_return", {{"enabled", false}}},
                       {"filters", {{"force_gate", {{"gain", 0.3}}}, {"damping", {{"scalar", 0.0}}}}}};
    }
    all.push_back(std::move(one));
  }
  return json{{"session_id", 1}, {"inverse3", std::move(all)}}.dump();
}

std::string Inverse3Service::snapshot(std::int64_t now_ns) {
  advance(now_ns);
  for (Device& device : devices_) {
    device.told_position_m = device.position_m;
    device.told_velocity_m_per_s = device.velocity_m_per_s;
    device.told_force_N = device.force_N;
  }
  return told(true);
}

Inverse3Service::Answer Inverse3Service::answer(std::string_view message, std::int64_t now_ns) {
  advance(now_ns);
  begin_faults(now_ns);
  obey(message, now_ns);
  ++messages_;
  Answer answer{.text = told(false), .after_ns = params_.late_ns, .closes = messages_ == params_.closes_after};
  if (random_.uniform() < params_.garbage) answer.text.resize(random_.bits() % answer.text.size());
  return answer;
}

Inverse3Service::HttpAnswer Inverse3Service::http(std::string_view method, std::string_view target,
                                                  std::string_view body) {
  const auto good = [](const json& data) { return HttpAnswer{true, json{{"ok", true}, {"data", data}}.dump()}; };
  const auto bad = [](const char* why) { return HttpAnswer{false, json{{"ok", false}, {"error", why}}.dump()}; };
  target = target.substr(0, target.find('?'));
  if (method == "GET" && target == "/version") {
    return good({{"version", params_.dialect == Dialect::v3_5 ? "3.5.0" : "3.1.0"}});
  }
  if (method == "GET" && target == "/devices") {
    json all = json::array();
    for (const Device& device : devices_) all.push_back({{"device_id", device.id}});
    return good({{"inverse3", std::move(all)}});
  }
  for (std::size_t i = 0; method == "POST" && i < devices_.size(); ++i) {
    for (const std::string& name : {devices_[i].id, std::to_string(i)}) {
      if (target != "/inverse3/" + name + "/config/gravity_compensation") continue;
      const json said = json::parse(body, nullptr, false);
      if (!said.is_object() || !said.contains("enabled") || !said["enabled"].is_boolean()) return bad("no 'enabled'");
      devices_[i].gravity_compensation = said["enabled"].get<bool>();
      return good({{"enabled", devices_[i].gravity_compensation}});
    }
  }
  return bad("there is no such path");
}

}  // namespace tactus::emulation::inverse3
