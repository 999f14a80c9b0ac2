// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/sites_record.hpp>

namespace tactus::runtime {

SitesRecord recorded(std::int64_t tap, const station::Tick& tick, const station::BarePair::Output& step) noexcept {
  const auto& [master, slave] = step;
  SitesRecord record{{master.output.message}, {slave.output.message}, master.output.hand};
  record.tap = tap;
  record.tick = tick.number;
  record.missed = tick.missed;
  record.master_position_m = master.reading.position_m;
  record.hand_force_N = master.reading.force_N;
  record.grip = master.reading.grip;
  record.slave_position_m = slave.reading.position_m;
  record.tip_force_N = slave.reading.force_N;
  record.master_force_N = master.output.motor_force_N;
  record.handle_force_N = master.output.handle_force_N;
  record.induced_position_m = master.output.induced_position_m;
  record.intended_position_m = master.output.intended_position_m;
  record.slave_force_N = slave.output.motor_force_N;
  return record;
}

}  // namespace tactus::runtime
