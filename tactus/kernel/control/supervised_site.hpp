// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/gain_change.hpp>
#include <tactus/kernel/control/supervision.hpp>

#include <cstdint>

/// A site as it runs on a machine: the controller behind its gate, with its assumptions of the other site, and brought
/// in and out without a bump.
namespace tactus::control {

/// The master. An operator arms it and presses the dead-man switch; then it sends the slave where the hand means to be
/// and displays what the slave reports, by a force gain that the operator may change meanwhile (`GainChange`). While
/// the clutch is pressed, and in every state but `active`, it reports the position that it sent last and gives no
/// force: what the hand moved meanwhile becomes the workspace offset.
template <class Gated>
class SupervisedMasterOf {
 public:
  using Sensors = typename Gated::Sensors;
  using Payload = Each<Sensors, Message>;
  using Packet = PacketOf<Payload>;
  using Request = SiteRequests;
  struct Input {
    Sensors sensors{};  ///< its arrival is not used: packets show what came
    SiteRequests requests{};
    std::int64_t elapsed_ticks = 1;  ///< since the step before; more after a stall
    bool device_silent = false;      ///< what the sensors read is too old to act on
  };
  struct Output {
    typename Gated::Output site;
    Packet packet;  ///< for the slave
    SiteRecord record;
  };

  SupervisedMasterOf(Gated site, const SupervisionOf<Payload>& supervision,
                     const Each<Sensors, ForceSensorCheck>& hand_sensor, const GainChange& gain)
      : site_(std::move(site)),
        supervision_(supervision),
        hand_sensor_(hand_sensor),
        gain_(gain),
        told_m_(same_for_each(hand_sensor, 0.0)),
        offset_m_(told_m_) {}

  /// A packet that has come; any number of them before `step`. Real-time safe.
  PacketVerdict take(const Packet& packet) noexcept { return supervision_.take(packet); }
  /// One tick. Real-time safe.
  Output step(const Input& input) noexcept;

  [[nodiscard]] SiteState state() const noexcept { return supervision_.state(); }
  [[nodiscard]] SiteCause cause() const noexcept { return supervision_.cause(); }  ///< why it does not follow
  [[nodiscard]] const AgreementCheck& agreement() const noexcept { return supervision_.agreement(); }
  /// How the support of the device comes in, and what was found wrong with it.
  [[nodiscard]] const SupportRaiseOf<Payload>& support() const noexcept { return supervision_.support(); }
  /// As of `SupervisionOf`.
  [[nodiscard]] ProbeFinding probe_finding() const noexcept { return supervision_.probe_finding(); }
  /// The packet of the other site that was applied last; of session 0 before any.
  [[nodiscard]] const Packet& heard() const noexcept { return supervision_.heard(); }
  [[nodiscard]] const Gated& site() const noexcept { return site_; }
  /// The force gain as it acts, and how far an operator may raise it.
  [[nodiscard]] const GainChange& force_gain() const noexcept { return gain_; }

 private:
  Gated site_;
  SupervisionOf<Payload> supervision_;
  Each<Sensors, ForceSensorCheck> hand_sensor_;  ///< the hand resists the motor as a wall does a slave
  GainChange gain_;
  bool tared_ = false;  ///< since the tare was asked for
  Each<Sensors, double> told_m_;
  Each<Sensors, double> offset_m_;
};

/// The slave. Out of `configure` it is where it is, by its own servo, until it follows. In `hold` it is where
/// it was commanded to be last while its force fades; armed again, it is where it is then.
template <class Gated>
class SupervisedSlaveOf {
 public:
  using Sensors = typename Gated::Sensors;
  using Payload = Each<Sensors, Message>;
  using Packet = PacketOf<Payload>;
  using Request = SiteRequests;
  struct Input {
    Sensors sensors{};  ///< its arrival is not used: packets show what came
    SiteRequests requests{};
    std::int64_t elapsed_ticks = 1;
    bool device_silent = false;  ///< what the sensors read is too old to act on
  };
  struct Output {
    typename Gated::Output site;
    Packet packet;  ///< for the master
    SiteRecord record;
  };

  SupervisedSlaveOf(Gated site, const SupervisionOf<Payload>& supervision,
                    const Each<Sensors, ForceSensorCheck>& force_sensor)
      : site_(std::move(site)), supervision_(supervision), force_sensor_(force_sensor) {}

  /// A packet that has come; any number of them before `step`. Real-time safe.
  PacketVerdict take(const Packet& packet) noexcept { return supervision_.take(packet); }
  /// One tick. Real-time safe.
  Output step(const Input& input) noexcept;

  [[nodiscard]] SiteState state() const noexcept { return supervision_.state(); }
  [[nodiscard]] SiteCause cause() const noexcept { return supervision_.cause(); }  ///< why it does not follow
  [[nodiscard]] const AgreementCheck& agreement() const noexcept { return supervision_.agreement(); }
  /// How the support of the device comes in, and what was found wrong with it.
  [[nodiscard]] const SupportRaiseOf<Payload>& support() const noexcept { return supervision_.support(); }
  /// As of `SupervisionOf`.
  [[nodiscard]] ProbeFinding probe_finding() const noexcept { return supervision_.probe_finding(); }
  /// The packet of the other site that was applied last; of session 0 before any.
  [[nodiscard]] const Packet& heard() const noexcept { return supervision_.heard(); }
  [[nodiscard]] const Gated& site() const noexcept { return site_; }

 private:
  Gated site_;
  SupervisionOf<Payload> supervision_;
  Each<Sensors, ForceSensorCheck> force_sensor_;
  bool tared_ = false;  ///< since the tare was asked for
};

using SupervisedMaster = SupervisedMasterOf<MasterSite>;
using SupervisedSlave = SupervisedSlaveOf<SlaveSite>;
using JointSupervisedMaster = SupervisedMasterOf<JointMasterSite>;
using JointSupervisedSlave = SupervisedSlaveOf<JointSlaveSite>;

/// The site that `params` describe, under supervision. `session` is any number but 0 that no earlier start of this site
/// used. Errors: those of `make_sites` and of `Supervision`, under `supervision`.
Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt);
Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt);
/// The same for a site whose `params` are tighter than what it has in common with the other, which `agreement` states.
Result<SupervisedMaster> make_supervised_master(const ControlParams& params, std::int64_t session, Seconds dt,
                                                const Agreement& agreement);
Result<SupervisedSlave> make_supervised_slave(const ControlParams& params, std::int64_t session, Seconds dt,
                                              const Agreement& agreement);
/// The same of several joints. Errors of one of them are under it, as `joint_2`.
Result<JointSupervisedMaster> make_supervised_master(const JointParams auto& params, std::int64_t session, Seconds dt,
                                                     const Agreement& agreement);
Result<JointSupervisedSlave> make_supervised_slave(const JointParams auto& params, std::int64_t session, Seconds dt,
                                                   const Agreement& agreement);

/// A site of several joints whose controller is not one of `architectures()`, as one that couples them, under
/// supervision. Errors: those of `Supervision`, under `supervision`; `inconsistent` for another number of joints.
Result<JointSupervisedMaster> supervise_master(JointMasterSite site, const Joints<SupervisionParams>& params,
                                               std::int64_t session, Seconds dt, const Agreement& agreement = {});
Result<JointSupervisedSlave> supervise_slave(JointSlaveSite site, const Joints<SupervisionParams>& params,
                                             std::int64_t session, Seconds dt, const Agreement& agreement = {});

}  // namespace tactus::control
