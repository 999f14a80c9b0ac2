// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/step.hpp>
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/link/inbound.hpp>
#include <tactus/simulation/teleoperator/site_plants.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

/// Long runs: two supervised sites with their plants in virtual time, over the link's codec and its judgement of what
/// comes, each site with a clock of its own.
namespace tactus::soak {

/// Where counters stand when a run begins, as if both sites had run for long before.
struct Origin {
  std::int64_t master_clock_ns = 1'000'000'000;
  std::int64_t slave_clock_ns = 7'000'000'000;
  std::int64_t master_session = 1;
  std::int64_t slave_session = 2;
  std::int64_t sequence = 0;  ///< of the packet before the first, of both sites
  std::int64_t armings = 0;   ///< that the slave says it has followed, when the master is armed
  double energy_J = 0.0;      ///< told before the first packet, by both sites
};

/// A person who taps the wall three times in 3 s and then presses on it for 2 s, over and over: where the hand means to
/// be, at the tick within the period.
class TapsAndPress {
 public:
  TapsAndPress(double wall_m, double depth_m, double tick_s) : ticks_(std::lround(period_s / tick_s)) {
    for (std::int64_t tick = 0; tick < ticks_; ++tick) {
      const double time_s = static_cast<double>(tick) * tick_s, pressed_s = time_s - 3.0;
      const double cycles =
          pressed_s < 0.0 ? time_s : std::clamp(pressed_s, 0.0, 0.5) + std::clamp(pressed_s - 1.5, 0.0, 0.5);
      path_m_.push_back(wall_m - depth_m * std::cos(2.0 * std::numbers::pi * cycles));
    }
  }
  [[nodiscard]] std::int64_t ticks() const { return ticks_; }
  [[nodiscard]] double at(std::int64_t tick) const { return path_m_.at(static_cast<std::size_t>(tick % ticks_)); }

 private:
  static constexpr double period_s = 5.0;
  std::int64_t ticks_;
  std::vector<double> path_m_;
};

/// One end of the link as `link::Endpoint` is one, but that bytes go from hand to hand and the caller tells the time.
class End {
 public:
  End(control::SiteRole role, std::int64_t session, const Origin& origin)
      : role_(role), origin_(origin), inbound_(role, session) {}

  /// The packet in `bytes`, aged, where it counts.
  std::optional<control::Packet> receive(const link::DatagramBytes& bytes, std::int64_t now_ns) {
    link::Datagram datagram;
    if (link::decode(bytes, datagram) != link::Refusal::none) {
      ++malformed_;
      return std::nullopt;
    }
    if (inbound_.take(datagram, now_ns) != link::Inbound::Verdict::counted) return std::nullopt;
    return datagram.packet;
  }
  /// `agreement` is the sender's.
  link::DatagramBytes send(control::Packet packet, const control::Agreement& agreement, std::int64_t now_ns) {
    packet.sequence += origin_.sequence;
    packet.agreement = agreement.excerpt(packet.sequence);
    packet.message.energy_J += origin_.energy_J;
    const bool echoes = inbound_.echo_received_ns() != 0;
    return link::encode({.site = role_,
                         .packet = packet,
                         .peer_session = inbound_.answered_session(),
                         .sent_ns = now_ns,
                         .echo_sent_ns = inbound_.echo_sent_ns(),
                         .echo_hold_ns = echoes ? now_ns - inbound_.echo_received_ns() : 0});
  }
  [[nodiscard]] const link::Inbound& inbound() const { return inbound_; }
  [[nodiscard]] std::int64_t malformed() const { return malformed_; }

 private:
  control::SiteRole role_;
  Origin origin_;
  link::Inbound inbound_;
  std::int64_t malformed_ = 0;
};

/// Both sites, one tick at a time. The slave is stepped half a tick after the master, so each packet is half a tick old
/// when it is taken. The person aligns, arms and presses in the first 0.15 s.
class TwoSites {
 public:
  struct Seen {
    station::Step<control::SupervisedMaster> master;
    station::Step<control::SupervisedSlave> slave;
    double master_heard_age_s = 0.0;  ///< of the packet that came, 0 for none
    double slave_heard_age_s = 0.0;
  };

  static Result<TwoSites> make(const simulation::Teleoperator::Params& params, const Origin& origin) {
    const auto clock = simulation::Clock::make(params.servo, params.plant);
    if (!clock) return clock.error();
    const Seconds tick{clock->tick_s};
    const double scale = params.control.position_scale;
    TapsAndPress path(params.environment.position_m / scale, depth_m, clock->tick_s);
    auto master_plant = simulation::MasterPlant::make(params.master, params.person, *clock, path.at(0));
    if (!master_plant) return master_plant.error();
    auto slave_plant = simulation::SlavePlant::make(params.slave, params.environment, *clock, scale * path.at(0));
    if (!slave_plant) return slave_plant.error();
    auto master = control::make_supervised_master(params.control, origin.master_session, tick);
    if (!master) return under("control", master.error());
    auto slave = control::make_supervised_slave(params.control, origin.slave_session, tick);
    if (!slave) return under("control", slave.error());
    return TwoSites(origin, *clock, std::move(path), *master_plant, *slave_plant, *std::move(master),
                    *std::move(slave));
  }

