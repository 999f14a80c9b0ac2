// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/framing.hpp>

#include <algorithm>
#include <cstring>
#include <string_view>

#include <linux/can.h>

namespace tactus::devices::damiao {

namespace {

constexpr std::uint16_t largest_id = 0x7ff;
constexpr std::size_t usb2can_there = 30, usb2can_back = 16;
constexpr std::uint8_t received = 0x11;

constexpr bool is_notice(std::uint8_t command) {
  constexpr std::array<std::uint8_t, 8> all{0x00, 0x01, 0x02, 0x03, received, 0x12, 0x13, 0xee};
  return std::find(all.begin(), all.end(), command) != all.end();
}

void append(Wrapped& to, std::string_view text) noexcept {
  for (const char c : text) to.bytes[to.size++] = static_cast<std::uint8_t>(c);
}

void append_hex(Wrapped& to, std::uint32_t value, int digits) noexcept {
  for (int digit = digits - 1; digit >= 0; --digit) {
    append(to, std::string_view("0123456789ABCDEF").substr(value >> (4 * digit) & 0xf, 1));
  }
}

Wrapped wrap_usb2can(const CanFrame& frame) noexcept {
  constexpr std::uint8_t forward_without_answer = 3, times = 1, interval = 10;
  Wrapped wrapped{.bytes = {0x55, 0xaa, usb2can_there, forward_without_answer, times, 0, 0, 0, interval},
                  .size = usb2can_there};
  wrapped.bytes[13] = static_cast<std::uint8_t>(frame.id & 0xff);
  wrapped.bytes[14] = static_cast<std::uint8_t>(frame.id >> 8);
  wrapped.bytes[18] = frame.size;
  std::copy(frame.data.begin(), frame.data.end(), wrapped.bytes.begin() + 21);
  return wrapped;
}

Wrapped wrap_slcan(const CanFrame& frame, bool flexible) noexcept {
  Wrapped wrapped;
  append(wrapped, flexible ? "b" : "t");
  append_hex(wrapped, frame.id, 3);
  append_hex(wrapped, frame.size, 1);
  for (std::size_t i = 0; i < frame.size; ++i) append_hex(wrapped, frame.data[i], 2);
  append(wrapped, "\r");
  return wrapped;
}

template <class Structure>
Wrapped wrap_structure(const CanFrame& frame) noexcept {
  // Zeros wherever nothing is written, so that nothing of ours leaks.
  Structure structure{};
  structure.can_id = frame.id;
  structure.len = frame.size;
  if constexpr (std::is_same_v<Structure, canfd_frame>) structure.flags = CANFD_BRS;
  std::copy_n(frame.data.begin(), frame.size, structure.data);
  Wrapped wrapped{.bytes = {}, .size = sizeof(structure)};
  std::memcpy(wrapped.bytes.data(), &structure, sizeof(structure));
  return wrapped;
}

/// -1 where it is none.
int hex_digit(std::uint8_t byte) noexcept {
  if (byte >= '0' && byte <= '9') return byte - '0';
  if (byte >= 'A' && byte <= 'F') return byte - 'A' + 10;
  if (byte >= 'a' && byte <= 'f') return byte - 'a' + 10;
  return -1;
}

/// A line from its letter to before its end.
bool parse_slcan(std::span<const std::uint8_t> line, CanFrame& frame) noexcept {
  constexpr std::size_t head = 5;
  if (line.size() < head || (line[0] != 't' && line[0] != 'b' && line[0] != 'd')) return false;
  std::array<std::uint8_t, head + 16> digits{};
  if (line.size() > digits.size()) return false;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const int digit = hex_digit(line[i]);
    if (digit < 0) return false;
    digits[i] = static_cast<std::uint8_t>(digit);
  }
  frame = {
      .id = static_cast<std::uint16_t>(digits[1] << 8 | digits[2] << 4 | digits[3]), .size = digits[4], .data = {}};
  const std::size_t whole = head + 2 * std::size_t{frame.size};
  if (frame.id > largest_id || frame.size > frame.data.size() || line.size() != whole) return false;
  for (std::size_t i = 0; i < frame.size; ++i) {
    frame.data[i] = static_cast<std::uint8_t>(digits[head + 2 * i] << 4 | digits[head + 2 * i + 1]);
  }
  return true;
}

}  // namespace

