// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/bus_thread.hpp>
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>
#include <tactus/hardware/devices/inverse3/inverse3_link.hpp>
#include <tactus/hardware/devices/inverse3/messages.hpp>
#include <tactus/hardware/devices/plugin/blocking_link.hpp>
#include <tactus/hardware/devices/rig/bus_kinds.hpp>
#include <tactus/hardware/wire/port.hpp>

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

namespace tactus::devices {

namespace {

using damiao::DamiaoBus;
using dynamixel::DynamixelBus;
using feetech::FeetechBus;

/// A servo knows where it is within one turn when it starts; no joint of an arm turns farther than twice, either way.
constexpr double servo_position_rad = 4.0 * std::numbers::pi;
/// More than the arms of the device are long.
constexpr double inverse3_reach_m = 1.0;

template <NamedEnum E>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  for (const auto& entry : enumerators(E{})) words.emplace_back(entry.name);
  return words;
}

template <NamedEnum E>
Result<E> value_of(const std::string& key, const std::string& word) {
  std::string all;
  for (const auto& entry : enumerators(E{})) {
    if (entry.name == word) return entry.value;
    all += (all.empty() ? "" : ", ") + std::string(entry.name);
  }
  return Error{
      .code = ErrorCode::unknown_key, .parameter = key, .message = "'" + word + "' is not one of " + all, .place = {}};
}

std::string key_of_motor(std::size_t motor, const char* key) {
  return std::string("motors[") + std::to_string(motor) + "]." + key;
}

Result<damiao::DamiaoBusParams> damiao_params(const StatedBus& stated) {
  damiao::DamiaoBusParams params;
  const auto framing = value_of<damiao::Framing>("framing", stated.framing);
  if (!framing) return framing.error();
  params.framing = *framing;
  params.watchdog_s = stated.watchdog_s;
  params.reply_timeout_s = stated.reply_timeout_s;
  for (std::size_t i = 0; i < stated.motors.size(); ++i) {
    const StatedMotor& motor = stated.motors[i];
    const auto model = value_of<damiao::Model>(key_of_motor(i, "model"), motor.model);
    if (!model) return model.error();
    constexpr std::int64_t convention = 0x10;
    params.motors.push_back({.id = motor.id,
                             .feedback_id = motor.feedback_id < 0 ? motor.id + convention : motor.feedback_id,
                             .model = *model});
  }
  return params;
}

Result<DynamixelBus::Params> dynamixel_params(const StatedBus& stated) {
  DynamixelBus::Params params;
  params.bits_per_s = stated.bits_per_s;
  for (std::size_t i = 0; i < stated.motors.size(); ++i) {
    const auto model = value_of<dynamixel::DynamixelModel>(key_of_motor(i, "model"), stated.motors[i].model);
    if (!model) return model.error();
    params.motors.push_back({.id = stated.motors[i].id, .model = *model});
  }
  return params;
}

Result<FeetechBus::Params> feetech_params(const StatedBus& stated) {
  FeetechBus::Params params;
  params.bits_per_s = stated.bits_per_s;
  for (std::size_t i = 0; i < stated.motors.size(); ++i) {
    const StatedMotor& motor = stated.motors[i];
    const auto model = value_of<feetech::FeetechModel>(key_of_motor(i, "model"), motor.model);
    if (!model) return model.error();
    params.motors.push_back({.id = motor.id, .model = *model, .torque_Nm_per_A = motor.torque_Nm_per_A});
  }
  return params;
}

inverse3::LinkParams inverse3_params(const StatedBus& stated) {
  inverse3::LinkParams params{.address = stated.port, .device = stated.device, .axes = {}};
  for (const StatedMotor& motor : stated.motors) params.axes.push_back(motor.id);
  return params;
}

Result<std::unique_ptr<BlockingDriver>> make_driver(const StatedBus& stated) {
  DriverRequest request{.port = stated.port, .motors = {}};
  for (const StatedMotor& motor : stated.motors) request.motors.push_back(motor.id);
  auto driver = stated.settings->make(request);
  if (driver && (*driver)->motors() != stated.motors.size()) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "motors",
                 .message = "the driver " + stated.driver + " has " + std::to_string((*driver)->motors()) +
                            " motors, and the file states " + std::to_string(stated.motors.size()) +
                            " joints: write a joint for each",
                 .place = {}};
  }
  return driver;
}

/// On the heap, whatever `make` gives.
template <class Bus>
Result<std::unique_ptr<MotorBus>> on_heap(Result<Bus> made) {
  if (!made) return made.error();
  return std::unique_ptr<MotorBus>(std::make_unique<Bus>(*std::move(made)));
}

Result<std::unique_ptr<MotorBus>> make_bus(const StatedBus& stated) {
  switch (stated.kind) {
    case BusKind::damiao: {
      const auto params = damiao_params(stated);
      if (!params) return params.error();
      auto made = DamiaoBus::make(*params);
      if (!made) return made.error();
      return std::unique_ptr<MotorBus>(*std::move(made));
    }
    case BusKind::dynamixel: {
      const auto params = dynamixel_params(stated);
      return params ? on_heap(DynamixelBus::make(*params)) : params.error();
    }
    case BusKind::feetech: {
      const auto params = feetech_params(stated);
      return params ? on_heap(FeetechBus::make(*params)) : params.error();
    }
    case BusKind::inverse3:
    case BusKind::plugged:
      break;  // are no buses of ours
  }
  return Error{};
}

}  // namespace

