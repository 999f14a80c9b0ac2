// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/inverse3/faults.hpp>

#include <charconv>
#include <cmath>
#include <system_error>

namespace tactus::emulation::inverse3 {

Result<Fault> parse_fault(std::string_view text) {
  const auto refuse = [whole = std::string(text)](const std::string& why) {
    return Error{
        ErrorCode::syntax, {}, "'" + whole + "': " + why + ": write KIND[=VALUE][@SECONDS], as in ready=0@5", {}};
  };
  Fault fault;
  if (const auto at = text.rfind('@'); at != std::string_view::npos) {
    const std::string_view digits = text.substr(at + 1);
    double from_s = -1.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), from_s);
    const bool number = error == std::errc() && end == digits.data() + digits.size();
    if (!number || !(from_s >= 0.0 && from_s <= 1e6))
      return refuse("its beginning must be a number between 0 and 1e6 s");
    fault.from_ns = std::llround(from_s * 1e9);
    text = text.substr(0, at);
  }
  const auto equals = text.find('=');
  const std::string_view kind = text.substr(0, equals);
  std::string known;
  for (const auto& entry : enumerators(FaultKind{})) {
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
    if (entry.name != kind) continue;
    fault.kind = entry.value;
    if ((equals == std::string_view::npos) != (fault.kind == FaultKind::keeps_force)) {
      return refuse(fault.kind == FaultKind::keeps_force ? "it has no value" : "it needs a value");
    }
    if (fault.kind == FaultKind::keeps_force) return fault;
    const std::string_view value = text.substr(equals + 1);
    if (fault.kind == FaultKind::mode) {
      fault.mode = value;
      return fault;
    }
    if (value != "0" && value != "1") return refuse("the value must be 0 or 1");
    fault.flag = value == "1";
    return fault;
  }
  return refuse("there is no such fault (" + known + ")");
}

}  // namespace tactus::emulation::inverse3
