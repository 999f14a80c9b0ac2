// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/simulated_devices.hpp>

namespace tactus::real_time {

void SimulatedSlave::advance() noexcept {
  plant_.begin_tick();
  for (int i = 0; i < clock_.substeps; ++i) plant_.substep(i);
  ++ticks_;
}

station::DeviceReading SimulatedSlave::read(const station::Tick& tick) noexcept {
  while (ticks_ < tick.number) advance();
  return plant_.read(tick);
}

}  // namespace tactus::real_time
