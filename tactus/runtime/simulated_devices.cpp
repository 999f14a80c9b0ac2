#include <tactus/runtime/simulated_devices.hpp>

namespace tactus::runtime {

void SimulatedMaster::advance() noexcept {
  const double time_s = static_cast<double>(ticks_) * clock_.tick_s;
  plant_.begin_tick(path_.position_m(time_s), path_.position_m(time_s + clock_.tick_s));
  for (int i = 0; i < clock_.substeps; ++i) plant_.substep(i);
  ++ticks_;
}

station::DeviceReading SimulatedMaster::read(const station::Tick& tick) noexcept {
  while (ticks_ < tick.number) advance();
  return plant_.read(tick);
}

void SimulatedSlave::advance() noexcept {
  plant_.begin_tick();
  for (int i = 0; i < clock_.substeps; ++i) plant_.substep(i);
  ++ticks_;
}

station::DeviceReading SimulatedSlave::read(const station::Tick& tick) noexcept {
  while (ticks_ < tick.number) advance();
  return plant_.read(tick);
}

}  // namespace tactus::runtime
