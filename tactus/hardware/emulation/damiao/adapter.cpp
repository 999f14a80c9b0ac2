// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/damiao/adapter.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstring>

#include <linux/can.h>
#include <linux/can/error.h>

namespace tactus::emulation::damiao {

namespace {

/// Of text; none where a character is no digit.
std::optional<std::uint32_t> hex(std::span<const std::uint8_t> digits) noexcept {
  std::uint32_t value = 0;
  for (const std::uint8_t digit : digits) {
    const char c = static_cast<char>(digit);
    std::uint32_t one = 0;
    const auto [end, error] = std::from_chars(&c, &c + 1, one, 16);
    if (error != std::errc() || end != &c + 1) return std::nullopt;
    value = value * 16 + one;
  }
  return value;
}

void add_hex(Adapter::Said& said, std::uint32_t value, int digits) noexcept {
  while (digits-- > 0) {
    const std::uint32_t digit = value >> (4 * digits) & 0xf;
    said.add(static_cast<std::uint8_t>(digit < 10 ? '0' + digit : 'A' + digit - 10));
  }
}

Adapter::Said dongle_packet(std::uint8_t what, const Frame& frame) noexcept {
  Adapter::Said said;
  said.add(0xaa);
  said.add(what);
  said.add(8);
  for (int shift = 0; shift < 32; shift += 8) said.add(static_cast<std::uint8_t>(frame.id >> shift));
  for (const std::uint8_t byte : frame.bytes) said.add(byte);
  said.add(0x55);
  return said;
}

template <class Structure>
Adapter::Said in_structure(const Frame& frame, std::uint32_t flags) noexcept {
  Structure structure;
  std::memset(&structure, 0, sizeof(structure));
  structure.can_id = frame.id | flags;
  structure.len = 8;
  std::memcpy(structure.data, frame.bytes.data(), 8);
  Adapter::Said said;
  said.size = sizeof(structure);
  std::memcpy(said.bytes.data(), &structure, sizeof(structure));
  return said;
}

}  // namespace

Adapter::Said Adapter::tell(const Frame& frame) const noexcept {
  Said said;
  switch (type_) {
    case AdapterType::usb2can:
      return dongle_packet(0x11, frame);
    case AdapterType::slcan:
    case AdapterType::slcan_fd:
      if (!open_) return said;
      said.add(type_ == AdapterType::slcan ? 't' : 'b');
      add_hex(said, frame.id, 3);
      add_hex(said, 8, 1);
      for (const std::uint8_t byte : frame.bytes) add_hex(said, byte, 2);
      said.add('\r');
      return said;
    case AdapterType::socketcan:
      return in_structure<can_frame>(frame, 0);
    case AdapterType::socketcan_fd:
      return in_structure<canfd_frame>(frame, 0);
  }
  return said;
}

Adapter::Said Adapter::tell(Notice notice) const noexcept {
  const bool failed = notice == Notice::sending_failed;
  if (type_ == AdapterType::usb2can) return dongle_packet(failed ? 0x02 : 0x00, {});
  Said said;
  if (is_serial(type_)) {
    // What adapters other than CANable answer: good or bad.
    said.add(failed ? 0x07 : '\r');
  } else if (failed) {
    said = in_structure<can_frame>({}, CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  }
  return said;
}

std::optional<Frame> Adapter::structure_in(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() != CAN_MTU && bytes.size() != CANFD_MTU) return std::nullopt;
  canfd_frame structure;
  std::memset(&structure, 0, sizeof(structure));
  std::memcpy(&structure, bytes.data(), bytes.size());
  if ((structure.can_id & (CAN_EFF_FLAG | CAN_RTR_FLAG | CAN_ERR_FLAG)) != 0 || structure.len > 8) return std::nullopt;
  Frame frame{.id = structure.can_id, .bytes = {}};
  std::memcpy(frame.bytes.data(), structure.data, 8);
  return frame;
}

std::optional<Frame> Adapter::packet_with(std::uint8_t byte) noexcept {
  constexpr std::size_t whole = 30;
  constexpr std::array<std::uint8_t, 3> head{0x55, 0xaa, 0x1e};
  kept_[count_++] = byte;
  while (count_ > 0 &&
         !std::equal(kept_.begin(), kept_.begin() + static_cast<long>(std::min(count_, head.size())), head.begin())) {
    std::memmove(kept_.data(), kept_.data() + 1, --count_);
  }
  if (count_ < whole) return std::nullopt;
  count_ = 0;
  const bool forwards = kept_[3] == 1 || kept_[3] == 3, standard_data = kept_[12] == 0 && kept_[17] == 0;
  if (!forwards || !standard_data || kept_[18] > 8) return std::nullopt;
  Frame frame{.id = static_cast<std::uint32_t>(kept_[13] | kept_[14] << 8), .bytes = {}};
  std::copy_n(kept_.begin() + 21, 8, frame.bytes.begin());
  return frame;
}

std::optional<Frame> Adapter::line_with(std::uint8_t byte) noexcept {
  if (byte != '\r') {
    if (count_ == kept_.size()) count_ = 0;
    kept_[count_++] = byte;
    return std::nullopt;
  }
  const std::span<const std::uint8_t> line(kept_.data(), count_);
  count_ = 0;
  if (line.size() == 1 && line[0] == 'O') open_ = true;
  if (line.size() == 1 && line[0] == 'C') open_ = false;
  const bool frame_line = line.size() >= 5 && (line[0] == 't' || line[0] == 'b' || line[0] == 'd');
  if (!frame_line || !open_) return std::nullopt;
  const auto id = hex(line.subspan(1, 3)), size = hex(line.subspan(4, 1));
  if (!id || !size || *size > 8 || line.size() != 5 + 2 * *size) return std::nullopt;
  Frame frame{.id = *id, .bytes = {}};
  for (std::size_t i = 0; i < *size; ++i) {
    const auto value = hex(line.subspan(5 + 2 * i, 2));
    if (!value) return std::nullopt;
    frame.bytes[i] = static_cast<std::uint8_t>(*value);
  }
  return frame;
}

}  // namespace tactus::emulation::damiao
