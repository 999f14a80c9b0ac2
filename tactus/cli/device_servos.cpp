#include <tactus/cli/device.hpp>
#include <tactus/cli/emulate.hpp>
#include <tactus/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/devices/feetech/feetech_bus.hpp>

#include <algorithm>

namespace tactus::cli {

namespace {

/// A bus of servos at a serial port. `set_model` gives a motor its model.
template <class Bus, class Model, class SetModel>
Result<BusToCheck> make_servo_bus(const StatedBus& stated, const SetModel& set_model) {
  typename Bus::Params params;
  params.bits_per_s = stated.bits_per_s;
  const auto models = words_of<Model>();
  for (const StatedMotor& one : stated.motors) {
    if (std::ranges::find(models, one.model) == models.end()) return unknown_word("--motors", one.model, models);
    typename Bus::Motor motor;
    motor.id = one.id;
    set_model(motor, value_of<Model>(one.model));
    params.motors.push_back(motor);
  }
  auto made = Bus::make(params);
  if (!made) {
    Error error = made.error();
    error.place = error.parameter == "bits_per_s" ? "--bits-per-s" : "--motors";
    return error;
  }
  auto port = wire::Port::serial(stated.port, stated.bits_per_s);
  if (!port) return port.error();
  auto bus = std::make_unique<Bus>(*std::move(made));
  const Bus& looked_at = *bus;
  return BusToCheck{.bus = std::move(bus), .port = *std::move(port), .sheet = [&looked_at](std::size_t motor) {
                      const double limit_A = looked_at.current_limit_A(motor);
                      return MotorSheet{.scales = limit_A > 0.0 ? format_number(limit_A) + " A" : "no force",
                                        .firmware = {},
                                        .problem = looked_at.problem(motor)};
                    }};
}

}  // namespace

Result<BusToCheck> make_dynamixel_bus(const StatedBus& stated) {
  using devices::dynamixel::DynamixelBus;
  using devices::dynamixel::DynamixelModel;
  return make_servo_bus<DynamixelBus, DynamixelModel>(
      stated, [](DynamixelBus::Motor& motor, DynamixelModel model) { motor.model = model; });
}

Result<BusToCheck> make_feetech_bus(const StatedBus& stated) {
  using devices::feetech::FeetechBus;
  using devices::feetech::FeetechModel;
  return make_servo_bus<FeetechBus, FeetechModel>(stated, [](FeetechBus::Motor& motor, FeetechModel model) {
    motor.model = model;
    motor.torque_Nm_per_A = 1.0;  // no torque is asked for
  });
}

}  // namespace tactus::cli
