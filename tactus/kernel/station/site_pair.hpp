// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/station/channel.hpp>
#include <tactus/kernel/station/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace tactus::station {

/// The way of one site of a pair: what it receives at this tick, and the channel into which it speaks. Messages for a
/// site without supervision, packets for one with it.
template <class Payload>
struct TransportEnd {
  using Delivery = typename ChannelOf<Payload>::Delivery;

  const Delivery& heard;
  ChannelOf<Payload>& out;
  Delivery& other_hears;
  double tick_s;
  bool a_tick_later;  ///< what arrived has lain there since the tick before

  /// Puts what has come into what the site senses. A side of fewer joints, as a handle that leads a tool, states fewer
  /// numbers: those of the first joints.
  template <class Sensors>
  void hear(Sensors& sensors) const noexcept {
    const std::size_t said = std::min(joints_of(sensors), joints_of(heard.message));
    for (std::size_t joint = 0; joint < said; ++joint) {
      joint_of(sensors, joint).arrival = {.message = joint_of(heard.message, joint), .fresh = heard.fresh};
    }
  }
  void send(const Payload& message) noexcept { other_hears = out.step(message); }

  template <class Take>
  void receive(const Tick& tick, Take&& take) noexcept {
    if (!heard.fresh) return;
    Payload packet = heard.message;
    const std::int64_t lain_ticks = a_tick_later ? tick.missed + 1 : 0;
    packet.age_s = static_cast<double>(heard.sent_ticks_ago + lain_ticks) * tick_s;
    take(packet);
  }
  void send(const Payload& packet, const Tick&) noexcept { send(packet); }
};

/// Both sites of a teleoperator on one clock, of one axis or of several joints, with the channel between them: the same
/// in virtual and in real time.
///
/// The master steps, then the slave. What is sent to the slave with no channel delay arrives in the same tick, what is
/// sent to the master at the next.
template <class Master, class Slave>
class SitePair {
  static constexpr bool supervised = Supervised<Master>;
  using Messages = Each<typename Master::Sensors, control::Message>;
  using Payload = std::conditional_t<supervised, control::PacketOf<Messages>, Messages>;
  using Transport = ChannelOf<Payload>;

 public:
  using Params = Each<Messages, control::ControlParams>;
  using Lengths = Each<Messages, double>;  ///< in m
  struct Output {
    Step<Master> master;
    Step<Slave> slave;
  };
  /// Of supervised sites what the operator presses, at both; of others the share of the controllers' forces.
  using Request = typename Master::Request;

  /// With a slave that rests at `slave_start_m`. Errors name `control` and `channel`.
  static Result<SitePair> make(const Params& control, const LinkParams& channel, Seconds tick,
                               const Lengths& slave_start_m);
  /// Of sites that were made elsewhere, such as those whose controllers couple joints. The master takes the slave to
  /// rest there too. Errors name `channel`.
  static Result<SitePair> around(Master master, Slave slave, const LinkParams& channel, Seconds tick,
                                 const Lengths& slave_start_m);

  /// One tick. Real-time safe as far as the devices are.
  template <Drivable MasterDevice, Drivable SlaveDevice>
  Output step(MasterDevice& master, SlaveDevice& slave, const Tick& tick, const Request& request) noexcept {
    typename Transport::Delivery at_slave;
    TransportEnd<Payload> of_master{
        .heard = at_master_, .out = to_slave_, .other_hears = at_slave, .tick_s = tick_s_, .a_tick_later = true};
    TransportEnd<Payload> of_slave{
        .heard = at_slave, .out = to_master_, .other_hears = at_master_, .tick_s = tick_s_, .a_tick_later = false};
    // In this order, as the members of an output are made.
    return {.master = station::step(master_, master, of_master, tick, request),
            .slave = station::step(slave_, slave, of_slave, tick, request)};
  }

  /// Continues with the channels of `made`, which has not been stepped, and gives it the own ones; what is on its way
  /// is lost. Between ticks. Real-time safe.
  void exchange_channels(SitePair& made) noexcept requires(!supervised) {
    made.to_slave_.continue_from(to_slave_);
    made.to_master_.continue_from(to_master_);
    std::swap(to_slave_, made.to_slave_);
    std::swap(to_master_, made.to_master_);
  }
  /// Continues with the controllers of `made`, brought to rest at the latest tick (`Site::exchange_controller`); the
  /// gates stay. Between ticks; does not allocate, but takes as long as a thousand ticks.
  void exchange_controllers(SitePair& made) noexcept requires(!supervised) {
    constexpr int ticks_to_rest = 1000;
    master_.exchange_controller(made.master_, ticks_to_rest);
    slave_.exchange_controller(made.slave_, ticks_to_rest);
  }

  [[nodiscard]] const Master& master() const noexcept { return master_; }
  [[nodiscard]] const Slave& slave() const noexcept { return slave_; }
  /// What has come for the master, which it receives at its next tick.
  [[nodiscard]] const Payload& at_master() const noexcept { return at_master_.message; }
  /// Neither site commands a force.
  [[nodiscard]] bool at_rest() const noexcept {
    return !gated(master_).passes_a_force() && !gated(slave_).passes_a_force();
  }
  /// False once a safety gate has latched a fault.
  [[nodiscard]] bool healthy() const noexcept {
    return gated(master_).fault() == control::GateFault::none && gated(slave_).fault() == control::GateFault::none;
  }

 private:
  template <class Site>
  static const auto& gated(const Site& site) noexcept {
    if constexpr (supervised) {
      return site.site();
    } else {
      return site;
    }
  }

  SitePair(Master master, Slave slave, Transport to_slave, Transport to_master, Seconds tick, const Payload& nothing)
      : master_(std::move(master)),
        slave_(std::move(slave)),
        to_slave_(std::move(to_slave)),
        to_master_(std::move(to_master)),
        at_master_{.message = nothing},
        tick_s_(tick.value) {}

  Master master_;
  Slave slave_;
  Transport to_slave_;
  Transport to_master_;
  typename Transport::Delivery at_master_;  ///< for its next tick
  double tick_s_;
};

/// As sites run on a machine: armed by an operator, watched, held where anything is wrong.
using SupervisedPair = SitePair<control::SupervisedMaster, control::SupervisedSlave>;
/// As the papers have them: a controller and its gate, at work from the first tick on. For simulated devices.
using BarePair = SitePair<control::MasterSite, control::SlaveSite>;
/// Both of devices of several joints.
using JointSupervisedPair = SitePair<control::JointSupervisedMaster, control::JointSupervisedSlave>;
using JointBarePair = SitePair<control::JointMasterSite, control::JointSlaveSite>;

}  // namespace tactus::station
