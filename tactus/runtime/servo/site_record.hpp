// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/core/signals.hpp>
#include <tactus/kernel/station/step.hpp>
#include <tactus/runtime/servo/site_buttons.hpp>

#include <cstddef>
#include <cstdint>

/// What a site under supervision leaves of each tick: with the configuration, enough to step it again.
namespace tactus::runtime {

inline constexpr control::Legend health_legend = control::legend<station::DeviceHealth>("Of the device: ");

/// One tick of a site, with all its joints: what supervision and the link show of it.
struct SiteTickRecord : control::SiteRecord {
  std::int64_t tick = 0;
  std::int64_t missed = 0;
  std::int64_t health = 0;
  double age_s = 0.0;
  double round_trip_s = 0.0;
  double link_silence_s = 0.0;
  std::int64_t pressed = 0;
  double asked_force_gain = -1.0;
  std::int64_t arrivals = 0;
  std::int64_t sent_sequence = 0;
  static constexpr auto signals() {
    using R = SiteTickRecord;
    return joined(
        control::SiteRecord::signals(),
        List{
            observed("tick", &R::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
            observed("missed", &R::missed, units::none, "", "", "", "Deadlines missed right before this one."),
            observed("health", &R::health, units::none, "", "", "", health_legend.text),
            observed("age_s", &R::age_s, units::second, "", "", "", "Of the packet that was applied last, on arrival."),
            observed("round_trip_s", &R::round_trip_s, units::second, "", "", "", "Of the latest echo."),
            observed("link_silence_s", &R::link_silence_s, units::second, "", "", "",
                     "Since any packet of the other site arrived, applied or not; 0 before the first."),
            observed("pressed", &R::pressed, units::none, "", "", "",
                     "By the operator, added up: 1 align, 2 arm, 4 clear, 8 dead-man switch, 16 clutch, 32 emergency "
                     "stop, 64 leave, 128 tare."),
            observed("asked_force_gain", &R::asked_force_gain, units::none, "master", "hand", "",
                     "By the operator, a page or a node, latest; -1 before that."),
            observed("arrivals", &R::arrivals, units::none, "", "", "",
                     "Packets that arrived over the link in this control cycle, each a record of the topic /packets."),
            observed("sent_sequence", &R::sent_sequence, units::none, "", "", "", "Of the packet that was sent.")});
  }
};

/// One tick of one axis, or of one joint of several: what was read, and what was given. Positions and forces are
/// positive toward the environment unless stated otherwise.
struct AxisRecord : control::HandEstimate {
  double position_m = 0.0;
  double read_force_N = 0.0;
  double grip = 0.0;
  double motor_force_N = 0.0;
  double handle_force_N = 0.0;
  double induced_position_m = 0.0;
  double intended_position_m = 0.0;
  static constexpr auto signals() {
    using R = AxisRecord;
    return joined(
        List{observed("position_m", &R::position_m, units::metre, "", "", "toward the environment",
                      "Read at the motor."),
             observed(
                 "read_force_N", &R::read_force_N, units::newton, "", "", "",
                 "Master: read on the handle, toward the environment. Slave: read at the tip, which is pushed back."),
             observed("grip", &R::grip, units::none, "master", "", "",
                      "Read: how firmly the operator holds, over nominal."),
             observed("motor_force_N", &R::motor_force_N, units::newton, "", "", "toward the environment",
                      "Commanded to the motor."),
             observed("handle_force_N", &R::handle_force_N, units::newton, "master", "hand", "toward the environment",
                      "Commanded to the actuator on the handle."),
             observed("induced_position_m", &R::induced_position_m, units::metre, "master", "hand",
                      "toward the environment", "Estimated effect of the displayed force."),
             observed("intended_position_m", &R::intended_position_m, units::metre, "master", "hand",
                      "toward the environment", "Measured less induced.")},
        control::HandEstimate::signals());
  }
};

/// One tick of a site of one axis.
struct SiteLogRecord : SiteTickRecord,
                       AxisRecord,
                       Part<control::Message, "received_">,
                       Part<control::Message, "sent_"> {
  using Received = Part<control::Message, "received_">;  ///< the message that was applied last
  using Sent = Part<control::Message, "sent_">;          ///< to the other site
  using AxisRecord::position_m;
  static constexpr auto signals() {
    return joined(SiteTickRecord::signals(), AxisRecord::signals(), Received::signals(), Sent::signals());
  }
};

/// One tick of one joint of a site of several, in the joint's unit: where a name states m and N, one that turns has
/// rad and N m. What all joints share is in the `SiteTickRecord` of the tick.
struct JointLogRecord : AxisRecord, Part<control::Message, "received_">, Part<control::Message, "sent_"> {
  using Received = Part<control::Message, "received_">;
  using Sent = Part<control::Message, "sent_">;
  using AxisRecord::position_m;
  std::int64_t tick = 0;
  std::int64_t limit = 0;
  std::int64_t fault = 0;
  double given_J = 0.0;
  double position_age_s = 0.0;
  double drive_velocity_m_per_s = 0.0;
  double drive_force_N = 0.0;
  double drive_stiffness_N_per_m = 0.0;
  double drive_damping_N_s_per_m = 0.0;
  double law_position_m = 0.0;
  double law_velocity_m_per_s = 0.0;
  static constexpr auto signals() {
    using R = JointLogRecord;
    return joined(
        List{observed("tick", &R::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
             observed("limit", &R::limit, units::none, "", "", "", control::limit_legend.text),
             observed("fault", &R::fault, units::none, "", "", "", control::fault_legend.text),
             observed("given_J", &R::given_J, units::joule, "", "", "the motor gave it",
                      "Account of the passivity monitor."),
             observed("position_age_s", &R::position_age_s, units::second, "", "", "",
                      "Of the position at the deadline; negative where it was measured after that."),
             observed("drive_velocity_m_per_s", &R::drive_velocity_m_per_s, units::metre_per_second, "", "",
                      "toward the environment", "As the drive reports it, measured with the position."),
             observed("drive_force_N", &R::drive_force_N, units::newton, "", "", "toward the environment",
                      "Of the motor, as the drive reports it, measured with the position; 0 if it reports none."),
             observed("drive_stiffness_N_per_m", &R::drive_stiffness_N_per_m, units::newton_per_metre, "", "", "",
                      "Commanded: of the law that the drive runs by itself."),
             observed("drive_damping_N_s_per_m", &R::drive_damping_N_s_per_m, units::newton_second_per_metre, "", "",
                      "", "Commanded: of that law."),
             observed("law_position_m", &R::law_position_m, units::metre, "", "", "toward the environment",
                      "Commanded: to which that law pulls."),
             observed("law_velocity_m_per_s", &R::law_velocity_m_per_s, units::metre_per_second, "", "",
                      "toward the environment", "Commanded: the same.")},
        AxisRecord::signals(), Received::signals(), Sent::signals());
  }
};

inline constexpr control::Legend mark_legend = control::legend<EpisodeMark>("By the operator: ");

/// What the operator marked, on the topic `/episodes`.
struct EpisodeMarkRecord {
  std::int64_t tick = 0;
  std::int64_t mark = 0;
  static constexpr auto signals() {
    using R = EpisodeMarkRecord;
    return List{observed("tick", &R::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
                observed("mark", &R::mark, units::none, "", "", "", mark_legend.text)};
  }
};

inline constexpr control::Legend word_legend = control::legend<SiteWord>("The request: ");
inline constexpr control::Legend source_legend = control::legend<RequestSource>("Who asked: ");

/// What was asked of running sites, on the topic `/requests`.
struct SiteRequestRecord {
  std::int64_t tick = 0;
  std::int64_t word = 0;
  double value = 0.0;
  std::int64_t source = 0;
  static constexpr auto signals() {
    using R = SiteRequestRecord;
    return List{observed("tick", &R::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
                observed("word", &R::word, units::none, "", "", "", word_legend.text),
                observed("value", &R::value, units::none, "", "", "", "With set: the force gain; else 0."),
                observed("source", &R::source, units::none, "", "", "", source_legend.text)};
  }
};
/// Real-time safe.
inline SiteRequestRecord recorded(const station::Tick& tick, const SiteCommand& asked) noexcept {
  return {.tick = tick.number,
          .word = static_cast<std::int64_t>(asked.word),
          .value = asked.value,
          .source = static_cast<std::int64_t>(asked.source)};
}

inline constexpr control::Legend role_legend = control::legend<control::SiteRole>("Of the arm of the: ");

/// What a tare found at one joint, on the topic `/tares`: a record for each joint of the arm at the tick at which all
/// of it acts.
struct TareRecord {
  std::int64_t tick = 0;
  std::int64_t site = 0;
  std::int64_t joint = 0;
  double lacking_Nm = 0.0;
  static constexpr auto signals() {
    using R = TareRecord;
    return List{observed("tick", &R::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
                observed("site", &R::site, units::none, "", "", "", role_legend.text),
                observed("joint", &R::joint, units::none, "", "", "", "From 1."),
                observed("lacking_Nm", &R::lacking_Nm, Unit{"N m", "_Nm"}, "", "", "",
                         "Added to the joint's gravity compensation.")};
  }
};

/// A packet that came over the link, as the supervision of the site was handed it, but for its message.
struct PacketHeadRecord {
  std::int64_t tick = 0;
  std::int64_t session = 0;
  std::int64_t sequence = 0;
  double age_s = 0.0;
  std::int64_t state = 0;
  std::int64_t armings = 0;
  std::int64_t digest_high = 0;
  std::int64_t digest_low = 0;
  std::int64_t cell = 0;
  std::int64_t value_high = 0;
  std::int64_t value_low = 0;

