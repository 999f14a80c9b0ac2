#pragma once

#include <tactus/control/architecture.hpp>
#include <tactus/control/supervision.hpp>

#include <cstdint>

/// A site as it runs on a machine: the controller behind its gate, told what to believe of the other site, and brought
/// in and out without a bump.
namespace tactus::control {

/// The master. A person arms it and presses the dead-man switch; then it tells the slave where the hand means to be and
/// displays what the slave tells. While the clutch is pressed, and in every state but `active`, it tells the position
/// that it told last and gives no force: what the hand moved meanwhile becomes the workspace offset.
class SupervisedMaster {
 public:
  using Sensors = MasterInput;
  using Wish = SiteRequests;
  struct Input {
    Sensors sensors{};  ///< its arrival is not used: packets say what came
    SiteRequests requests{};
    std::int64_t elapsed_ticks = 1;  ///< since the step before; more after a stall
  };
  struct Output {
    MasterOutput site;
    Packet packet;  ///< for the slave
    SiteRecord record;
  };

  SupervisedMaster(MasterSite site, const Supervision& supervision, const ForceSensorCheck& hand_sensor)
      : site_(std::move(site)), supervision_(supervision), hand_sensor_(hand_sensor) {}

  /// A packet that has come; any number of them before `step`. Real-time safe.
  PacketVerdict take(const Packet& packet) noexcept { return supervision_.take(packet); }
  /// One tick. Real-time safe.
  Output step(const Input& input) noexcept;

  [[nodiscard]] SiteState state() const noexcept { return supervision_.state(); }
  [[nodiscard]] const AgreementCheck& agreement() const noexcept { return supervision_.agreement(); }
  /// The packet of the other site that was applied last; of session 0 before any.
  [[nodiscard]] const Packet& heard() const noexcept { return supervision_.heard(); }
  [[nodiscard]] const MasterSite& site() const noexcept { return site_; }

 private:
  MasterSite site_;
  Supervision supervision_;
  ForceSensorCheck hand_sensor_;  ///< the hand resists the motor as a wall does a slave
  double told_m_ = 0.0;
  double offset_m_ = 0.0;
};

/// The slave. Out of `configure` it stands where it is, by its own servo, until it follows. In `hold` it stands where
/// it was told to be last while its force fades; armed again, it stands where it is then.
class SupervisedSlave {
 public:
  using Sensors = SlaveInput;
  using Wish = SiteRequests;
  struct Input {
    Sensors sensors{};  ///< its arrival is not used: packets say what came
    SiteRequests requests{};
    std::int64_t elapsed_ticks = 1;
  };
  struct Output {
    SlaveOutput site;
    Packet packet;  ///< for the master
    SiteRecord record;
  };

  SupervisedSlave(SlaveSite site, const Supervision& supervision, const ForceSensorCheck& force_sensor)
      : site_(std::move(site)), supervision_(supervision), force_sensor_(force_sensor) {}

  /// A packet that has come; any number of them before `step`. Real-time safe.
  PacketVerdict take(const Packet& packet) noexcept { return supervision_.take(packet); }
  /// One tick. Real-time safe.
  Output step(const Input& input) noexcept;

  [[nodiscard]] SiteState state() const noexcept { return supervision_.state(); }
  [[nodiscard]] const AgreementCheck& agreement() const noexcept { return supervision_.agreement(); }
  /// The packet of the other site that was applied last; of session 0 before any.
  [[nodiscard]] const Packet& heard() const noexcept { return supervision_.heard(); }
  [[nodiscard]] const SlaveSite& site() const noexcept { return site_; }

 private:
  SlaveSite site_;
  Supervision supervision_;
  ForceSensorCheck force_sensor_;
};

/// The site that `params` describe, under supervision. `session` is any number but 0 that no earlier start of this site
/// used. Errors: those of `make_sites` and of `Supervision`, under `supervision`.
Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt);
Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt);
/// The same for a site whose `params` are tighter than what it has in common with the other, which `agreement` says.
Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt,
                                                const Agreement& agreement);
Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt,
                                              const Agreement& agreement);

}  // namespace tactus::control