  const Seen& step(std::int64_t elapsed_ticks = 1) {
    const double now_s = static_cast<double>(tick_) * clock_.tick_s;
    const auto within = [now_s](double begin_s) { return now_s >= begin_s && now_s < begin_s + 0.01; };
    const control::SiteRequests requests{.align = within(0.05), .arm = within(arm_s), .dead_man = now_s >= 0.15};
    const std::int64_t since_ns = tick_ * tick_ns();

    const station::Tick tick{.number = tick_, .missed = elapsed_ticks - 1};
    Transport<control::SupervisedMaster> of_master{*this,      master_,   master_end_,
                                                   to_master_, to_slave_, origin_.master_clock_ns + since_ns};
    seen_.master = station::step(master_, master_plant_, of_master, tick, requests);
    seen_.master_heard_age_s = of_master.heard_age_s;
    Transport<control::SupervisedSlave> of_slave{
        *this, slave_, slave_end_, to_slave_, to_master_, origin_.slave_clock_ns + since_ns + tick_ns() / 2};
    seen_.slave = station::step(slave_, slave_plant_, of_slave, tick, requests);
    seen_.slave_heard_age_s = of_slave.heard_age_s;

    master_plant_.begin_tick(path_.at(tick_), path_.at(tick_ + 1));
    slave_plant_.begin_tick();
    for (int i = 0; i < clock_.substeps; ++i) {
      master_plant_.substep(i);
      slave_plant_.substep(i);
    }
    ++tick_;
    return seen_;
  }

  [[nodiscard]] bool active() const {
    return master_.state() == control::SiteState::active && slave_.state() == control::SiteState::active;
  }
  [[nodiscard]] std::int64_t ticks() const { return tick_; }
  [[nodiscard]] double tick_s() const { return clock_.tick_s; }
  [[nodiscard]] std::int64_t tick_ns() const { return std::lround(clock_.tick_s * 1e9); }
  [[nodiscard]] std::int64_t period_ticks() const { return path_.ticks(); }
  [[nodiscard]] const End& master_end() const { return master_end_; }
  [[nodiscard]] const End& slave_end() const { return slave_end_; }

 private:
  static constexpr double arm_s = 0.1, depth_m = 0.008;

  TwoSites(const Origin& origin, const simulation::Clock& clock, TapsAndPress path,
           const simulation::MasterPlant& master_plant, const simulation::SlavePlant& slave_plant,
           control::SupervisedMaster master, control::SupervisedSlave slave)
      : origin_(origin),
        clock_(clock),
        path_(std::move(path)),
        master_plant_(master_plant),
        slave_plant_(slave_plant),
        master_(std::move(master)),
        slave_(std::move(slave)),
        master_end_(control::SiteRole::master, origin.master_session, origin),
        slave_end_(control::SiteRole::slave, origin.slave_session, origin) {}

  /// The way of a site over its end, with what lies at it and what it leaves for the other.
  template <class Site>
  struct Transport {
    const TwoSites& sites;
    const Site& site;
    End& end;
    std::optional<link::DatagramBytes>& inbox;
    std::optional<link::DatagramBytes>& outbox;
    std::int64_t now_ns;
    double heard_age_s = 0.0;
    template <class Take>
    void receive(const station::Tick&, Take&& take) {
      if (!inbox) return;
      auto packet = end.receive(*inbox, now_ns);
      if (!packet) return;
      heard_age_s = packet->age_s;
      const bool from_slave = std::is_same_v<Site, control::SupervisedMaster>;
      if (from_slave && sites.origin_.armings > 0 && site.state() == control::SiteState::align) {
        packet->armings = sites.origin_.armings;
      }
      take(*packet);
    }
    void send(const control::Packet& packet, const station::Tick&) {
      outbox = end.send(packet, site.agreement().own(), now_ns);
    }
  };

  Origin origin_;
  simulation::Clock clock_;
  TapsAndPress path_;
  simulation::MasterPlant master_plant_;
  simulation::SlavePlant slave_plant_;
  control::SupervisedMaster master_;
  control::SupervisedSlave slave_;
  End master_end_, slave_end_;
  std::optional<link::DatagramBytes> to_master_, to_slave_;
  Seen seen_;
  std::int64_t tick_ = 0;
};

}  // namespace tactus::soak
