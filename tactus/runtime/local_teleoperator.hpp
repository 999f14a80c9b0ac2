#pragma once

#include <tactus/runtime/device.hpp>
#include <tactus/simulation/site_pair.hpp>

#include <utility>

namespace tactus::runtime {

/// Both sites of a teleoperator on one computer: a step reads both devices, steps the sites that virtual time steps
/// too, and commands both devices.
///
/// A device that is lost reads as not a number, so that its site lets go. Where a device can do less than its safety
/// gate lets through, the gate is tightened to that: what a site believes to be applied then is.
class LocalTeleoperator {
 public:
  struct Output {
    DeviceReading master;
    DeviceReading slave;
    simulation::SitePair::Output sites;
  };

  /// For devices that outlive it, at rest with the slave at `slave_start_m`. Errors name `control` and `channel`.
  static Result<LocalTeleoperator> make(const control::ControlParams& control, const simulation::LinkParams& channel,
                                        Seconds tick, double slave_start_m, Device& master, Device& slave);

  /// One tick. Real-time safe as far as the devices are.
  Output step(const Tick& tick) noexcept { return advance(tick, 1.0); }
  /// The same with sites that want no force: what a loop does from its end on, tick by tick, until it is `at_rest`. The
  /// force falls at the gates' rate limits. Real-time safe as far as the devices are.
  Output let_go(const Tick& tick) noexcept { return advance(tick, 0.0); }
  /// No site commanded a force at the latest tick.
  [[nodiscard]] bool at_rest() const noexcept { return sites_.at_rest(); }
  /// Commands no force at once, whatever it was: for an end that cannot wait. Real-time safe as far as the devices are.
  void release() noexcept;
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept { return sites_.healthy(); }

 private:
  LocalTeleoperator(simulation::SitePair sites, Device& master, Device& slave)
      : sites_(std::move(sites)), master_(&master), slave_(&slave) {}
  Output advance(const Tick& tick, double share) noexcept;

  simulation::SitePair sites_;
  Device* master_;
  Device* slave_;
};

}  // namespace tactus::runtime
