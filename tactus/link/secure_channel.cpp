#include <tactus/link/dtls_wire.hpp>
#include <tactus/link/packet_filter.hpp>
#include <tactus/link/secure_channel.hpp>
#include <tactus/telemetry/ring.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>

namespace tactus::link {

namespace {

constexpr const char* cipher_suite = "ECDHE-PSK-CHACHA20-POLY1305";
constexpr const char* identity = "tactus";
constexpr unsigned first_retransmission_us = 50'000;
constexpr unsigned last_retransmission_us = 400'000;
/// A hand-shake that takes longer is given up, and its memory with it.
constexpr std::int64_t patience_ns = 2'000'000'000;
constexpr std::size_t cookie_bytes = 32;

/// First bytes of a DTLS record (RFC 6347, Sec. 4.1).
constexpr std::size_t record_header_bytes = 13;
/// Where the record's number stands, highest byte first.
constexpr std::size_t number_at = 5, number_end = 11;
/// OpenSSL knows of so many numbers up to the newest which it has seen, and refuses all before.
constexpr std::uint64_t window = 64;
/// How often the kernel is told from which number on records are let in.
constexpr std::int64_t filter_every_ns = 50'000'000;
constexpr std::byte change_cipher_spec{20}, alert{21}, handshake{22}, application_data{23};

template <class T, void (*Free)(T*)>
struct Freed {
  void operator()(T* thing) const { Free(thing); }
};
using Context = std::unique_ptr<SSL_CTX, Freed<SSL_CTX, SSL_CTX_free>>;
using Ssl = std::unique_ptr<SSL, Freed<SSL, SSL_free>>;
using Method = std::unique_ptr<BIO_METHOD, Freed<BIO_METHOD, BIO_meth_free>>;
using Peer = std::unique_ptr<BIO_ADDR, Freed<BIO_ADDR, BIO_ADDR_free>>;

/// One DTLS connection, begun or finished. Used by one thread at a time.
struct Connection {
  DtlsWire wire;
  Ssl ssl;
  std::int64_t begun_ns = 0;
  void feed(std::span<const std::byte> packet) noexcept { wire.packet = packet; }
};

/// The number of a record in its epoch.
std::uint64_t number_of(const Packet& packet) noexcept {
  std::uint64_t number = 0;
  for (std::size_t i = number_at; i < number_end; ++i) {
    number = number << 8 | std::to_integer<std::uint64_t>(packet.data[i]);
  }
  return number;
}

struct HandshakePacket {
  std::array<std::byte, Packet::longest> data;
  std::size_t size;
};

unsigned retransmission_us(SSL*, unsigned last_us) {
  return last_us == 0 ? first_retransmission_us : std::min(2 * last_us, last_retransmission_us);
}

}  // namespace

class SecureChannel::Implementation {
 public:
  Implementation(HandshakeRole role, const Key& key, const Socket& socket, std::size_t message_bytes)
      : role_(role), key_(key), socket_(&socket), message_bytes_(message_bytes) {}
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  ~Implementation() {
    stop_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) thread_.join();
    delete ready_.load(std::memory_order_acquire);
    delete retired_.load(std::memory_order_acquire);
    delete current_;
  }

  Check start();

  // The servo's thread.
  bool open(const Packet& packet, std::span<std::byte> message) noexcept;
  bool send(std::span<const std::byte> message) noexcept;
  [[nodiscard]] bool established() const noexcept { return current_ != nullptr; }
  [[nodiscard]] Counters counters() const noexcept { return counters_; }

 private:
  void adopt() noexcept;
  void pass_on(const Packet& packet) noexcept;

  // The thread of the hand-shakes.
  void shake_hands();
  std::unique_ptr<Connection> connect();
  void take(std::span<const std::byte> packet);
  void advance();
  void publish();
  void drop_pending();
  void filter(std::int64_t now_ns);
  bool draw_cookie() { return RAND_bytes(cookie_.data(), cookie_bytes) == 1; }

  static Implementation& of(const SSL* ssl) {
    return *static_cast<Implementation*>(SSL_CTX_get_app_data(SSL_get_SSL_CTX(ssl)));
  }
  static unsigned give_key(SSL* ssl, const char*, char* name, unsigned longest_name, unsigned char* secret,
                           unsigned longest_secret);
  static unsigned find_key(SSL* ssl, const char* name, unsigned char* secret, unsigned longest_secret);
  static int write_cookie(SSL* ssl, unsigned char* cookie, unsigned* size);
  static int check_cookie(SSL* ssl, const unsigned char* cookie, unsigned size);

