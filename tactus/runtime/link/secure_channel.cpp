// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/internal/handshaker.hpp>
#include <tactus/runtime/link/packet_filter.hpp>
#include <tactus/runtime/link/secure_channel.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace tactus::link {

namespace {

/// Where the number of a DTLS record stands, highest byte first (RFC 6347, Sec. 4.1).
constexpr std::size_t number_at = 5, number_end = 11;
/// OpenSSL knows of so many numbers up to the newest which it has seen, and refuses all before.
constexpr std::uint64_t window = 64;
/// How often the kernel is told from which number on records are let in.
constexpr std::int64_t filter_every_ns = 50'000'000;
/// How often a site without a link shows a stranger that it is there.
constexpr std::int64_t stranger_every_ns = 1'000'000'000;

/// The number of a record in its epoch.
std::uint64_t number_of(const Received& packet) noexcept {
  std::uint64_t number = 0;
  for (std::size_t i = number_at; i < number_end; ++i) {
    number = number << 8 | std::to_integer<std::uint64_t>(packet.data[i]);
  }
  return number;
}

/// A message that may prove that the client has its keys. The client sends another at its next tick.
struct Proof {
  std::array<std::byte, longest_datagram_bytes + SecureChannel::overhead_bytes> data;
  std::size_t size;
};

}  // namespace

class SecureChannel::Implementation {
 public:
  Implementation(SiteRole own_site, const Key& key, const Socket& socket, std::size_t message_bytes, FrameTags tags,
                 FrameSender frames)
      : own_site_(own_site),
        socket_(&socket),
        message_bytes_(message_bytes),
        tags_(std::move(tags)),
        inbox_(own_site),
        handshaker_(own_site, key, socket, std::move(frames), inbox_) {}
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
  bool open(const Received& packet, std::span<std::byte> message) noexcept;
  bool send(std::span<const std::byte> message) noexcept;
  [[nodiscard]] bool established() const noexcept { return current_ != nullptr; }
  [[nodiscard]] Counters counters() const noexcept { return counters_; }

 private:
  bool open_message(const Received& packet, std::span<std::byte> message) noexcept;
  void take_frame(const Received& packet) noexcept;
  void adopt() noexcept;

  // The thread of the hand-shakes.
  void shake_hands();
  void publish(std::unique_ptr<Connection> connection);
  void filter(bool silent, std::int64_t now_ns);

  SiteRole own_site_;
  const Socket* socket_;
  std::size_t message_bytes_;

  FrameTags tags_;  ///< of the servo's thread, as what follows
  Connection* current_ = nullptr;
  Counters counters_;

  HandshakeInbox inbox_;
  Handshaker handshaker_;         ///< of the other one, as what follows
  std::uint64_t admitted_ = 0;    ///< the least number that the kernel lets in
  std::int64_t filtered_ns_ = 0;  ///< when it was told
  std::int64_t answered_ns_ = 0;  ///< when a stranger was shown that there is a site

