// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/link/key.hpp>
#include <tactus/runtime/link/socket.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace tactus::link {

/// Encryption and mutual authentication over a socket: DTLS 1.2 (RFC 6347) with a pre-shared key, cipher suite
/// TLS_ECDHE_PSK_WITH_CHACHA20_POLY1305_SHA256 (RFC 7905) over X25519, so that a key that leaks later does not open
/// what was recorded before. By OpenSSL; no part of it shows here.
///
/// Hand-shakes run in a thread of their own, which starts with the channel. `open` and `send` belong to one thread, the
/// servo's, and never wait for that: they pass hand-shake packets on through queues of fixed size and pick finished
/// keys up. The master begins a hand-shake whenever nothing authentic has come for `silence_before_handshake_s`; the
/// slave answers one at any time, but continues with the old keys until the new ones have proved themselves. So either
/// side may be killed and started again, and a forged packet ends nothing.
///
/// Every packet of a hand-shake bears a tag (`FrameTags`), which is checked before anything else is done for it. So a
/// packet that is not authentic costs one tag or one try to open it, no allocation and no line of a log; it is counted.
class SecureChannel {
 public:
  static constexpr double silence_before_handshake_s = 0.25;
  /// The one size of message that a channel carries, and what it becomes on the network.
  static constexpr std::size_t overhead_bytes = 29;

  struct Counters {
    std::uint64_t opened = 0;             ///< authentic messages
    std::uint64_t refused = 0;            ///< not authentic, replayed, truncated or of another kind
    std::uint64_t handshake_packets = 0;  ///< genuine, and passed on to the thread
    std::uint64_t handshakes = 0;         ///< finished, and in use since
    std::uint64_t overflowed = 0;         ///< hand-shake packets for which the queue had no room
    std::uint16_t other_version = 0;      ///< of the format that the other site shakes hands in, where it is another
    std::size_t other_joints = 0;         ///< that the other site shakes hands for, where they are others
    std::uint64_t forged = 0;             ///< frames that were not made with the own key, of those refused
    std::uint64_t plain = 0;              ///< datagrams in plain text while there was no link, of those refused
  };

  /// For datagrams of so many joints. `socket` must outlive the channel. Errors: `failed` where OpenSSL lacks
  /// something.
  static Result<SecureChannel> make(SiteRole own_site, const Key& key, const Socket& socket, std::size_t joints);
  SecureChannel(SecureChannel&&) noexcept;
  SecureChannel& operator=(SecureChannel&&) noexcept;
  ~SecureChannel();

  /// Opens one packet into `message`, which has room for a datagram. True where it was an authentic message that
  /// had not come before. Real-time safe.
  bool open(const Received& packet, std::span<std::byte> message) noexcept;
  /// Encrypts a message and sends it. False where there are no keys yet or the kernel did not take it. Real-time safe.
  bool send(std::span<const std::byte> message) noexcept;
  /// Whether both sides have proved that they know the key.
  [[nodiscard]] bool established() const noexcept;
  [[nodiscard]] Counters counters() const noexcept;

 private:
  class Implementation;
  explicit SecureChannel(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace tactus::link
