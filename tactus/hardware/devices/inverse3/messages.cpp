// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/inverse3/messages.hpp>
#include <tactus/hardware/devices/motor_bus.hpp>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::devices::inverse3 {

namespace {

using nlohmann::json;

constexpr std::array<const char*, 3> axes{"x", "y", "z"};

std::string message_of(std::string_view device_id, const char* command, json content) {
  const json message{{"inverse3", {{{"device_id", device_id}, {"commands", {{command, std::move(content)}}}}}}};
  // An id that is not text would throw.
  return message.dump(-1, ' ', false, json::error_handler_t::replace);
}

Error wrong(const std::string& what, const char* should) {
  return {ErrorCode::wrong_type, what, std::string("the service reports no ") + should, {}};
}

/// The member of that name, where there is one.
const json* member(const json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? &*found : nullptr;
}

Check read(const json& state, const char* name, Vector& vector) {
  const json* told = member(state, name);
  if (told == nullptr) return std::nullopt;
  Vector taken{};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const json* number = member(*told, axes[i]);
    if (number == nullptr || !number->is_number()) return wrong(std::string(name) + "." + axes[i], "number");
    taken[i] = number->get<double>();
  }
  vector = taken;
  return std::nullopt;
}

Check read(const json& status, const char* name, bool& flag) {
  const json* told = member(status, name);
  if (told == nullptr) return std::nullopt;
  if (!told->is_boolean()) return wrong(name, "true or false");
  flag = told->get<bool>();
  return std::nullopt;
}

Check read(const json& filters, const char* filter, const char* name, std::optional<double>& value) {
  const json* told = member(filters, filter);
  const json* number = told == nullptr ? nullptr : member(*told, name);
  if (number == nullptr) return std::nullopt;
  if (!number->is_number()) return wrong(std::string(filter) + "." + name, "number");
  value = number->get<double>();
  return std::nullopt;
}

/// Its mode, as services from 3.5 on call it, or those before.
Check read_mode(const json& state, std::string& mode) {
  mode.clear();
  for (const char* name : {"control_mode", "mode"}) {
    const json* told = member(state, name);
    if (told == nullptr) continue;
    if (!told->is_string()) return wrong(name, "word");
    mode = told->get<std::string>();
    return std::nullopt;
  }
  return std::nullopt;
}

Check merge(const json& told, Device& device) {
  const json nothing = json::object();
  const auto part = [&nothing](const json& whole, const char* name) -> const json& {
    const json* found = member(whole, name);
    return found == nullptr ? nothing : *found;
  };
  const json& state = part(told, "state");
  const json& status = part(told, "status");
  const json& filters = part(part(told, "config"), "filters");
  Check error = read(state, "cursor_position", device.position_m);
  if (!error) error = read(state, "cursor_velocity", device.velocity_m_per_s);
  if (!error) error = read(state, "current_cursor_force", device.force_N);
  if (!error) error = read(status, "calibrated", device.calibrated);
  if (!error) error = read(status, "ready", device.ready);
  if (!error) error = read(status, "power_supply", device.supplied);
  if (!error) error = read_mode(state, device.mode);
  device.told_force = member(state, "current_cursor_force") != nullptr;
  if (!error) error = read(filters, "force_gate", "gain", device.force_gate);
  if (!error) error = read(filters, "damping", "scalar", device.damping);
  return error;
}

}  // namespace

Result<Dialect> dialect_of(std::string_view answer) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t at = 0; at + 2 < answer.size(); ++at) {
    const bool begins = at == 0 || (!is_digit(answer[at - 1]) && answer[at - 1] != '.');
    if (!begins || !is_digit(answer[at]) || answer[at + 1] != '.' || !is_digit(answer[at + 2])) continue;
    const bool long_minor = at + 3 < answer.size() && is_digit(answer[at + 3]);
    const bool new_keys = answer[at] > '3' || (answer[at] == '3' && (answer[at + 2] >= '5' || long_minor));
    return new_keys ? Dialect::named : Dialect::values;
  }
  return Error{
      ErrorCode::syntax, {}, "the service reports no version: look whether another program listens at this port", {}};
}

std::string force_message(std::string_view device_id, const Vector& force_N, Dialect dialect) {
  if (!std::ranges::all_of(force_N, [](double force) { return std::isfinite(force); })) return probe_message(device_id);
  json force;
  for (std::size_t i = 0; i < axes.size(); ++i) force[axes[i]] = force_N[i];
  return message_of(device_id, "set_cursor_force",
                    {{dialect == Dialect::named ? "vector" : "values", std::move(force)}});
}

std::string probe_message(std::string_view device_id) {
  return message_of(device_id, "probe_position", json::object());
}

bool reports_off(const Device& device) noexcept {
  constexpr double none_N = 1e-6;
  const bool forceless = std::ranges::all_of(device.force_N, [](double force) { return std::fabs(force) <= none_N; });
  if (device.told_force && !forceless) return false;
  return device.mode == "idle" || (device.mode.empty() && device.told_force);
}

std::int64_t status_of(const Device& device) noexcept {
  constexpr std::size_t most_letters = 7;
  if (device.mode.empty()) return no_status;
  std::int64_t status = 0;
  for (std::size_t i = std::min(device.mode.size(), most_letters); i > 0; --i) {
    status = status << 8 | static_cast<std::uint8_t>(device.mode[i - 1]);
  }
  return status;
}

std::string status_text(std::int64_t status) {
  if (status < 0) return "no mode";
  std::string mode;
  // It may be any bytes that a service sends.
  for (; status > 0; status >>= 8) {
    const auto letter = static_cast<char>(status & 0xff);
    mode += letter >= ' ' && letter <= '~' ? letter : '?';
  }
  return "mode '" + mode + "'";
}

Check Devices::take(std::string_view message) {
  const json told = json::parse(message, nullptr, false);
  const json* list = member(told, "inverse3");
  if (list == nullptr || !list->is_array()) {
    return Error{ErrorCode::syntax, {}, "the service reports no list of devices", {}};
  }
  std::vector<Device> devices = devices_;
  for (const json& one : *list) {
    const json* id = member(one, "device_id");
    if (id == nullptr || !id->is_string()) return wrong("device_id", "name");
    auto found = std::ranges::find(devices, id->get<std::string>(), &Device::id);
    if (found == devices.end()) {
      devices.emplace_back().id = id->get<std::string>();
      found = devices.end() - 1;
    }
    if (Check error = merge(one, *found)) return under(found->id, *std::move(error));
  }
  devices_ = std::move(devices);
  return std::nullopt;
}

}  // namespace tactus::devices::inverse3
