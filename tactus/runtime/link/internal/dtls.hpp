// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/link/dtls_wire.hpp>
#include <tactus/runtime/link/key.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include <openssl/bio.h>
#include <openssl/ssl.h>

namespace tactus::link {

template <class T, void (*Free)(T*)>
struct Freed {
  void operator()(T* thing) const { Free(thing); }
};

/// One DTLS connection, begun or finished. Used by one thread at a time.
class Connection {
 public:
  enum class Progress : std::uint8_t { waits, done, failed };

  /// Goes on with a hand-shake: with records that came, or without any where it is time to send the own ones again.
  Progress shake_hands(std::span<const std::byte> records = {}) noexcept;
  /// Whether `record` is a message of the other side, which shows that it is done with the hand-shake too.
  bool proves(std::span<const std::byte> record) noexcept;
  /// From now on nothing but messages is sent.
  void finish() noexcept { wire_.frames = nullptr; }

  /// Opens one record into `message` and returns the size of what was in it, 0 where it is not authentic or came
  /// before. Real-time safe.
  std::size_t open(std::span<const std::byte> record, std::span<std::byte> message) noexcept;
  /// Encrypts a message and sends it. Real-time safe.
  bool send(std::span<const std::byte> message) noexcept;

  [[nodiscard]] std::uint64_t other_session() const noexcept { return wire_.other; }

 private:
  friend class Dtls;
  DtlsWire wire_;
  std::unique_ptr<SSL, Freed<SSL, SSL_free>> ssl_;
};

/// What all connections of a channel have in common: DTLS 1.2, one cipher suite and the key. Stays where it is.
class Dtls {
 public:
  Dtls(SiteRole own_site, const Key& key) : own_site_(own_site), key_(key) {}
  Dtls(const Dtls&) = delete;
  Dtls& operator=(const Dtls&) = delete;
  ~Dtls() = default;

  /// Errors: `failed` where OpenSSL lacks something. Before all else, once.
  Check start();
  /// Begins a connection, as the client where the own site is the master. Its hand-shake goes out in frames from `own`
  /// to `other`. Null where there is no memory. What is pointed to must outlive it.
  std::unique_ptr<Connection> connect(const Socket& socket, FrameSender& frames, std::uint64_t own,
                                      std::uint64_t other);

 private:
  static unsigned give_key(SSL* ssl, const char*, char* name, unsigned longest_name, unsigned char* secret,
                           unsigned longest_secret);
  static unsigned find_key(SSL* ssl, const char* name, unsigned char* secret, unsigned longest_secret);

  SiteRole own_site_;
  Key key_;
  std::unique_ptr<BIO_METHOD, Freed<BIO_METHOD, BIO_meth_free>> method_;
  std::unique_ptr<SSL_CTX, Freed<SSL_CTX, SSL_CTX_free>> context_;
};

}  // namespace tactus::link