std::vector<std::string> models_of(BusKind kind) {
  switch (kind) {
    case BusKind::damiao:
      return words_of<damiao::Model>();
    case BusKind::dynamixel:
      return words_of<dynamixel::DynamixelModel>();
    case BusKind::feetech:
      return words_of<feetech::FeetechModel>();
    case BusKind::inverse3:
      return {"inverse3"};
    case BusKind::plugged:
      return {};
  }
  return {};
}

std::string_view bus_name(const StatedBus& stated) {
  return stated.kind == BusKind::plugged ? std::string_view(stated.driver) : name_of(stated.kind);
}

MotorAbility ability_of(const StatedBus& bus, const StatedMotor& motor) {
  switch (bus.kind) {
    case BusKind::damiao: {
      const auto model = value_of<damiao::Model>("model", motor.model);
      const damiao::Scale scale = damiao::scale_of(model ? *model : damiao::Model{});
      return {.torque_Nm = scale.torque_Nm,
              .velocity_rad_per_s = scale.velocity_rad_per_s,
              .position_rad = scale.position_rad,
              .stiffness_Nm_per_rad = damiao::largest_stiffness_Nm_per_rad,
              .damping_Nms_per_rad = damiao::largest_damping_Nms_per_rad};
    }
    case BusKind::dynamixel: {
      const auto model = value_of<dynamixel::DynamixelModel>("model", motor.model);
      const ServoModel& servo = dynamixel::servo_model(model ? *model : dynamixel::DynamixelModel{});
      return {.torque_Nm = static_cast<double>(servo.current_limit) * servo.current_unit_A * servo.torque_Nm_per_A,
              .position_rad = servo_position_rad};
    }
    case BusKind::feetech: {
      const auto model = value_of<feetech::FeetechModel>("model", motor.model);
      const ServoModel& servo = feetech::servo_model(model ? *model : feetech::FeetechModel{});
      return {.torque_Nm = static_cast<double>(servo.current_limit) * servo.current_unit_A * motor.torque_Nm_per_A,
              .position_rad = servo_position_rad};
    }
    case BusKind::inverse3:
      return {.torque_Nm = std::numeric_limits<double>::infinity(), .position_rad = inverse3_reach_m};
    case BusKind::plugged: {
      const auto place = std::ranges::find(bus.motors, motor.id, &StatedMotor::id) - bus.motors.begin();
      const auto driver = make_driver(bus);
      const auto index = static_cast<std::size_t>(place);
      return driver && index < bus.motors.size() ? (*driver)->ability(index) : MotorAbility{};
    }
  }
  return {};
}

std::string status_text(BusKind kind, std::int64_t status) {
  switch (kind) {
    case BusKind::damiao:
      return damiao::status_text(status);
    case BusKind::dynamixel:
    case BusKind::feetech:
      return servo_status_text(status);
    case BusKind::inverse3:
      return inverse3::status_text(status);
    case BusKind::plugged:
      return status == no_status ? "no status" : "status " + std::to_string(status);
  }
  return {};
}

Check check(const StatedBus& stated) {
  if (stated.kind == BusKind::inverse3) return inverse3::check(inverse3_params(stated));
  if (stated.kind == BusKind::plugged) {
    const auto driver = make_driver(stated);
    return driver ? Check{} : driver.error();
  }
  const auto made = make_bus(stated);
  return made ? Check{} : made.error();
}

Result<wire::Port> open_port(const StatedBus& stated) {
  if (Check wrong = check(stated)) return *std::move(wrong);
  // What an adapter of CAN is set to at its serial side is the same for all; most take no notice of it.
  constexpr std::int64_t adapter_bits_per_s = 921'600;
  const bool is_damiao = stated.kind == BusKind::damiao;
  const bool flexible = stated.framing == name_of(damiao::Framing::socketcan_fd);
  const bool of_linux = is_damiao && (flexible || stated.framing == name_of(damiao::Framing::socketcan));
  return of_linux ? wire::Port::can(stated.port, flexible)
                  : wire::Port::serial(stated.port, is_damiao ? adapter_bits_per_s : stated.bits_per_s);
}

Result<std::unique_ptr<MotorLink>> start(const StatedBus& stated, wire::Port port) {
  auto bus = make_bus(stated);
  if (!bus) return bus.error();
  auto thread = BusThread::start(*std::move(bus), std::move(port), {});
  if (!thread) return thread.error();
  return std::unique_ptr<MotorLink>(*std::move(thread));
}

Result<std::unique_ptr<MotorLink>> start(const StatedBus& stated) {
  if (stated.kind == BusKind::inverse3) {
    auto link = inverse3::Inverse3Link::start(inverse3_params(stated));
    if (!link) return link.error();
    return std::unique_ptr<MotorLink>(*std::move(link));
  }
  if (stated.kind == BusKind::plugged) {
    auto driver = make_driver(stated);
    if (!driver) return driver.error();
    auto link = BlockingLink::start(*std::move(driver), stated.watchdog_s);
    if (!link) return link.error();
    return std::unique_ptr<MotorLink>(*std::move(link));
  }
  auto port = open_port(stated);
  return port ? start(stated, *std::move(port)) : port.error();
}

std::vector<std::int64_t> bit_rates_of(BusKind kind) {
  switch (kind) {
    case BusKind::damiao:
    case BusKind::inverse3:
    case BusKind::plugged:
      return {};
    case BusKind::dynamixel:
      return {dynamixel::bit_rates.begin(), dynamixel::bit_rates.end()};
    case BusKind::feetech:
      return {feetech::bit_rates.begin(), feetech::bit_rates.end()};
  }
  return {};
}

}  // namespace tactus::devices