  telemetry::Ring<Proof, 16> proofs_;
  std::atomic<Connection*> ready_{nullptr};    ///< with new keys, for the servo to pick up
  std::atomic<Connection*> retired_{nullptr};  ///< with old keys, for the other thread to free
  std::atomic<bool> wants_proof_{false};       ///< an open hand-shake may be what a message is sealed for
  std::atomic<std::int64_t> received_ns_{0};   ///< when the last authentic message came
  std::atomic<std::uint64_t> newest_{0};       ///< number of an authentic record of the current connection
  std::atomic<bool> stranger_{false};          ///< somebody without the key has sent something
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

Check SecureChannel::Implementation::start() {
  if (auto error = handshaker_.start()) return error;
  static_cast<void>(admit_records(socket_->descriptor(), own_site_, message_bytes_, 0));
  thread_ = std::thread([this] { shake_hands(); });
  return std::nullopt;
}

bool SecureChannel::Implementation::open(const Received& packet, std::span<std::byte> message) noexcept {
  adopt();
  const bool record = packet.size == message_bytes_ + overhead_bytes && packet.data[0] == message_record &&
                      packet.data[1] == std::byte{0xfe} && packet.data[2] == std::byte{0xfd};
  if (record) return open_message(packet, message);
  take_frame(packet);
  return false;
}

bool SecureChannel::Implementation::open_message(const Received& packet, std::span<std::byte> message) noexcept {
  const std::uint64_t number = number_of(packet);
  // What OpenSSL would refuse for its number costs less when it is refused here.
  const std::uint64_t newest = newest_.load(std::memory_order_relaxed);
  if (current_ != nullptr && number + window > newest && current_->open(packet.bytes(), message) == message_bytes_) {
    ++counters_.opened;
    newest_.store(std::max(newest, number), std::memory_order_relaxed);
    received_ns_.store(monotonic_ns(), std::memory_order_relaxed);
    return true;
  }
  if (wants_proof_.load(std::memory_order_relaxed)) {
    Proof proof;
    std::memcpy(proof.data.data(), packet.data.data(), packet.size);
    proof.size = packet.size;
    ++(proofs_.try_push(proof) ? counters_.handshake_packets : counters_.overflowed);
  } else {
    ++counters_.refused;
  }
  return false;
}

void SecureChannel::Implementation::take_frame(const Received& packet) noexcept {
  HandshakeFrame frame;
  const auto verdict = tags_.read(packet.bytes(), frame);
  if (verdict == FrameTags::Verdict::version) counters_.other_version = frame.version;
  if (verdict == FrameTags::Verdict::joints) counters_.other_joints = frame.joints;
  const bool plain = verdict == FrameTags::Verdict::none && looks_like_a_datagram(packet.bytes());
  if (verdict == FrameTags::Verdict::forged) ++counters_.forged;
  if (plain) ++counters_.plain;
  if (plain || verdict == FrameTags::Verdict::forged) stranger_.store(true, std::memory_order_relaxed);
  // A site of other joints is greeted back, so that it knows too, and no more.
  const bool greets = verdict == FrameTags::Verdict::joints && own_site_ == SiteRole::slave && frame.records.empty();
  const auto passed =
      verdict == FrameTags::Verdict::genuine || greets ? inbox_.take(frame) : HandshakeInbox::Verdict::refused;
  switch (passed) {
    case HandshakeInbox::Verdict::passed_on:
      ++counters_.handshake_packets;
      break;
    case HandshakeInbox::Verdict::refused:
      ++counters_.refused;
      break;
    case HandshakeInbox::Verdict::full:
      ++counters_.overflowed;
      break;
  }
}

bool SecureChannel::Implementation::send(std::span<const std::byte> message) noexcept {
  adopt();
  return current_ != nullptr && current_->send(message);
}

void SecureChannel::Implementation::adopt() noexcept {
  if (ready_.load(std::memory_order_relaxed) == nullptr || retired_.load(std::memory_order_acquire) != nullptr) return;
  newest_.store(0, std::memory_order_relaxed);  // before it is seen that nothing is ready: see `filter`
  Connection* fresh = ready_.exchange(nullptr, std::memory_order_acq_rel);
  retired_.store(std::exchange(current_, fresh), std::memory_order_release);
  ++counters_.handshakes;
}

void SecureChannel::Implementation::shake_hands() {
  using namespace std::chrono_literals;
  Proof proof;
  while (!stop_.load(std::memory_order_relaxed)) {
    delete retired_.exchange(nullptr, std::memory_order_acq_rel);
    const std::int64_t now_ns = monotonic_ns();
    const bool silent =
        static_cast<double>(now_ns - received_ns_.load(std::memory_order_relaxed)) > silence_before_handshake_s * 1e9;
    publish(handshaker_.work(silent && ready_.load(std::memory_order_relaxed) == nullptr, now_ns));
    while (proofs_.try_pop(proof)) publish(handshaker_.prove({proof.data.data(), proof.size}));
    wants_proof_.store(handshaker_.wants_proof(), std::memory_order_relaxed);
    // Once a second at most and to the other site's address alone, so that whoever is there learns of another key, and
    // nobody else gets anything for what he sends.
    if (silent && now_ns - answered_ns_ > stranger_every_ns && stranger_.exchange(false, std::memory_order_relaxed)) {
      handshaker_.show_itself();
      answered_ns_ = now_ns;
    }
    filter(silent, now_ns);
    std::this_thread::sleep_for(handshaker_.busy() ? 1ms : 5ms);
  }
}

void SecureChannel::Implementation::publish(std::unique_ptr<Connection> connection) {
  if (!connection) return;
  received_ns_.store(monotonic_ns(), std::memory_order_relaxed);
  delete ready_.exchange(connection.release(), std::memory_order_acq_rel);
}

/// What OpenSSL would refuse for its number does not get to the servo's thread. While other keys may come, whose
/// numbers begin anew, and while there is no link, all numbers do. Without a filter more is judged there, that is all.
void SecureChannel::Implementation::filter(bool silent, std::int64_t now_ns) {
  const bool settled = !silent && !handshaker_.busy() && ready_.load(std::memory_order_acquire) == nullptr;
  const std::uint64_t newest = settled ? newest_.load(std::memory_order_relaxed) : 0;
  const std::uint64_t least = newest > window ? newest - window : 0;
  if (least == admitted_ || (least > 0 && now_ns - filtered_ns_ < filter_every_ns)) return;
  static_cast<void>(admit_records(socket_->descriptor(), own_site_, message_bytes_, least));
  admitted_ = least;
  filtered_ns_ = now_ns;
}

SecureChannel::SecureChannel(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}
SecureChannel::SecureChannel(SecureChannel&&) noexcept = default;
SecureChannel& SecureChannel::operator=(SecureChannel&&) noexcept = default;
SecureChannel::~SecureChannel() = default;

Result<SecureChannel> SecureChannel::make(SiteRole own_site, const Key& key, const Socket& socket, std::size_t joints) {
  auto reading = FrameTags::make(key, own_site, joints), writing = FrameTags::make(key, own_site, joints);
  if (!reading) return reading.error();
  if (!writing) return writing.error();
  auto implementation = std::make_unique<Implementation>(own_site, key, socket, datagram_bytes_of(joints),
                                                         *std::move(reading), FrameSender(socket, *std::move(writing)));
  if (auto error = implementation->start()) return *std::move(error);
  return SecureChannel(std::move(implementation));
}

bool SecureChannel::open(const Received& packet, std::span<std::byte> message) noexcept {
  return implementation_->open(packet, message);
}
bool SecureChannel::send(std::span<const std::byte> message) noexcept { return implementation_->send(message); }
bool SecureChannel::established() const noexcept { return implementation_->established(); }
SecureChannel::Counters SecureChannel::counters() const noexcept { return implementation_->counters(); }

}  // namespace tactus::link
