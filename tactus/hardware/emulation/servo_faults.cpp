// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/servo_faults.hpp>

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <system_error>

namespace tactus::emulation {

namespace {

/// `0x24`, or `36`.
std::optional<std::uint8_t> byte_of(std::string_view text) {
  constexpr std::string_view prefix = "0x";
  const bool hexadecimal = text.starts_with(prefix);
  if (hexadecimal) text.remove_prefix(prefix.size());
  std::uint8_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

Result<WrittenFault> parse_servo_fault(std::string_view text) {
  const auto refuse = [whole = std::string(text)](const std::string& why) {
    return Error{ErrorCode::syntax, {}, "'" + whole + "': " + why + ": write KIND[:ID][@SECONDS], as in hot:2@5", {}};
  };
  // What stands behind a mark is a number; it is cut away.
  const auto number_behind = [&text](char mark, double& value) {
    const auto at = text.rfind(mark);
    if (at == std::string_view::npos) return true;
    const std::string_view digits = text.substr(at + 1);
    text = text.substr(0, at);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() && value >= 0.0 && value <= 1e6;
  };
  double from_s = 0.0, id = -1.0;
  if (!number_behind('@', from_s)) return refuse("its beginning must be a number between 0 and 1e6 s");
  if (!number_behind(':', id) || id != std::floor(id)) return refuse("the id must be a whole number");
  std::optional<std::string_view> byte;
  if (const auto at = text.rfind('='); at != std::string_view::npos) {
    byte = text.substr(at + 1);
    text = text.substr(0, at);
  }
  WrittenFault fault;
  fault.id = std::llround(id);
  fault.from_ns = std::llround(from_s * 1e9);
  if (byte.has_value() != (text == name_of(ServoFault::error))) {
    return refuse(byte ? "only error has a byte" : "state the byte, as in error=0x24");
  }
  if (byte) {
    const auto error = byte_of(*byte);
    if (!error) return refuse("the error must be a number between 0x00 and 0xff");
    fault.error = *error;
  }
  constexpr double share = 0.01;
  if (text == "corrupt") {
    fault.line.corrupt = share;
  } else if (text == "garbage") {
    fault.line.garbage = share;
  } else if (text == "split") {
    fault.line.split = share;
  } else if (text == "echo") {
    fault.line.echo = 1;
  } else {
    std::string known = "corrupt, garbage, split, echo";
    for (const auto& entry : enumerators(ServoFault{})) {
      if (entry.value == ServoFault::none) continue;
      if (entry.name == text) {
        fault.servo = entry.value;
        return fault;
      }
      known += std::string(", ") + entry.name + (entry.value == ServoFault::error ? "=0x24" : "");
    }
    return refuse("there is no such fault (" + known + ")");
  }
  if (fault.id >= 0 || fault.from_ns > 0) return refuse("it is of the line, always");
  return fault;
}

}  // namespace tactus::emulation
