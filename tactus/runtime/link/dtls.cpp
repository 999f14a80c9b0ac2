// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/internal/dtls.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>
#include <string>

#include <openssl/err.h>

namespace tactus::link {

namespace {

constexpr const char* cipher_suite = "ECDHE-PSK-CHACHA20-POLY1305";
constexpr const char* identity = "tactus";
constexpr unsigned first_retransmission_us = 50'000;
constexpr unsigned last_retransmission_us = 400'000;

unsigned retransmission_us(SSL*, unsigned last_us) {
  return last_us == 0 ? first_retransmission_us : std::min(2 * last_us, last_retransmission_us);
}

}  // namespace

Connection::Progress Connection::shake_hands(std::span<const std::byte> records) noexcept {
  wire_.packet = records;
  if (records.empty() && DTLSv1_handle_timeout(ssl_.get()) < 0) return Progress::failed;
  const int result = SSL_do_handshake(ssl_.get());
  if (result == 1) return Progress::done;
  const int why = SSL_get_error(ssl_.get(), result);
  ERR_clear_error();
  return why == SSL_ERROR_WANT_READ || why == SSL_ERROR_WANT_WRITE ? Progress::waits : Progress::failed;
}

bool Connection::proves(std::span<const std::byte> record) noexcept {
  std::array<std::byte, Received::longest> message;
  return open(record, message) > 0;
}

std::size_t Connection::open(std::span<const std::byte> record, std::span<std::byte> message) noexcept {
  wire_.packet = record;
  const int size = SSL_read(ssl_.get(), message.data(), static_cast<int>(message.size()));
  if (size > 0) return static_cast<std::size_t>(size);
  ERR_clear_error();
  return 0;
}

bool Connection::send(std::span<const std::byte> message) noexcept {
  if (SSL_write(ssl_.get(), message.data(), static_cast<int>(message.size())) > 0) return true;
  ERR_clear_error();
  return false;
}

unsigned Dtls::give_key(SSL* ssl, const char*, char* name, unsigned longest_name, unsigned char* secret,
                        unsigned longest_secret) {
  if (longest_name <= std::strlen(identity)) return 0;
  std::memcpy(name, identity, std::strlen(identity) + 1);
  return find_key(ssl, identity, secret, longest_secret);
}

unsigned Dtls::find_key(SSL* ssl, const char* name, unsigned char* secret, unsigned longest_secret) {
  const auto& own = *static_cast<const Dtls*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
  if (name == nullptr || std::strcmp(name, identity) != 0 || longest_secret < Key::bytes) return 0;
  std::memcpy(secret, own.key_.secret.data(), Key::bytes);
  return Key::bytes;
}

Check Dtls::start() {
  context_.reset(SSL_CTX_new(own_site_ == SiteRole::master ? DTLS_client_method() : DTLS_server_method()));
  method_.reset(new_wire_method());
  const bool good = context_ && method_ && SSL_CTX_set_min_proto_version(context_.get(), DTLS1_2_VERSION) == 1 &&
                    SSL_CTX_set_max_proto_version(context_.get(), DTLS1_2_VERSION) == 1 &&
                    SSL_CTX_set_cipher_list(context_.get(), cipher_suite) == 1 &&
                    SSL_CTX_set1_groups_list(context_.get(), "X25519") == 1;
  if (good) {
    SSL_CTX_set_app_data(context_.get(), this);
    SSL_CTX_set_options(context_.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_TICKET | SSL_OP_NO_QUERY_MTU);
    SSL_CTX_set_session_cache_mode(context_.get(), SSL_SESS_CACHE_OFF);
    SSL_CTX_set_psk_client_callback(context_.get(), give_key);
    SSL_CTX_set_psk_server_callback(context_.get(), find_key);
  }
  ERR_clear_error();
  if (good) return std::nullopt;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = std::string("OpenSSL cannot do DTLS 1.2 with ") + cipher_suite +
                          ": install OpenSSL 3 with its default provider",
               .place = {}};
}

std::unique_ptr<Connection> Dtls::connect(const Socket& socket, FrameSender& frames, std::uint64_t own,
                                          std::uint64_t other) {
  std::unique_ptr<Connection> connection(new (std::nothrow) Connection());
  if (!connection) return nullptr;  // tried again later, as after any hand-shake that failed
  connection->wire_.socket = &socket;
  connection->wire_.frames = &frames;
  connection->wire_.own = own;
  connection->wire_.other = other;
  connection->ssl_.reset(SSL_new(context_.get()));
  BIO* bio = new_wire(method_.get(), connection->wire_);
  SSL* const ssl = connection->ssl_.get();
  if (ssl == nullptr || bio == nullptr) {
    BIO_free(bio);
    return nullptr;
  }
  SSL_set_bio(ssl, bio, bio);
  SSL_set_mtu(ssl, DtlsWire::mtu_bytes);
  DTLS_set_timer_cb(ssl, retransmission_us);
  own_site_ == SiteRole::master ? SSL_set_connect_state(ssl) : SSL_set_accept_state(ssl);
  return connection;
}

}  // namespace tactus::link
