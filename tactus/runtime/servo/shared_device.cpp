// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/shared_device.hpp>

#include <cmath>

namespace tactus::runtime {

namespace {

std::int64_t in_ns(Seconds time) noexcept { return std::llround(1e9 * time.value); }

/// Told too long ago; or in the future, by a process with another clock.
bool too_old(std::int64_t told_ns, std::int64_t now_ns, std::int64_t silence_ns) noexcept {
  return now_ns - told_ns > silence_ns || told_ns - now_ns > silence_ns;
}

bool is_finite(const station::DeviceReading& reading) noexcept {
  return std::isfinite(reading.position_m) && std::isfinite(reading.force_N) && std::isfinite(reading.grip);
}

}  // namespace

SharedDevice::SharedDevice(DeviceSlots& slots, const station::DeviceLimits& limits, Seconds silence,
                           bool simulated) noexcept
    : slots_(&slots), limits_(limits), silence_ns_(in_ns(silence)), simulated_(simulated) {}

void SharedDevice::begin(std::uint64_t session) noexcept {
  session_ = session;
  last_ = {};
  health_ = station::DeviceHealth::degraded;
}

bool SharedDevice::given_up_by_owner() const noexcept { return session_ != 0 && last_.gave_up_on == session_; }

station::DeviceReading SharedDevice::read(const station::Tick& tick) noexcept {
  now_ = tick;
  const auto newest = slots_->readings.newest();
  if (health_ == station::DeviceHealth::lost) return last_.reading;
  health_ = station::DeviceHealth::degraded;
  if (newest && newest->time_ns > last_.time_ns) {
    if (is_finite(newest->reading)) {
      last_ = *newest;
      health_ = station::DeviceHealth::good;
    } else {
      health_ = station::DeviceHealth::lost;
    }
  }
  if (too_old(last_.time_ns, now_.began_ns, silence_ns_) || given_up_by_owner()) health_ = station::DeviceHealth::lost;
  return last_.reading;
}

void SharedDevice::write(const station::DeviceCommand& command) noexcept {
  slots_->commands.publish({.force_N = command.force_N,
                            .handle_force_N = command.handle_force_N,
                            .enabled = command.enabled ? 1U : 0U,
                            .tick = now_.number,
                            .time_ns = now_.began_ns,
                            .session = session_});
}

DeviceServer::DeviceServer(DeviceSlots& slots, Seconds silence, const station::DeviceLimits& limits) noexcept
    : slots_(&slots), silence_ns_(in_ns(silence)), guard_(limits, silence) {}

void DeviceServer::begin(std::uint64_t session) noexcept {
  session_ = session;
  command_ = {};
  guard_.rearm();
}

station::DeviceCommand DeviceServer::command(const station::Tick& tick) noexcept {
  const auto newest = slots_->commands.newest();
  // The last one of a loop, which lets go, has the tick of the one before.
  if (newest && newest->session == session_ && newest->time_ns >= command_.time_ns) {
    if (!obeyed() || newest->tick > command_.tick) alive_ns_ = newest->time_ns;
    command_ = *newest;
  }
  if (!obeyed()) return guard_.pass({.enabled = false}, tick);
  if (too_old(alive_ns_, tick.began_ns, silence_ns_)) guard_.release(station::ReleaseCause::timed_out);
  return guard_.pass(
      {.force_N = command_.force_N, .handle_force_N = command_.handle_force_N, .enabled = command_.enabled != 0}, tick);
}

void DeviceServer::publish(const station::Tick& tick, std::int64_t device_tick,
                           const station::DeviceReading& reading) noexcept {
  guard_.observe(reading.position_m, tick);
  slots_->readings.publish({.reading = reading,
                            .tick = device_tick,
                            .time_ns = tick.began_ns,
                            .gave_up_on = gave_up() ? session_ : 0,
                            .cause = guard_.cause()});
}

}  // namespace tactus::runtime
