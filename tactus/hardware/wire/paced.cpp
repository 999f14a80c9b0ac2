// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/paced.hpp>

#include <algorithm>
#include <utility>

namespace tactus::wire {

namespace {

constexpr std::size_t room_bytes = 1 << 14;

}  // namespace

Paced::Paced(WireEnd& end, std::int64_t byte_ns, Line line)
    : end_(&end), byte_ns_(std::max<std::int64_t>(byte_ns, 1)), line_(line), coming_(room_bytes), going_(room_bytes) {}

std::int64_t Paced::through_ns(std::int64_t& free_ns, std::size_t bytes, std::int64_t now_ns) const noexcept {
  return free_ns = std::max(free_ns, now_ns) + byte_ns_ * static_cast<std::int64_t>(bytes);
}

void Paced::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  live_until(now_ns);
  for (const std::uint8_t byte : bytes) {
    const std::int64_t there_ns = through_ns(there_free_ns_, 1, now_ns);
    if (count_ == coming_.size()) continue;
    coming_[(first_ + count_++) % coming_.size()] = {there_ns, byte};
  }
}

std::span<const std::uint8_t> Paced::say(std::int64_t now_ns) noexcept {
  live_until(now_ns);
  return going_.take(now_ns);
}

std::int64_t Paced::next_ns() const noexcept {
  const std::int64_t received_ns = count_ > 0 ? coming_[first_].there_ns : never_ns;
  // An end that has nothing to say when it wanted to does not stop time.
  return std::max(std::min(received_ns, end_->wakes_ns()), lived_until_ns_ + 1);
}

std::int64_t Paced::wakes_ns() const noexcept { return std::min(next_ns(), going_.due_ns()); }

void Paced::live_until(std::int64_t now_ns) noexcept {
  // Its end begins when it is called first, not when the clock did.
  if (!std::exchange(began_, true)) lived_until_ns_ = now_ns - 1;
  for (std::int64_t at_ns = next_ns(); at_ns <= now_ns; at_ns = next_ns()) {
    lived_until_ns_ = at_ns;
    if (count_ > 0 && coming_[first_].there_ns <= at_ns) {
      end_->hear({&coming_[first_].byte, 1}, at_ns);
      first_ = (first_ + 1) % coming_.size();
      --count_;
    }
    std::int64_t& free_ns = line_ == Line::half_duplex ? there_free_ns_ : back_free_ns_;
    for (auto packet = end_->say(at_ns); !packet.empty(); packet = end_->say(at_ns)) {
      const std::int64_t gone_ns = through_ns(free_ns, packet.size(), at_ns);
      going_.put(packet, gone_ns);
    }
  }
}

}  // namespace tactus::wire
