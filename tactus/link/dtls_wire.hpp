#pragma once

#include <tactus/link/socket.hpp>

#include <cstddef>
#include <span>

// OpenSSL's BIO and BIO_METHOD. Only declared: headers are installed, and a user of the package need not have
// OpenSSL's.
struct bio_st;         // NOLINT: the name is not ours
struct bio_method_st;  // NOLINT

namespace tactus::link {

/// What the network looks like to OpenSSL: it reads the one packet that is laid out, and writes to the socket.
struct DtlsWire {
  static constexpr long mtu_bytes = 1200;

  const Socket* socket = nullptr;
  std::span<const std::byte> packet;  ///< read once, then empty
};

/// How OpenSSL works with a wire; null where it has no memory. To be freed with BIO_meth_free.
bio_method_st* new_wire_method() noexcept;

/// `wire` for a connection of OpenSSL, to be freed by that; null where there is no memory. `wire` must outlive it.
bio_st* new_wire(bio_method_st* method, DtlsWire& wire) noexcept;

}  // namespace tactus::link
