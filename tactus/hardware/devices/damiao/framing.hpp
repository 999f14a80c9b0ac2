// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/damiao/frames.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::devices::damiao {

/// How a frame of CAN becomes bytes.
enum class Framing : std::int64_t {
  usb2can,      ///< Damiao's serial adapter
  slcan,        ///< text at a serial port, as CANable and many others speak it
  slcan_fd,     ///< the same with CAN FD, 5 Mbit/s for the data
  socketcan,    ///< `struct can_frame` of Linux, one at a time
  socketcan_fd  ///< `struct canfd_frame`, the data at 5 Mbit/s; a classic frame that comes is taken too
};
constexpr auto enumerators(Framing) {
  return std::array{Enumerator{Framing::usb2can, "usb2can"}, Enumerator{Framing::slcan, "slcan"},
                    Enumerator{Framing::slcan_fd, "slcan-fd"}, Enumerator{Framing::socketcan, "socketcan"},
                    Enumerator{Framing::socketcan_fd, "socketcan-fd"}};
}

/// A frame in bytes.
struct Wrapped {
  std::array<std::uint8_t, 72> bytes{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> view() const noexcept { return {bytes.data(), size}; }
};
Wrapped wrap(Framing framing, const CanFrame& frame) noexcept;
/// What an adapter must receive before frames pass; may be empty.
Wrapped opening(Framing framing) noexcept;

/// Finds frames of 11-bit identifiers in what comes. Bytes of serial framings may be cut anywhere, and garbage may
/// are between two frames: it looks for the next frame after it. With Linux' structures each piece is one frame.
/// Frames that no motor sends (remote, extended, of errors) and notices of the adapter are left out. Real-time safe.
class FrameReader {
 public:
  explicit FrameReader(Framing framing) noexcept : framing_(framing) {}

  /// Calls `visit(const CanFrame&)` for each that is complete now.
  template <class Visit>
  void take(std::span<const std::uint8_t> bytes, Visit&& visit) noexcept {
    CanFrame frame;
    if (framing_ == Framing::socketcan || framing_ == Framing::socketcan_fd) {
      if (take_structure(bytes, frame)) visit(frame);
      return;
    }
    for (const std::uint8_t byte : bytes) {
      if (framing_ == Framing::usb2can ? take_usb2can(byte, frame) : take_slcan(byte, frame)) visit(frame);
    }
  }

 private:
  static bool take_structure(std::span<const std::uint8_t> bytes, CanFrame& frame) noexcept;
  bool take_usb2can(std::uint8_t byte, CanFrame& frame) noexcept;
  bool take_slcan(std::uint8_t byte, CanFrame& frame) noexcept;

  Framing framing_;
  std::array<std::uint8_t, 32> waiting_{};
  std::size_t size_ = 0;
};

}  // namespace tactus::devices::damiao
