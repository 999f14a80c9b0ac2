// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/outbox.hpp>

#include <cstring>

namespace tactus::wire {

bool Outbox::put(std::span<const std::uint8_t> packet, std::int64_t due_ns) noexcept {
  if (packet.empty()) return true;
  const std::size_t waiting = end_ - begin_, needed = sizeof(Head) + packet.size();
  if (waiting + needed > room_.size()) return false;
  if (end_ + needed > room_.size()) {
    std::memmove(room_.data(), room_.data() + begin_, waiting);
    begin_ = 0;
    end_ = waiting;
  }
  const Head head{.due_ns = due_ns, .size = packet.size()};
  std::memcpy(room_.data() + end_, &head, sizeof(head));
  std::memcpy(room_.data() + end_ + sizeof(head), packet.data(), packet.size());
  end_ += needed;
  return true;
}

Outbox::Head Outbox::head() const noexcept {
  Head head{.due_ns = never_ns, .size = 0};
  if (begin_ != end_) std::memcpy(&head, room_.data() + begin_, sizeof(head));
  return head;
}

std::span<const std::uint8_t> Outbox::take(std::int64_t now_ns) noexcept {
  const Head first = head();
  if (first.due_ns > now_ns || begin_ == end_) return {};
  const std::span packet(room_.data() + begin_ + sizeof(Head), static_cast<std::size_t>(first.size));
  begin_ += sizeof(Head) + packet.size();
  return packet;
}

std::int64_t Outbox::due_ns() const noexcept { return head().due_ns; }

}  // namespace tactus::wire
