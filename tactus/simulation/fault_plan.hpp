#pragma once

#include <tactus/core/parameters.hpp>
#include <tactus/signal/random.hpp>

#include <array>
#include <cstdint>

/// Faults on purpose: what fails, when, for how long. The same described values serve the simulated channel and sensors
/// and whatever stands between two real sites.
namespace tactus::simulation {

enum class FaultKind {
  none,
  loss_bursts,     ///< of packets, both ways
  disorder,        ///< delay, jitter that reorders, duplicates, both ways
  cut,             ///< no packet either way
  restart,         ///< a site's process is killed and started again
  bad_number,      ///< one input is no number, or a huge one, for one tick
  encoder_spike,   ///< one reading far off
  encoder_freeze,  ///< the reading stays
  encoder_wrap,    ///< the counter loses its highest bit
  force_dropout,   ///< the sensor at the tip reads nothing
  force_bias,      ///< it reads too much
  stall,           ///< a site is not stepped; its motor holds the last force
  delayed_wall     ///< delay both ways and a light grip, against the wall
};
constexpr auto enumerators(FaultKind) {
  return std::array{Enumerator{FaultKind::none, "none"},
                    Enumerator{FaultKind::loss_bursts, "loss-bursts"},
                    Enumerator{FaultKind::disorder, "disorder"},
                    Enumerator{FaultKind::cut, "cut"},
                    Enumerator{FaultKind::restart, "restart"},
                    Enumerator{FaultKind::bad_number, "bad-number"},
                    Enumerator{FaultKind::encoder_spike, "encoder-spike"},
                    Enumerator{FaultKind::encoder_freeze, "encoder-freeze"},
                    Enumerator{FaultKind::encoder_wrap, "encoder-wrap"},
                    Enumerator{FaultKind::force_dropout, "force-dropout"},
                    Enumerator{FaultKind::force_bias, "force-bias"},
                    Enumerator{FaultKind::stall, "stall"},
                    Enumerator{FaultKind::delayed_wall, "delayed-wall"}};
}

enum class FaultSite { master, slave };
constexpr auto enumerators(FaultSite) {
  return std::array{Enumerator{FaultSite::master, "master"}, Enumerator{FaultSite::slave, "slave"}};
}

/// How a network treats packets. Losses come in bursts (E. N. Gilbert, Bell System Technical Journal 39, 1960; E. O.
/// Elliott, ibid. 42, 1963): a chain of two states, one that loses nothing and one that loses a share.
struct Impairment {
  double delay_s = 0.0;
  double jitter_s = 0.0;
  double duplicate_fraction = 0.0;
  double burst_begins_fraction = 0.0;
  double burst_ends_fraction = 1.0;
  double burst_loss_fraction = 1.0;
  static constexpr auto fields() {
    return std::tuple{
        field("delay_s", &Impairment::delay_s, units::second, between(0.0, 1.0), "Shortest delay of a packet."),
        field("jitter_s", &Impairment::jitter_s, units::second, between(0.0, 1.0),
              "Longest delay on top of it, drawn evenly for every packet, so that packets overtake one another."),
        field("duplicate_fraction", &Impairment::duplicate_fraction, units::none, between(0.0, 1.0),
              "Share of the packets that come twice."),
        field("burst_begins_fraction", &Impairment::burst_begins_fraction, units::none, between(0.0, 1.0),
              "Chance at each packet that a burst of losses begins."),
        field("burst_ends_fraction", &Impairment::burst_ends_fraction, units::none, between(0.0, 1.0),
              "Chance at each packet that a burst ends."),
        field("burst_loss_fraction", &Impairment::burst_loss_fraction, units::none, between(0.0, 1.0),
              "Share of the packets that are lost in a burst.")};
  }
};

/// What becomes of one packet: how many copies arrive, each after its delay.
struct PacketFate {
  int copies = 1;
  std::array<double, 2> delay_s{};
};

/// Draws the fate of each packet in turn. A value: no clock, socket or allocation. Real-time safe.
class ImpairedLink {
 public:
  ImpairedLink(const Impairment& impairment, signal::Random random) noexcept
      : impairment_(impairment), random_(random) {}

  PacketFate next() noexcept {
    const double turn = random_.uniform();
    bursting_ = bursting_ ? turn >= impairment_.burst_ends_fraction : turn < impairment_.burst_begins_fraction;
    PacketFate fate;
    if (bursting_ && random_.uniform() < impairment_.burst_loss_fraction) fate.copies = 0;
    if (fate.copies > 0 && random_.uniform() < impairment_.duplicate_fraction) fate.copies = 2;
    for (double& delay_s : fate.delay_s) delay_s = impairment_.delay_s + impairment_.jitter_s * random_.uniform();
    return fate;
  }

 private:
  Impairment impairment_;
  signal::Random random_;
  bool bursting_ = false;
};

/// One fault of one run.
struct FaultPlan {
  FaultKind kind = FaultKind::none;
  FaultSite site = FaultSite::master;
  double start_s = 0.8;
  double length_s = 0.0;
  double size = 0.0;
  std::int64_t choice = 0;
  std::int64_t seed = 1;
  Impairment impairment{};
  static constexpr auto fields() {
    return std::tuple{
        field("kind", &FaultPlan::kind, "What fails."),
        field("site", &FaultPlan::site, "Where, if at one site."),
        field("start_s", &FaultPlan::start_s, units::second, non_negative, "When it begins."),
        field("length_s", &FaultPlan::length_s, units::second, non_negative, "How long it lasts."),
        field("size", &FaultPlan::size, units::none, any_finite,
              "How far an encoder spikes or wraps in m, how much a force sensor is off in N."),
        field("choice", &FaultPlan::choice, non_negative, "Which input, value and state a bad number takes."),
        field("seed", &FaultPlan::seed, non_negative, "Of the packets' fates and the person's path."),
        field("impairment", &FaultPlan::impairment, "How the network treats packets while the fault lasts.")};
  }
};

/// The plan number `index` of a kind: equal arguments, equal plan. Lengths are drawn evenly in their logarithm, a cut's
/// from 10 ms to `longest_cut_s`, a stall's from 1 to 100 ms.
FaultPlan draw_plan(FaultKind kind, std::int64_t index, std::int64_t seed, double longest_cut_s);

}  // namespace tactus::simulation
