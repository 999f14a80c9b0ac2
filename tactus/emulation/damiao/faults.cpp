#include <tactus/emulation/damiao/faults.hpp>

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
  const auto lasts = cut(text, '+'), from = cut(text, '@'), motor = cut(text, ':');
  constexpr Bounds seconds = between(0.0, 1e6), motors = between(1.0, 15.0);
  for (const auto& [part, bounds, what] :
       {std::tuple{from, seconds, "its beginning"}, {lasts, seconds, "its length"}, {motor, motors, "the motor"}}) {
    const auto value = number(part.value_or("1"));
    if (!value) return refuse(std::string(what) + " is no number");
    if (!bounds.contain(*value)) return refuse(std::string(what) + " " + describe_bounds(bounds, units::none));
  }
  fault.from_ns = std::llround(*number(from.value_or("0")) * 1e9);
  if (lasts) fault.until_ns = fault.from_ns + std::llround(*number(*lasts) * 1e9);
  if (motor) fault.motor = static_cast<std::uint32_t>(*number(*motor));
  std::string known;
  for (const auto& entry : enumerators(FaultKind{})) {
    if (entry.name == text) {
      fault.kind = entry.value;
      return fault;
    }
    known += known.empty() ? entry.name : std::string(", ") + entry.name;
  }
  return refuse("there is no such fault (" + known + ")");
}

}  // namespace tactus::emulation::damiao