  HandshakeRole role_;
  Key key_;
  const Socket* socket_;
  std::size_t message_bytes_;
  std::array<unsigned char, cookie_bytes> cookie_{};
  Method method_;
  Context context_;

  Connection* current_ = nullptr;        ///< of the servo's thread
  Counters counters_;                    ///< of the servo's thread
  std::unique_ptr<Connection> pending_;  ///< of the other one
  bool shaken_ = false;                  ///< the pending one has its keys; the server waits for proof of the other's
  std::uint64_t admitted_ = 0;           ///< the least number that the kernel lets in
  std::int64_t filtered_ns_ = 0;         ///< when it was told

  telemetry::Ring<HandshakePacket, 16> handshake_packets_;
  std::atomic<Connection*> ready_{nullptr};    ///< with new keys, for the servo to pick up
  std::atomic<Connection*> retired_{nullptr};  ///< with old keys, for the other thread to free
  std::atomic<bool> wants_proof_{false};       ///< an open hand-shake may be what a message is sealed for
  std::atomic<std::int64_t> heard_ns_{0};      ///< when the last authentic message came
  std::atomic<std::uint64_t> newest_{0};       ///< number of an authentic record of the current connection
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

unsigned SecureChannel::Implementation::give_key(SSL* ssl, const char*, char* name, unsigned longest_name,
                                                 unsigned char* secret, unsigned longest_secret) {
  if (longest_name <= std::strlen(identity)) return 0;
  std::memcpy(name, identity, std::strlen(identity) + 1);
  return find_key(ssl, identity, secret, longest_secret);
}

unsigned SecureChannel::Implementation::find_key(SSL* ssl, const char* name, unsigned char* secret,
                                                 unsigned longest_secret) {
  const Key& key = of(ssl).key_;
  if (name == nullptr || std::strcmp(name, identity) != 0 || longest_secret < Key::bytes) return 0;
  std::memcpy(secret, key.secret.data(), Key::bytes);
  return Key::bytes;
}

// The socket hears one address only, so the cookie of RFC 6347, Sec. 4.2.1 need not depend on it: it shows that who
// begins a hand-shake can receive there. It is drawn anew after each, so that a recorded beginning opens nothing.
int SecureChannel::Implementation::write_cookie(SSL* ssl, unsigned char* cookie, unsigned* size) {
  std::memcpy(cookie, of(ssl).cookie_.data(), cookie_bytes);
  *size = cookie_bytes;
  return 1;
}
int SecureChannel::Implementation::check_cookie(SSL* ssl, const unsigned char* cookie, unsigned size) {
  return size == cookie_bytes && CRYPTO_memcmp(cookie, of(ssl).cookie_.data(), cookie_bytes) == 0 ? 1 : 0;
}

Check SecureChannel::Implementation::start() {
  const bool client = role_ == HandshakeRole::client;
  context_.reset(SSL_CTX_new(client ? DTLS_client_method() : DTLS_server_method()));
  method_.reset(new_wire_method());
  const bool good = context_ && method_ && draw_cookie() &&
                    SSL_CTX_set_min_proto_version(context_.get(), DTLS1_2_VERSION) == 1 &&
                    SSL_CTX_set_max_proto_version(context_.get(), DTLS1_2_VERSION) == 1 &&
                    SSL_CTX_set_cipher_list(context_.get(), cipher_suite) == 1 &&
                    SSL_CTX_set1_groups_list(context_.get(), "X25519") == 1;
  if (good) {
    SSL_CTX_set_app_data(context_.get(), this);
    SSL_CTX_set_options(context_.get(),
                        SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_TICKET | SSL_OP_NO_QUERY_MTU | SSL_OP_COOKIE_EXCHANGE);
    SSL_CTX_set_session_cache_mode(context_.get(), SSL_SESS_CACHE_OFF);
    SSL_CTX_set_psk_client_callback(context_.get(), give_key);
    SSL_CTX_set_psk_server_callback(context_.get(), find_key);
    SSL_CTX_set_cookie_generate_cb(context_.get(), write_cookie);
    SSL_CTX_set_cookie_verify_cb(context_.get(), check_cookie);
  }
  ERR_clear_error();
  if (!good) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = std::string("OpenSSL cannot do DTLS 1.2 with ") + cipher_suite +
                            ": install OpenSSL 3 with its default provider",
                 .place = {}};
  }
  static_cast<void>(admit_records(socket_->descriptor(), message_bytes_, 0));
  thread_ = std::thread([this] { shake_hands(); });
  return std::nullopt;
}