  static constexpr auto signals() {
    using R = PacketHeadRecord;
    return List{observed("tick", &R::tick, units::none, "", "", "", "At which it came."),
                observed("session", &R::session, units::none, "", "", "", "Of the other site."),
                observed("sequence", &R::sequence, units::none, "", "", "", "Its number in that session."),
                observed("age_s", &R::age_s, units::second, "", "", "", "On arrival, as well as is known."),
                observed("state", &R::state, units::none, "", "", "", control::state_legend.text),
                observed("armings", &R::armings, units::none, "", "", "", "The arming that is followed there."),
                observed("digest_high", &R::digest_high, units::none, "", "", "",
                         "Upper 32 bits of the digest of what both sites must have in common."),
                observed("digest_low", &R::digest_low, units::none, "", "", "", "Its lower 32 bits."),
                observed("cell", &R::cell, units::none, "", "", "", "Number of the cell of it that is sent."),
                observed("value_high", &R::value_high, units::none, "", "", "", "Upper 32 bits of that cell."),
                observed("value_low", &R::value_low, units::none, "", "", "", "Its lower 32 bits.")};
  }
};

/// A packet of one axis.
struct PacketRecord : PacketHeadRecord, control::Message {
  static constexpr auto signals() { return joined(PacketHeadRecord::signals(), control::Message::signals()); }
};

/// The part of a packet that belongs to one joint of several. What all joints share is in the `PacketHeadRecord`.
struct PacketJointRecord : control::Message {
  std::int64_t tick = 0;
  static constexpr auto signals() {
    return joined(List{observed("tick", &PacketJointRecord::tick, units::none, "", "", "", "At which it came.")},
                  control::Message::signals());
  }
};

/// The record of a packet that came at this tick. Real-time safe, as is all below.
PacketRecord recorded(const station::Tick& tick, const control::Packet& packet) noexcept;
/// Of several joints what they share.
PacketHeadRecord recorded(const station::Tick& tick, const control::JointPacket& packet) noexcept;
/// The packet again.
template <class Payload>
control::PacketOf<Payload> packet_of(const PacketHeadRecord& head, const Payload& message) noexcept;

/// What was pressed, as a number of `SiteLogRecord`, and back.
std::int64_t number_of(const control::SiteRequests& pressed) noexcept;
/// What was asked of a site at the tick of this record.
control::SiteRequests requests_of(const SiteTickRecord& record) noexcept;

/// The record of a step of a site; what only the link knows is left at 0.
SiteLogRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed,
                       const control::SupervisedMaster& site,
                       const station::Step<control::SupervisedMaster>& done) noexcept;
SiteLogRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed,
                       const control::SupervisedSlave& site,
                       const station::Step<control::SupervisedSlave>& done) noexcept;

/// The same of a site of several joints: what they share, and one of them, from 0. `Site` is `JointSupervisedMaster` or
/// `JointSupervisedSlave`.
template <class Site>
SiteTickRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed, const Site& site,
                        const station::Step<Site>& done) noexcept;
template <class Site>
JointLogRecord recorded(const station::Tick& tick, std::size_t joint, const Site& site,
                        const station::Step<Site>& done) noexcept;

/// The same of sites without supervision, `JointMasterSite` or `JointSlaveSite`, which are active from the first tick
/// on: `heard` is what they received from the other site.
template <class Site>
SiteTickRecord recorded_bare(const station::Tick& tick, const Site& site, const station::Step<Site>& done) noexcept;
template <class Site>
JointLogRecord recorded_bare(const station::Tick& tick, std::size_t joint, const Site& site,
                             const station::Step<Site>& done, const control::Message& heard) noexcept;

}  // namespace tactus::runtime
