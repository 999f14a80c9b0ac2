#include <tactus/cli/device.hpp>
#include <tactus/cli/emulate.hpp>
#include <tactus/devices/damiao/damiao_bus.hpp>

#include <algorithm>

namespace tactus::cli {

namespace {

using devices::damiao::DamiaoBus;
using devices::damiao::Framing;
using devices::damiao::Model;

bool is_one_of(const std::string& word, const std::vector<std::string>& known) {
  return std::find(known.begin(), known.end(), word) != known.end();
}

MotorSheet sheet_of(const DamiaoBus& bus, std::size_t motor) {
  const auto& facts = bus.facts(motor);
  MotorSheet sheet{.scales = {}, .firmware = {}, .problem = bus.problem(motor)};
  if (facts.software_version >= 0) {
    sheet.firmware = std::to_string(facts.software_version);
    sheet.scales = format_number(facts.position_scale_rad) + " rad, " + format_number(facts.velocity_scale_rad_per_s) +
                   " rad/s, " + format_number(facts.torque_scale_Nm) + " Nm";
  }
  return sheet;
}

}  // namespace

Error unknown_word(const char* place, const std::string& word, const std::vector<std::string>& known) {
  std::string all;
  for (const std::string& one : known) all += all.empty() ? one : ", " + one;
  return {
      .code = ErrorCode::unknown_key, .parameter = {}, .message = "'" + word + "' is none of " + all, .place = place};
}

Result<BusToCheck> make_damiao_bus(const StatedBus& stated) {
  constexpr std::int64_t bits_per_s = 921'600;
  if (!is_one_of(stated.framing, words_of<Framing>())) {
    return unknown_word("--framing", stated.framing, words_of<Framing>());
  }
  devices::damiao::DamiaoBusParams params;
  params.framing = value_of<Framing>(stated.framing);
  for (const StatedMotor& motor : stated.motors) {
    if (!is_one_of(motor.model, words_of<Model>())) return unknown_word("--motors", motor.model, words_of<Model>());
    params.motors.push_back({.id = motor.id, .feedback_id = motor.id + 0x10, .model = value_of<Model>(motor.model)});
  }
  auto bus = DamiaoBus::make(params);
  if (!bus) {
    Error error = bus.error();
    error.place = "--motors";
    return error;
  }
  const bool of_linux = params.framing == Framing::socketcan || params.framing == Framing::socketcan_fd;
  auto port = of_linux ? wire::Port::can(stated.port, params.framing == Framing::socketcan_fd)
                       : wire::Port::serial(stated.port, bits_per_s);
  if (!port) return port.error();
  const DamiaoBus& looked_at = **bus;
  return BusToCheck{.bus = *std::move(bus), .port = *std::move(port), .sheet = [&looked_at](std::size_t motor) {
                      return sheet_of(looked_at, motor);
                    }};
}

}  // namespace tactus::cli
