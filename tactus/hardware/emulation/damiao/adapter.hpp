// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/damiao/motor.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace tactus::emulation::damiao {

/// What is between the computer and the bus.
enum class AdapterType : std::int64_t { usb2can, slcan, slcan_fd, socketcan, socketcan_fd };
constexpr auto enumerators(AdapterType) {
  return std::array{Enumerator{AdapterType::usb2can, "usb2can"}, Enumerator{AdapterType::slcan, "slcan"},
                    Enumerator{AdapterType::slcan_fd, "slcan-fd"}, Enumerator{AdapterType::socketcan, "socketcan"},
                    Enumerator{AdapterType::socketcan_fd, "socketcan-fd"}};
}
constexpr bool is_serial(AdapterType type) { return type < AdapterType::socketcan; }
constexpr bool is_flexible(AdapterType type) {
  return type == AdapterType::slcan_fd || type == AdapterType::socketcan_fd;
}

/// The side of an adapter that the computer sees. Does not allocate.
class Adapter {
 public:
  /// The longest that it reports at once.
  struct Said {
    std::array<std::uint8_t, 72> bytes{};
    std::size_t size = 0;
    void add(std::uint8_t byte) noexcept { bytes[size++] = byte; }
    [[nodiscard]] std::span<const std::uint8_t> view() const noexcept { return {bytes.data(), size}; }
  };
  enum class Notice { heartbeat, sending_failed };

  explicit Adapter(AdapterType type) noexcept : type_(type) {}

  /// Calls `visit(const Frame&)` for each frame that the computer sends to the bus.
  template <class Visit>
  void hear(std::span<const std::uint8_t> bytes, Visit&& visit) noexcept {
    if (!is_serial(type_)) {
      if (const auto frame = structure_in(bytes)) visit(*frame);
      return;
    }
    for (const std::uint8_t byte : bytes) {
      if (const auto frame = type_ == AdapterType::usb2can ? packet_with(byte) : line_with(byte)) visit(*frame);
    }
  }
  /// A frame from the bus, as the computer gets it; empty while an slcan adapter is closed.
  [[nodiscard]] Said tell(const Frame& frame) const noexcept;
  /// Something of its own.
  [[nodiscard]] Said tell(Notice notice) const noexcept;

 private:
  [[nodiscard]] static std::optional<Frame> structure_in(std::span<const std::uint8_t> bytes) noexcept;
  std::optional<Frame> packet_with(std::uint8_t byte) noexcept;
  std::optional<Frame> line_with(std::uint8_t byte) noexcept;

  AdapterType type_;
  std::array<std::uint8_t, 64> kept_{};
  std::size_t count_ = 0;
  bool open_ = false;
};

}  // namespace tactus::emulation::damiao
