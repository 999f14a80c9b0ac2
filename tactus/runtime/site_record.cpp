#include <tactus/runtime/site_record.hpp>

namespace tactus::runtime {

namespace {

constexpr std::uint64_t low_half = 0xffff'ffff;
std::int64_t high_of(std::uint64_t bits) noexcept { return static_cast<std::int64_t>(bits >> 32); }
std::int64_t low_of(std::uint64_t bits) noexcept { return static_cast<std::int64_t>(bits & low_half); }
std::uint64_t bits_of(std::int64_t high, std::int64_t low) noexcept {
  return static_cast<std::uint64_t>(high) << 32 | static_cast<std::uint64_t>(low);
}

/// Each with the bit that stands for it, in the order of the bits.
constexpr bool control::SiteRequests::*buttons[]{&control::SiteRequests::align,  &control::SiteRequests::arm,
                                                 &control::SiteRequests::clear,  &control::SiteRequests::dead_man,
                                                 &control::SiteRequests::clutch, &control::SiteRequests::emergency_stop,
                                                 &control::SiteRequests::leave};

template <class Supervised>
SiteLogRecord either(const station::Tick& tick, const control::SiteRequests& pressed, const Supervised& site,
                     const station::Step<Supervised>& done) noexcept {
  SiteLogRecord record{done.output.record};
  record.tick = tick.number;
  record.missed = tick.missed;
  record.position_m = done.reading.position_m;
  record.read_force_N = done.reading.force_N;
  record.motor_force_N = done.output.site.motor_force_N;
  record.pressed = number_of(pressed);
  const control::Packet& heard = site.heard();
  record.age_s = heard.age_s;
  record.heard_position_m = heard.message.position_m;
  record.heard_velocity_m_per_s = heard.message.velocity_m_per_s;
  record.heard_force_N = heard.message.force_N;
  record.heard_wave = heard.message.wave;
  record.heard_energy_J = heard.message.energy_J;
  const control::Packet& told = done.output.packet;
  record.told_sequence = told.sequence;
  record.told_position_m = told.message.position_m;
  record.told_velocity_m_per_s = told.message.velocity_m_per_s;
  record.told_force_N = told.message.force_N;
  record.told_wave = told.message.wave;
  record.told_energy_J = told.message.energy_J;
  return record;
}

}  // namespace

control::Message SiteLogRecord::told() const noexcept {
  return {.position_m = told_position_m,
          .velocity_m_per_s = told_velocity_m_per_s,
          .force_N = told_force_N,
          .wave = told_wave,
          .energy_J = told_energy_J};
}

control::Packet PacketRecord::packet() const noexcept {
  return {.session = session,
          .sequence = sequence,
          .age_s = age_s,
          .state = static_cast<control::SiteState>(state),
          .armings = armings,
          .message = *this,
          .agreement = {.digest = bits_of(digest_high, digest_low),
                        .cell = static_cast<std::uint64_t>(cell),
                        .value = bits_of(value_high, value_low)}};
}

PacketRecord recorded(const station::Tick& tick, const control::Packet& packet) noexcept {
  PacketRecord record{packet.message};
  record.tick = tick.number;
  record.session = packet.session;
  record.sequence = packet.sequence;
  record.age_s = packet.age_s;
  record.state = static_cast<std::int64_t>(packet.state);
  record.armings = packet.armings;
  record.digest_high = high_of(packet.agreement.digest);
  record.digest_low = low_of(packet.agreement.digest);
  record.cell = static_cast<std::int64_t>(packet.agreement.cell);
  record.value_high = high_of(packet.agreement.value);
  record.value_low = low_of(packet.agreement.value);
  return record;
}

std::int64_t number_of(const control::SiteRequests& pressed) noexcept {
  std::int64_t number = 0, bit = 1;
  for (const auto button : buttons) {
    number += pressed.*button ? bit : 0;
    bit *= 2;
  }
  return number;
}

control::SiteRequests requests_of(std::int64_t pressed) noexcept {
  control::SiteRequests requests;
  std::int64_t bit = 1;
  for (const auto button : buttons) {
    requests.*button = (pressed & bit) != 0;
    bit *= 2;
  }
  return requests;
}

SiteLogRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed,
                       const control::SupervisedMaster& site,
                       const station::Step<control::SupervisedMaster>& done) noexcept {
  SiteLogRecord record = either(tick, pressed, site, done);
  record.grip = done.reading.grip;
  record.handle_force_N = done.output.site.handle_force_N;
  record.induced_position_m = done.output.site.induced_position_m;
  record.intended_position_m = done.output.site.intended_position_m;
  return record;
}

SiteLogRecord recorded(const station::Tick& tick, const control::SiteRequests& pressed,
                       const control::SupervisedSlave& site,
                       const station::Step<control::SupervisedSlave>& done) noexcept {
  return either(tick, pressed, site, done);
}

}  // namespace tactus::runtime
