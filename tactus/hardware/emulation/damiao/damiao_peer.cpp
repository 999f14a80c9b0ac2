// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

namespace tactus::emulation::damiao {

namespace {

constexpr int adapter_sender = -1;
constexpr std::size_t most_waiting = 256;
constexpr double soonest_answer_ns = 60e3, latest_answer_ns = 250e3;
constexpr std::int64_t heartbeat_every_ns = 10'000'000, piece_ns = 100'000;

/// The status that a fault shows; 0 where it shows none.
std::uint8_t status_of(FaultKind kind) noexcept {
  const auto first = static_cast<std::int64_t>(FaultKind::over_voltage), at = static_cast<std::int64_t>(kind) - first;
  return at >= 0 && kind <= FaultKind::overload ? static_cast<std::uint8_t>(8 + at) : std::uint8_t{0};
}

}  // namespace

std::int64_t frame_ns(const Frame& frame, bool flexible) noexcept {
  constexpr std::int64_t bit_ns = 1000, flexible_ns = 66'000, after_the_checksum = 13;
  if (flexible) return flexible_ns;
  // Start, identifier, three bits for a standard frame of data, length, data; then the checksum.
  std::array<bool, 98> bits{};
  std::size_t count = 1;
  const auto add = [&bits, &count](std::uint32_t value, int width) {
    while (width-- > 0) bits[count++] = (value >> width & 1) != 0;
  };
  add(frame.id, 11);
  add(0, 3);
  add(8, 4);
  for (const std::uint8_t byte : frame.bytes) add(byte, 8);
  std::uint32_t checksum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool turns = bits[i] != ((checksum >> 14 & 1) != 0);
    checksum = (checksum << 1 & 0x7fff) ^ (turns ? 0x4599U : 0U);
  }
  add(checksum, 15);
  // After five equal bits one of the other kind, which counts for the next five.
  std::int64_t stuffed = 0;
  int equal = 1;
  bool last = bits[0];
  for (std::size_t i = 1; i < bits.size(); ++i) {
    equal = bits[i] == last ? equal + 1 : 1;
    last = bits[i];
    if (equal == 5) {
      ++stuffed;
      last = !last;
      equal = 1;
    }
  }
  return bit_ns * (static_cast<std::int64_t>(bits.size()) + stuffed + after_the_checksum);
}

Result<std::unique_ptr<DamiaoPeer>> DamiaoPeer::make(const PeerSettings& settings,
                                                     std::unique_ptr<Mechanism> mechanism) {
  constexpr Bounds counts = between(1.0, 15.0);
  const auto count = static_cast<double>(settings.motors.size());
  if (!counts.contain(count)) return out_of_bounds("motors", count, counts, units::none);
  if (mechanism && mechanism->motors() > settings.motors.size()) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "motors",
                 .message = std::to_string(settings.motors.size()) + " motors for an arm of " +
                            std::to_string(mechanism->motors()) + " joints: each joint has one",
                 .place = {}};
  }
  return std::unique_ptr<DamiaoPeer>(new DamiaoPeer(settings, std::move(mechanism)));
}

DamiaoPeer::DamiaoPeer(const PeerSettings& settings, std::unique_ptr<Mechanism> mechanism)
    : settings_(settings),
      adapter_(settings.adapter),
      random_(settings.seed),
      mechanism_(std::move(mechanism)),
      given_Nm_(mechanism_ ? mechanism_->motors() : 0),
      outbox_(1 << 14) {
  waiting_.reserve(most_waiting);
  for (MotorSettings motor : settings.motors) {
    const bool wraps = std::any_of(settings.faults.begin(), settings.faults.end(), [&motor](const Fault& fault) {
      return fault.kind == FaultKind::wrap && fault.concerns(motor.id);
    });
    if (wraps)
      motor.joint = {.inertia_kgm2 = 0.02,
                     .damping_Nms_per_rad = 0.0,
                     .friction_Nm = 0.0,
                     .position_rad = 12.0,
                     .velocity_rad_per_s = 5.0};
    motors_.emplace_back(motor);
    for (const Fault& fault : settings.faults) {
      if (fault.kind == FaultKind::wrong_scale && fault.concerns(motor.id)) motors_.back().scale_velocity(1.5);
    }
  }
  for (std::size_t i = 0; i < given_Nm_.size(); ++i) {
    motors_[i].turn_with_others();
    motors_[i].turn_to(mechanism_->position_rad(i), mechanism_->velocity_rad_per_s(i));
  }
}

bool DamiaoPeer::suffers(FaultKind kind, std::uint32_t motor, std::int64_t at_ns) const noexcept {
  return std::any_of(settings_.faults.begin(), settings_.faults.end(), [&](const Fault& fault) {
    return fault.kind == kind && fault.concerns(motor) && fault.lasts_at(at_ns - start_ns_);
  });
}