Wrapped wrap(Framing framing, const CanFrame& frame) noexcept {
  switch (framing) {
    case Framing::usb2can:
      return wrap_usb2can(frame);
    case Framing::slcan:
    case Framing::slcan_fd:
      return wrap_slcan(frame, framing == Framing::slcan_fd);
    case Framing::socketcan:
      return wrap_structure<can_frame>(frame);
    case Framing::socketcan_fd:
      return wrap_structure<canfd_frame>(frame);
  }
  return {};
}

Wrapped opening(Framing framing) noexcept {
  Wrapped lines;
  // Closed first: an adapter that was left open takes no bit rate.
  if (framing == Framing::slcan) append(lines, "C\rS8\rO\r");
  if (framing == Framing::slcan_fd) append(lines, "C\rS8\rY5\rM0\rO\r");
  return lines;
}

bool FrameReader::take_structure(std::span<const std::uint8_t> bytes, CanFrame& frame) noexcept {
  // Both structures begin with identifier, length and, at the same place, the data.
  static_assert(offsetof(can_frame, data) == offsetof(canfd_frame, data));
  canfd_frame structure{};
  if (bytes.size() != sizeof(can_frame) && bytes.size() != sizeof(canfd_frame)) return false;
  std::memcpy(&structure, bytes.data(), bytes.size());
  if (structure.can_id > largest_id || structure.len > frame.data.size()) return false;
  frame = {.id = static_cast<std::uint16_t>(structure.can_id), .size = structure.len, .data = {}};
  std::copy_n(structure.data, structure.len, frame.data.begin());
  return true;
}

bool FrameReader::take_usb2can(std::uint8_t byte, CanFrame& frame) noexcept {
  const auto& w = waiting_;
  waiting_[size_++] = byte;
  while (size_ > 0 &&
         (w[0] != 0xaa || (size_ > 1 && !is_notice(w[1])) || (size_ == usb2can_back && w[usb2can_back - 1] != 0x55))) {
    std::copy(waiting_.begin() + 1, waiting_.begin() + static_cast<std::ptrdiff_t>(size_), waiting_.begin());
    --size_;
  }
  if (size_ < usb2can_back) return false;
  size_ = 0;
  // The upper bits say that it is extended or remote.
  if (w[1] != received || w[2] > 8 || w[4] > (largest_id >> 8) || w[5] != 0 || w[6] != 0) return false;
  frame = {.id = static_cast<std::uint16_t>(w[3] | w[4] << 8), .size = w[2], .data = {}};
  std::copy_n(w.begin() + 7, frame.size, frame.data.begin());
  return true;
}

bool FrameReader::take_slcan(std::uint8_t byte, CanFrame& frame) noexcept {
  constexpr std::uint8_t bad = 0x07;
  if (byte == bad) {
    size_ = 0;
    return false;
  }
  if (byte != '\r') {
    // Of a line that is too long the end is kept: garbage may stand before a frame.
    if (size_ == waiting_.size()) {
      std::copy(waiting_.begin() + 1, waiting_.end(), waiting_.begin());
      --size_;
    }
    waiting_[size_++] = byte;
    return false;
  }
  const std::span<const std::uint8_t> line(waiting_.data(), size_);
  size_ = 0;
  for (std::size_t start = 0; start < line.size(); ++start) {
    if (parse_slcan(line.subspan(start), frame)) return true;
  }
  return false;
}

}  // namespace tactus::devices::damiao