bool SecureChannel::Implementation::open(const Packet& packet, std::span<std::byte> message) noexcept {
  adopt();
  const bool record = packet.size >= record_header_bytes && packet.data[1] == std::byte{0xfe} &&
                      (packet.data[2] == std::byte{0xfd} || packet.data[2] == std::byte{0xff});
  const std::byte type = packet.data[0];
  if (record && (type == handshake || type == change_cipher_spec || type == alert)) {
    pass_on(packet);
    return false;
  }
  if (record && type == application_data && packet.size == message_bytes_ + overhead_bytes) {
    const std::uint64_t number = number_of(packet);
    // What OpenSSL would refuse for its number costs less when it is refused here.
    const std::uint64_t newest = newest_.load(std::memory_order_relaxed);
    if (current_ != nullptr && number + window > newest) {
      current_->feed(packet.bytes());
      const int size = SSL_read(current_->ssl.get(), message.data(), static_cast<int>(message.size()));
      if (size == static_cast<int>(message_bytes_)) {
        ++counters_.opened;
        newest_.store(std::max(newest, number), std::memory_order_relaxed);
        heard_ns_.store(monotonic_ns(), std::memory_order_relaxed);
        return true;
      }
      ERR_clear_error();
    }
    if (wants_proof_.load(std::memory_order_relaxed)) {
      pass_on(packet);
      return false;
    }
  }
  ++counters_.refused;
  return false;
}

bool SecureChannel::Implementation::send(std::span<const std::byte> message) noexcept {
  adopt();
  if (current_ == nullptr) return false;
  if (SSL_write(current_->ssl.get(), message.data(), static_cast<int>(message.size())) > 0) return true;
  ERR_clear_error();
  return false;
}

void SecureChannel::Implementation::adopt() noexcept {
  if (ready_.load(std::memory_order_relaxed) == nullptr || retired_.load(std::memory_order_acquire) != nullptr) return;
  newest_.store(0, std::memory_order_relaxed);  // before it is seen that nothing is ready: see `filter`
  Connection* fresh = ready_.exchange(nullptr, std::memory_order_acq_rel);
  retired_.store(std::exchange(current_, fresh), std::memory_order_release);
  ++counters_.handshakes;
}

void SecureChannel::Implementation::pass_on(const Packet& packet) noexcept {
  HandshakePacket copy;
  std::memcpy(copy.data.data(), packet.data.data(), packet.size);
  copy.size = packet.size;
  ++(handshake_packets_.try_push(copy) ? counters_.handshake_packets : counters_.overflowed);
}

void SecureChannel::Implementation::shake_hands() {
  using namespace std::chrono_literals;
  HandshakePacket packet;
  while (!stop_.load(std::memory_order_relaxed)) {
    delete retired_.exchange(nullptr, std::memory_order_acq_rel);
    while (handshake_packets_.try_pop(packet)) take({packet.data.data(), packet.size});
    const std::int64_t now_ns = monotonic_ns();
    const bool silent =
        static_cast<double>(now_ns - heard_ns_.load(std::memory_order_relaxed)) > silence_before_handshake_s * 1e9;
    if (role_ == HandshakeRole::client && !pending_ && silent && ready_.load(std::memory_order_relaxed) == nullptr) {
      pending_ = connect();
      if (pending_) SSL_set_connect_state(pending_->ssl.get());
    }
    if (pending_) {
      if (now_ns - pending_->begun_ns > patience_ns) {
        drop_pending();
      } else {
        if (DTLSv1_handle_timeout(pending_->ssl.get()) < 0) {
          drop_pending();
        } else {
          advance();
        }
      }
    }
    filter(now_ns);
    ERR_clear_error();
    std::this_thread::sleep_for(pending_ ? 1ms : 5ms);
  }
}

