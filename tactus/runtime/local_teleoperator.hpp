#pragma once

#include <tactus/runtime/device_guard.hpp>
#include <tactus/simulation/site_pair.hpp>

#include <array>
#include <memory>
#include <utility>

namespace tactus::runtime {

/// Both sites of a teleoperator on one computer: a step reads both devices, steps the sites that virtual time steps
/// too, and commands both devices.
///
/// A device that is lost reads as not a number, so that its site lets go. Where a device can do less than its safety
/// gate lets through, the gate is tightened to that: what a site believes to be applied then is. A device that is not
/// simulated stands behind a `GuardedDevice`, and is refused where it states no limits of its own or where a limit of
/// its gates was never chosen.
class LocalTeleoperator {
 public:
  struct Output {
    DeviceReading master;
    DeviceReading slave;
    simulation::SitePair::Output sites;
  };

  /// For devices that outlive it, at rest with the slave at `slave_start_m`. Errors name `control`, `channel`, `master`
  /// and `slave`, the last two where a limit of a device is no limit.
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
  using Walls = std::array<std::unique_ptr<GuardedDevice>, 2>;
  LocalTeleoperator(simulation::SitePair sites, Walls walls, Device& master, Device& slave)
      : sites_(std::move(sites)),
        walls_(std::move(walls)),
        master_(walls_[0] ? walls_[0].get() : &master),
        slave_(walls_[1] ? walls_[1].get() : &slave) {}
  Output advance(const Tick& tick, double share) noexcept;

  simulation::SitePair sites_;
  Walls walls_;  ///< before devices that are not simulated
  Device* master_;
  Device* slave_;
};

}  // namespace tactus::runtime