Check DamiaoPeer::inject(Fault fault, std::int64_t now_ns) {
  if (fault.kind == FaultKind::wrong_scale || fault.kind == FaultKind::wrap || fault.kind == FaultKind::heartbeat) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = std::string(name_of(fault.kind)) + " cannot begin while the motors run: start them with it",
                 .place = {}};
  }
  live_until(now_ns);
  fault.from_ns += now_ns - start_ns_;
  if (fault.until_ns != wire::never_ns) fault.until_ns += now_ns - start_ns_;
  settings_.faults.push_back(fault);
  return std::nullopt;
}

void DamiaoPeer::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  live_until(now_ns);
  adapter_.hear(bytes, [this, now_ns](const Frame& frame) {
    if (suffers(FaultKind::bus_off, 0, now_ns)) {
      outbox_.put(adapter_.tell(Adapter::Notice::sending_failed).view(), now_ns);
    } else {
      wait(frame, adapter_sender, now_ns);
    }
  });
}

std::span<const std::uint8_t> DamiaoPeer::say(std::int64_t now_ns) noexcept {
  live_until(now_ns);
  return outbox_.take(now_ns);
}

std::int64_t DamiaoPeer::wakes_ns() const noexcept {
  // Before its first call it knows no time. A mechanism moves by itself, spoken to or not.
  constexpr std::int64_t look_every_ns = 10'000'000;
  const std::int64_t moves_ns = mechanism_ ? turned_until_ns_ + look_every_ns : wire::never_ns;
  return start_ns_ < 0 ? 0 : std::min({outbox_.due_ns(), next_ns(), moves_ns});
}

void DamiaoPeer::wait(const Frame& frame, int sender, std::int64_t ready_ns) noexcept {
  // Nobody has a later frame ready before an earlier one of its own.
  for (const Waiting& earlier : waiting_) {
    if (earlier.sender == sender) ready_ns = std::max(ready_ns, earlier.ready_ns);
  }
  if (waiting_.size() < most_waiting) waiting_.push_back({frame, sender, ready_ns});
}

std::int64_t DamiaoPeer::earliest_start_ns() const noexcept {
  std::int64_t earliest_ns = wire::never_ns;
  for (const Waiting& one : waiting_) earliest_ns = std::min(earliest_ns, one.ready_ns);
  return std::max(earliest_ns, bus_free_ns_);
}

std::int64_t DamiaoPeer::next_ns() const noexcept {
  return std::min(bus_taken_ ? bus_free_ns_ : earliest_start_ns(), heartbeat_ns_);
}

void DamiaoPeer::live_until(std::int64_t now_ns) noexcept {
  if (start_ns_ < 0) {
    start_ns_ = now_ns;
    const bool beats = std::any_of(settings_.faults.begin(), settings_.faults.end(),
                                   [](const Fault& fault) { return fault.kind == FaultKind::heartbeat; });
    if (beats) heartbeat_ns_ = now_ns;
  }
  for (std::int64_t at_ns = next_ns(); at_ns <= now_ns; at_ns = next_ns()) {
    inject(at_ns);
    if (heartbeat_ns_ <= at_ns) {
      if (suffers(FaultKind::heartbeat, 0, heartbeat_ns_)) {
        outbox_.put(adapter_.tell(Adapter::Notice::heartbeat).view(), heartbeat_ns_);
      }
      heartbeat_ns_ += heartbeat_every_ns;
    } else if (bus_taken_) {
      finish_frame();
    } else {
      start_frame(at_ns);
    }
  }
  inject(now_ns);
  turn_together_until(now_ns);
  for (Motor& motor : motors_) motor.live_until(now_ns);
}

/// What the motors of the mechanism do up to this time.
void DamiaoPeer::turn_together_until(std::int64_t now_ns) noexcept {
  if (!mechanism_) return;
  // As a motor that turns alone.
  constexpr std::int64_t step_ns = 100'000, most_ns = 10'000'000'000;
  turned_until_ns_ = turned_until_ns_ < 0 ? now_ns : std::max(turned_until_ns_, now_ns - most_ns);
  while (turned_until_ns_ + step_ns <= now_ns) {
    turned_until_ns_ += step_ns;
    for (std::size_t i = 0; i < given_Nm_.size(); ++i) given_Nm_[i] = motors_[i].give(turned_until_ns_);
    mechanism_->step(given_Nm_);
    for (std::size_t i = 0; i < given_Nm_.size(); ++i) {
      motors_[i].turn_to(mechanism_->position_rad(i), mechanism_->velocity_rad_per_s(i));
    }
  }
}

