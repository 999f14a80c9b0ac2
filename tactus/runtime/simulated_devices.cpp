#include <tactus/runtime/simulated_devices.hpp>

namespace tactus::runtime {

void SimulatedMaster::advance() noexcept {
  const double time_s = static_cast<double>(ticks_) * clock_.tick_s;
  plant_.begin_tick({.motor_force_N = command_.force_N, .handle_force_N = command_.handle_force_N},
                    path_.position_m(time_s), path_.position_m(time_s + clock_.tick_s));
  for (int i = 0; i < clock_.substeps; ++i) plant_.substep(i);
  ++ticks_;
}

DeviceReading SimulatedMaster::read(const Tick& tick) noexcept {
  while (ticks_ < tick.number) advance();
  const auto reading = plant_.measure();
  return {.position_m = reading.motor_position_m, .force_N = reading.hand_force_N, .grip = reading.grip};
}

void SimulatedSlave::advance() noexcept {
  plant_.begin_tick(command_.force_N);
  for (int i = 0; i < clock_.substeps; ++i) plant_.substep(i);
  ++ticks_;
}

DeviceReading SimulatedSlave::read(const Tick& tick) noexcept {
  while (ticks_ < tick.number) advance();
  const auto reading = plant_.measure();
  return {.position_m = reading.motor_position_m, .force_N = reading.tip_force_N};
}

}  // namespace tactus::runtime
