// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/damiao/faults.hpp>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <tuple>

namespace tactus::emulation::damiao {

namespace {

/// What stands behind a mark, up to the next one; it is cut away.
std::optional<std::string_view> cut(std::string_view& text, char mark) {
  const auto at = text.rfind(mark);
  if (at == std::string_view::npos) return std::nullopt;
  const auto found = text.substr(at + 1);
  text = text.substr(0, at);
  return found;
}

/// `0x7`, or `7`.
std::optional<std::uint8_t> status_number(std::string_view text) {
  constexpr std::string_view prefix = "0x";
  const bool hexadecimal = text.starts_with(prefix);
  if (hexadecimal) text.remove_prefix(prefix.size());
  std::uint8_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc() || end != text.data() + text.size() || value > 0xf) return std::nullopt;
  return value;
}

std::optional<double> number(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Result<Fault> parse_fault(std::string_view text) {
  const std::string whole(text);
  const auto refuse = [&whole](const std::string& why) {
    return Error{
        .code = ErrorCode::syntax,
        .parameter = {},
        .message = "'" + whole + "': " + why + ": write KIND[:MOTOR][@SECONDS][+SECONDS], as in silence:2@5+0.1",
        .place = {}};
  };
  Fault fault;
  const auto lasts = cut(text, '+'), from = cut(text, '@'), motor = cut(text, ':'), status = cut(text, '=');
  constexpr Bounds seconds = between(0.0, 1e6), motors = between(1.0, 15.0);
  for (const auto& [part, bounds, what] :
       {std::tuple{from, seconds, "its beginning"}, {lasts, seconds, "its length"}, {motor, motors, "the motor"}}) {
    const auto value = number(part.value_or("1"));
    if (!value) return refuse(std::string(what) + " is not a number");
    if (!bounds.contain(*value)) return refuse(std::string(what) + " " + describe_bounds(bounds, units::none));
  }
  fault.from_ns = std::llround(*number(from.value_or("0")) * 1e9);
  if (lasts) fault.until_ns = fault.from_ns + std::llround(*number(*lasts) * 1e9);
  if (motor) fault.motor = static_cast<std::uint32_t>(*number(*motor));
  std::string known;
  for (const auto& entry : enumerators(FaultKind{})) {
    const bool has_status = entry.value == FaultKind::status;
    if (entry.name == text) {
      fault.kind = entry.value;
      if (has_status != status.has_value()) {
        return refuse(has_status ? "state which status, as in status=0x7" : "it has no status");
      }
      if (!has_status) return fault;
      const auto value = status_number(*status);
      if (!value) return refuse("the status must be a number between 0x0 and 0xf");
      fault.status = *value;
      return fault;
    }
    known += (known.empty() ? std::string() : std::string(", ")) + entry.name + (has_status ? "=0x7" : "");
  }
  return refuse("there is no such fault (" + known + ")");
}

}  // namespace tactus::emulation::damiao