/// What happens to motors by itself, up to this time.
void DamiaoPeer::inject(std::int64_t at_ns) noexcept {
  for (Motor& motor : motors_) {
    const std::uint32_t id = motor.settings().id;
    std::optional<std::uint8_t> reported;
    for (const Fault& fault : settings_.faults) {
      const bool lasts = fault.concerns(id) && fault.lasts_at(at_ns - start_ns_);
      if (fault.kind == FaultKind::status && lasts) reported = fault.status;
    }
    motor.report(reported);
    motor.ignore_disable(suffers(FaultKind::ignores_disable, id, at_ns));
  }
  for (const Fault& fault : settings_.faults) {
    const std::uint8_t status = status_of(fault.kind);
    if (fault.kind == FaultKind::power_cycle && at_ns - start_ns_ >= fault.from_ns) {
      for (Motor& motor : motors_) {
        if (!fault.concerns(motor.settings().id)) continue;
        motor.live_until(start_ns_ + fault.from_ns);
        motor.lose_power(start_ns_ + fault.from_ns);
      }
    }
    if (status == 0 || at_ns - start_ns_ < fault.from_ns) continue;
    for (Motor& motor : motors_) {
      if (!fault.concerns(motor.settings().id)) continue;
      const std::int64_t begins_ns = std::min(at_ns, start_ns_ + fault.from_ns);
      turn_together_until(begins_ns);
      motor.live_until(begins_ns);
      if (fault.lasts_at(at_ns - start_ns_)) {
        motor.fail(status, true);
      } else {
        motor.recover();
      }
    }
  }
}

void DamiaoPeer::start_frame(std::int64_t at_ns) noexcept {
  auto first = waiting_.end();
  for (auto one = waiting_.begin(); one != waiting_.end(); ++one) {
    const bool is_next =
        std::none_of(waiting_.begin(), one, [one](const Waiting& earlier) { return earlier.sender == one->sender; });
    if (!is_next || one->ready_ns > at_ns) continue;
    if (first == waiting_.end() || one->frame.id < first->frame.id) first = one;
  }
  on_bus_ = *first;
  waiting_.erase(first);
  bus_taken_ = true;
  bus_free_ns_ = at_ns + frame_ns(on_bus_.frame, is_flexible(settings_.adapter));
}

void DamiaoPeer::finish_frame() noexcept {
  bus_taken_ = false;
  const std::int64_t at_ns = bus_free_ns_;
  if (on_bus_.sender != adapter_sender) return tell(on_bus_.frame, at_ns);
  turn_together_until(at_ns);
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const std::uint32_t id = motors_[i].settings().id;
    if (suffers(FaultKind::silence, id, at_ns) || motors_[i].is_off(at_ns)) continue;
    const auto answer = motors_[i].answer(on_bus_.frame, at_ns);
    if (!answer) continue;
    const std::int64_t ready_ns =
        at_ns + static_cast<std::int64_t>(random_.uniform(soonest_answer_ns, latest_answer_ns));
    constexpr double stray_part = 0.2;
    if (suffers(FaultKind::register_answer, id, at_ns) && random_.uniform() < stray_part) {
      wait(motors_[i].stray_answer(), static_cast<int>(i), ready_ns);
    }
    wait(*answer, static_cast<int>(i), ready_ns);
    if (suffers(FaultKind::twin, id, at_ns)) {
      const auto later_ns = static_cast<std::int64_t>(random_.uniform(soonest_answer_ns, latest_answer_ns));
      wait(*answer, static_cast<int>(motors_.size() + i), at_ns + later_ns);
    }
  }
}

void DamiaoPeer::tell(const Frame& frame, std::int64_t at_ns) noexcept {
  if (suffers(FaultKind::bus_off, 0, at_ns)) return;
  constexpr double garbage_part = 0.1;
  if (suffers(FaultKind::garbage, 0, at_ns) && random_.uniform() < garbage_part) tell_garbage(at_ns);
  const Adapter::Said said = adapter_.tell(frame);
  const auto bytes = said.view();
  if (!is_serial(settings_.adapter) || bytes.empty() || !suffers(FaultKind::split, 0, at_ns)) {
    outbox_.put(bytes, at_ns);
    return;
  }
  const auto cut = static_cast<std::size_t>(random_.uniform(0.0, static_cast<double>(bytes.size())));
  outbox_.put(bytes.first(cut), at_ns);
  outbox_.put(bytes.subspan(cut), at_ns + piece_ns);
}

void DamiaoPeer::tell_garbage(std::int64_t at_ns) noexcept {
  if (!is_serial(settings_.adapter)) {
    Frame nobody{.id = 0x400, .bytes = {}};
    nobody.id += static_cast<std::uint32_t>(random_.bits() & 0xff);
    for (std::uint8_t& byte : nobody.bytes) byte = static_cast<std::uint8_t>(random_.bits());
    outbox_.put(adapter_.tell(nobody).view(), at_ns);
    return;
  }
  std::array<std::uint8_t, 20> bytes{};
  const std::size_t count = 1 + random_.bits() % bytes.size();
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random_.bits());
  outbox_.put({bytes.data(), count}, at_ns);
}

}  // namespace tactus::emulation::damiao