std::unique_ptr<Connection> SecureChannel::Implementation::connect() {
  auto connection = std::make_unique<Connection>();
  connection->wire.socket = socket_;
  connection->begun_ns = monotonic_ns();
  connection->ssl.reset(SSL_new(context_.get()));
  BIO* bio = new_wire(method_.get(), connection->wire);
  if (!connection->ssl || bio == nullptr) {
    BIO_free(bio);
    return nullptr;
  }
  SSL_set_bio(connection->ssl.get(), bio, bio);
  SSL_set_mtu(connection->ssl.get(), DtlsWire::mtu_bytes);
  DTLS_set_timer_cb(connection->ssl.get(), retransmission_us);
  return connection;
}

void SecureChannel::Implementation::take(std::span<const std::byte> packet) {
  if (!pending_) {
    if (role_ == HandshakeRole::client) return;
    // Without a cookie the listener only answers with one; nothing of it stays.
    auto listener = connect();
    const Peer peer(BIO_ADDR_new());
    if (!listener || !peer) return;
    listener->feed(packet);
    if (DTLSv1_listen(listener->ssl.get(), peer.get()) != 1) {
      ERR_clear_error();
      return;
    }
    pending_ = std::move(listener);
  } else {
    pending_->feed(packet);
  }
  advance();
}

void SecureChannel::Implementation::advance() {
  SSL* ssl = pending_->ssl.get();
  if (!shaken_) {
    const int result = SSL_do_handshake(ssl);
    if (result != 1) {
      const int why = SSL_get_error(ssl, result);
      if (why != SSL_ERROR_WANT_READ && why != SSL_ERROR_WANT_WRITE) drop_pending();
      return;
    }
    shaken_ = true;
    wants_proof_.store(role_ == HandshakeRole::server, std::memory_order_relaxed);
  }
  // The client has seen that the server knows the key. The server is done when the client's first message shows that
  // its own last packets arrived; until then it must be able to send them again.
  if (role_ == HandshakeRole::client) return publish();
  std::array<std::byte, Packet::longest> message;
  const int result = SSL_read(ssl, message.data(), static_cast<int>(message.size()));
  if (result > 0) return publish();
  const int why = SSL_get_error(ssl, result);
  if (why != SSL_ERROR_WANT_READ && why != SSL_ERROR_WANT_WRITE) drop_pending();
}

void SecureChannel::Implementation::publish() {
  wants_proof_.store(false, std::memory_order_relaxed);
  shaken_ = false;
  draw_cookie();
  heard_ns_.store(monotonic_ns(), std::memory_order_relaxed);
  delete ready_.exchange(pending_.release(), std::memory_order_acq_rel);
}

void SecureChannel::Implementation::drop_pending() {
  wants_proof_.store(false, std::memory_order_relaxed);
  shaken_ = false;
  pending_.reset();
  draw_cookie();
}

/// What OpenSSL would refuse for its number does not get to the servo's thread. While other keys may come, whose
/// numbers begin anew, all numbers do. Without a filter more is judged there, that is all.
void SecureChannel::Implementation::filter(std::int64_t now_ns) {
  const bool settled = !pending_ && ready_.load(std::memory_order_acquire) == nullptr;
  const std::uint64_t newest = settled ? newest_.load(std::memory_order_relaxed) : 0;
  const std::uint64_t least = newest > window ? newest - window : 0;
  if (least == admitted_ || (least > 0 && now_ns - filtered_ns_ < filter_every_ns)) return;
  static_cast<void>(admit_records(socket_->descriptor(), message_bytes_, least));
  admitted_ = least;
  filtered_ns_ = now_ns;
}

SecureChannel::SecureChannel(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
SecureChannel::SecureChannel(SecureChannel&&) noexcept = default;
SecureChannel& SecureChannel::operator=(SecureChannel&&) noexcept = default;
SecureChannel::~SecureChannel() = default;

Result<SecureChannel> SecureChannel::make(HandshakeRole role, const Key& key, const Socket& socket,
                                          std::size_t message_bytes) {
  auto implementation = std::make_unique<Implementation>(role, key, socket, message_bytes);
  if (auto error = implementation->start()) return *std::move(error);
  return SecureChannel(std::move(implementation));
}

bool SecureChannel::open(const Packet& packet, std::span<std::byte> message) noexcept {
  return implementation_->open(packet, message);
}
bool SecureChannel::send(std::span<const std::byte> message) noexcept { return implementation_->send(message); }
bool SecureChannel::established() const noexcept { return implementation_->established(); }
SecureChannel::Counters SecureChannel::counters() const noexcept { return implementation_->counters(); }

}  // namespace tactus::link
