// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_record.hpp>

namespace tactus::runtime {

namespace {

constexpr std::uint64_t low_half = 0xffff'ffff;
std::int64_t high_of(std::uint64_t bits) noexcept { return static_cast<std::int64_t>(bits >> 32); }
std::int64_t low_of(std::uint64_t bits) noexcept { return static_cast<std::int64_t>(bits & low_half); }
std::uint64_t bits_of(std::int64_t high, std::int64_t low) noexcept {
  return static_cast<std::uint64_t>(high) << 32 | static_cast<std::uint64_t>(low);
}

template <class Payload>
PacketHeadRecord head_of(const station::Tick& tick, const control::PacketOf<Payload>& packet) noexcept {
  return {.tick = tick.number,
          .session = packet.session,
          .sequence = packet.sequence,
          .age_s = packet.age_s,
          .state = static_cast<std::int64_t>(packet.state),
          .armings = packet.armings,
          .digest_high = high_of(packet.agreement.digest),
          .digest_low = low_of(packet.agreement.digest),
          .cell = static_cast<std::int64_t>(packet.agreement.cell),
          .value_high = high_of(packet.agreement.value),
          .value_low = low_of(packet.agreement.value)};
}

/// Each with the bit that stands for it, in the order of the bits.
constexpr bool control::SiteRequests::*buttons[]{&control::SiteRequests::align,  &control::SiteRequests::arm,
                                                 &control::SiteRequests::clear,  &control::SiteRequests::dead_man,
                                                 &control::SiteRequests::clutch, &control::SiteRequests::emergency_stop,
                                                 &control::SiteRequests::leave,  &control::SiteRequests::tare};

template <class Supervised>
SiteTickRecord of_site(const station::Tick& tick, const control::SiteRequests& pressed, const Supervised& site,
                       const station::Step<Supervised>& done) noexcept {
  SiteTickRecord record{done.output.record};
  record.tick = tick.number;
  record.missed = tick.missed;
  record.health = static_cast<std::int64_t>(done.health);
  record.age_s = site.heard().age_s;
  record.pressed = number_of(pressed);
  record.asked_force_gain = pressed.force_gain;
  record.sent_sequence = done.output.packet.sequence;
  return record;
}

/// What one axis read and gave, into `record`, which has what is common to both kinds of log.
template <class Record, class Output>
void fill(Record& record, const station::DeviceReading& reading, const Output& output, const control::Message& heard,
          const control::Message& told) noexcept {
  record.position_m = reading.position_m;
  record.read_force_N = reading.force_N;
  record.motor_force_N = output.motor_force_N;
  if constexpr (requires { output.handle_force_N; }) {
    record.grip = reading.grip;
    record.handle_force_N = output.handle_force_N;
    record.induced_position_m = output.induced_position_m;
    record.intended_position_m = output.intended_position_m;
    static_cast<control::HandEstimate&>(record) = output.hand;
  }
  static_cast<control::Message&>(static_cast<typename Record::Received&>(record)) = heard;
  static_cast<control::Message&>(static_cast<typename Record::Sent&>(record)) = told;
}

template <class Supervised>
SiteLogRecord of_one_axis(const station::Tick& tick, const control::SiteRequests& pressed, const Supervised& site,
                          const station::Step<Supervised>& done) noexcept {
  SiteLogRecord record{of_site(tick, pressed, site, done), {}, {}, {}};
  fill(record, done.reading, done.output.site, site.heard().message, done.output.packet.message);
  return record;
}

/// One joint of a site of several.
template <class Output>
JointLogRecord of_joint(const station::Tick& tick, const control::SafetyGate& gate,
                        const station::DeviceReading& reading, const Output& output, const control::Message& heard,
                        const control::Message& told) noexcept {
  JointLogRecord record;
  record.tick = tick.number;
  record.limit = static_cast<std::int64_t>(gate.limit());
  record.fault = static_cast<std::int64_t>(gate.fault());
  record.given_J = gate.given_J();
  record.position_age_s = reading.age_s;
  record.drive_velocity_m_per_s = reading.motor_report.velocity_m_per_s;
  record.drive_force_N = reading.motor_report.force_N;
  record.drive_stiffness_N_per_m = output.law.stiffness_N_per_m;
  record.drive_damping_N_s_per_m = output.law.damping_N_s_per_m;
  record.law_position_m = output.law.position_m;
  record.law_velocity_m_per_s = output.law.velocity_m_per_s;
  fill(record, reading, output, heard, told);
  return record;
}

}  // namespace

PacketRecord recorded(const station::Tick& tick, const control::Packet& packet) noexcept {
  return {head_of(tick, packet), packet.message};
}

PacketHeadRecord recorded(const station::Tick& tick, const control::JointPacket& packet) noexcept {
  return head_of(tick, packet);
}

template <class Payload>
control::PacketOf<Payload> packet_of(const PacketHeadRecord& head, const Payload& message) noexcept {
  return {.session = head.session,
          .sequence = head.sequence,
          .age_s = head.age_s,
          .state = static_cast<control::SiteState>(head.state),
          .armings = head.armings,
          .message = message,
          .agreement = {.digest = bits_of(head.digest_high, head.digest_low),
                        .cell = static_cast<std::uint64_t>(head.cell),
                        .value = bits_of(head.value_high, head.value_low)}};
}
template control::Packet packet_of(const PacketHeadRecord&, const control::Message&) noexcept;
template control::JointPacket packet_of(const PacketHeadRecord&, const Joints<control::Message>&) noexcept;

std::int64_t number_of(const control::SiteRequests& pressed) noexcept {
  std::int64_t number = 0, bit = 1;
  for (const auto button : buttons) {
    number += pressed.*button ? bit : 0;
    bit *= 2;
  }
  return number;
}

control::SiteRequests requests_of(const SiteTickRecord& record) noexcept {
  control::SiteRequests requests{.force_gain = record.asked_force_gain};
  std::int64_t bit = 1;
  for (const auto button : buttons) {
    requests.*button = (record.pressed & bit) != 0;
    bit *= 2;
  }
  return requests;
}

SiteLogRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed,
                       const control::SupervisedMaster& site,
                       const station::Step<control::SupervisedMaster>& done) noexcept {
  return of_one_axis(tick, pressed, site, done);
}

SiteLogRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed,
                       const control::SupervisedSlave& site,
                       const station::Step<control::SupervisedSlave>& done) noexcept {
  return of_one_axis(tick, pressed, site, done);
}

template <class Site>
SiteTickRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed, const Site& site,
                        const station::Step<Site>& done) noexcept {
  return of_site(tick, pressed, site, done);
}

template <class Site>
JointLogRecord recorded(const station::Tick& tick, std::size_t joint, const Site& site,
                        const station::Step<Site>& done) noexcept {
  return of_joint(tick, site.site().gates()[joint].motor(), done.reading[joint], done.output.site[joint],
                  site.heard().message[joint], done.output.packet.message[joint]);
}

template <class Site>
SiteTickRecord recorded_bare(const station::Tick& tick, const Site& site, const station::Step<Site>& done) noexcept {
  SiteTickRecord record;
  record.state = static_cast<std::int64_t>(control::SiteState::active);
  for (const auto& gates : site.gates()) {
    if (record.limit == 0) record.limit = static_cast<std::int64_t>(gates.motor().limit());
    if (record.fault == 0) record.fault = static_cast<std::int64_t>(gates.motor().fault());
    record.given_J += gates.motor().given_J();
  }
  record.enabled = true;
  record.fresh = true;
  record.share = 1.0;
  record.tick = tick.number;
  record.missed = tick.missed;
  record.health = static_cast<std::int64_t>(done.health);
  return record;
}

template <class Site>
JointLogRecord recorded_bare(const station::Tick& tick, std::size_t joint, const Site& site,
                             const station::Step<Site>& done, const control::Message& heard) noexcept {
  return of_joint(tick, site.gates()[joint].motor(), done.reading[joint], done.output[joint], heard,
                  done.output[joint].message);
}

using Master = control::JointSupervisedMaster;
using Slave = control::JointSupervisedSlave;
template SiteTickRecord recorded(const station::Tick&, const control::SiteRequests&, const Master&,
                                 const station::Step<Master>&) noexcept;
template SiteTickRecord recorded(const station::Tick&, const control::SiteRequests&, const Slave&,
                                 const station::Step<Slave>&) noexcept;
template JointLogRecord recorded(const station::Tick&, std::size_t, const Master&,
                                 const station::Step<Master>&) noexcept;
template JointLogRecord recorded(const station::Tick&, std::size_t, const Slave&, const station::Step<Slave>&) noexcept;

using BareMaster = control::JointMasterSite;
using BareSlave = control::JointSlaveSite;
template SiteTickRecord recorded_bare(const station::Tick&, const BareMaster&,
                                      const station::Step<BareMaster>&) noexcept;
template SiteTickRecord recorded_bare(const station::Tick&, const BareSlave&, const station::Step<BareSlave>&) noexcept;
template JointLogRecord recorded_bare(const station::Tick&, std::size_t, const BareMaster&,
                                      const station::Step<BareMaster>&, const control::Message&) noexcept;
template JointLogRecord recorded_bare(const station::Tick&, std::size_t, const BareSlave&,
                                      const station::Step<BareSlave>&, const control::Message&) noexcept;

}  // namespace tactus::runtime
