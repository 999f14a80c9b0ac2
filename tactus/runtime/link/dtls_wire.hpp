// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/link/handshake_frame.hpp>
#include <tactus/runtime/link/socket.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

// OpenSSL's BIO and BIO_METHOD. Only declared: headers are installed, and a user of the package need not have
// OpenSSL's.
struct bio_st;         // NOLINT: the name is not ours
struct bio_method_st;  // NOLINT

namespace tactus::link {

/// The first byte of a record that carries a message (RFC 6347, Sec. 4.1).
inline constexpr std::byte message_record{23};

/// Sends the frames of a site, each with the next number. Belongs to the thread of the hand-shakes.
class FrameSender {
 public:
  FrameSender(const Socket& socket, FrameTags tags) : socket_(&socket), tags_(std::move(tags)) {}

  void send(std::uint64_t own, std::uint64_t other, std::span<const std::byte> records = {}) noexcept {
    if (records.size() > most_record_bytes) return;
    FrameBytes bytes;
    socket_->send(tags_.write({.session = own, .peer = other, .number = ++number_, .records = records}, bytes));
  }

 private:
  const Socket* socket_;
  FrameTags tags_;
  std::uint64_t number_ = 0;
};

/// What the network looks like to OpenSSL: it reads the one packet that is laid out; the messages that it writes go to
/// the socket as they are, and all else in frames.
struct DtlsWire {
  static constexpr long mtu_bytes = most_record_bytes;

  const Socket* socket = nullptr;
  FrameSender* frames = nullptr;  ///< null where hands were shaken: then nothing but messages is sent
  std::uint64_t own = 0;          ///< sessions in the frames
  std::uint64_t other = 0;
  std::span<const std::byte> packet;  ///< read once, then empty
};

/// How OpenSSL works with a wire; null where it has no memory. To be freed with BIO_meth_free.
bio_method_st* new_wire_method() noexcept;

/// `wire` for a connection of OpenSSL, to be freed by that; null where there is no memory. `wire` must outlive it.
bio_st* new_wire(bio_method_st* method, DtlsWire& wire) noexcept;

}  // namespace tactus::link
