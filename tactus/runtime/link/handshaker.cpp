// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/internal/handshaker.hpp>

#include <algorithm>
#include <utility>

#include <sys/random.h>

namespace tactus::link {

namespace {

/// A hand-shake that takes longer is given up, and its memory with it.
constexpr std::int64_t timeout_ns = 2'000'000'000;
constexpr std::int64_t greeting_every_ns = 50'000'000;

}  // namespace

Check Handshaker::start() {
  if (server_ && !draw_session()) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "the operating system gave no random number for a hand-shake",
                 .place = {}};
  }
  return dtls_.start();
}

/// Whoever answers the session before comes too late.
bool Handshaker::draw_session() {
  std::uint64_t drawn = 0;
  if (getrandom(&drawn, sizeof(drawn), 0) != static_cast<ssize_t>(sizeof(drawn)) || drawn == 0) return false;
  own_ = drawn;
  inbox_->expect(own_, 0);
  return true;
}

std::unique_ptr<Connection> Handshaker::work(bool wanted, std::int64_t now_ns) {
  HandshakeLetter letter;
  while (inbox_->next_beginning(letter)) take_beginning(letter, now_ns);
  while (inbox_->next_under_way(letter)) {
    // It may have waited for longer than the hand-shake that it is of.
    if (!pending_ || letter.session != pending_->other_session() || letter.peer != own_) continue;
    newest_ = std::max(newest_, letter.number);
    if (letter.size > 0) advance(letter.records());
  }
  if (busy() && now_ns - begun_ns_ > timeout_ns) give_up();
  if (!server_ && wanted && !busy()) begin(now_ns);
  if (pending_ && !shaken_) advance({});
  if (!server_ && busy() && !pending_ && now_ns - greeted_ns_ >= greeting_every_ns) {
    frames_.send(own_, 0);
    greeted_ns_ = now_ns;
  }
  // The client has seen that the server knows the key.
  return !server_ && shaken_ ? finished() : nullptr;
}

void Handshaker::begin(std::int64_t now_ns) {
  if (!draw_session()) return;
  begun_ns_ = now_ns;
  greeted_ns_ = now_ns - greeting_every_ns;
  newest_ = 0;
}

void Handshaker::take_beginning(const HandshakeLetter& letter, std::int64_t now_ns) {
  if (letter.peer != own_ || own_ == 0) {
    // Whoever it is, perhaps a recording, must answer this session first.
    if (server_) frames_.send(own_, letter.session);
    return;
  }
  const bool has_records = letter.size > 0;
  if (pending_ && letter.session == pending_->other_session()) {
    if (has_records) advance(letter.records());
  } else if (server_) {
    if (pending_ || !has_records) return;
    begun_ns_ = now_ns;
    connect(letter.session);
    if (pending_) advance(letter.records());
  } else if (letter.number > newest_) {
    newest_ = letter.number;
    if (pending_) {
      // The server has begun anew in the meantime.
      give_up();
    } else {
      connect(letter.session);
    }
  }
}

void Handshaker::connect(std::uint64_t other) {
  pending_ = dtls_.connect(*socket_, frames_, own_, other);
  if (pending_) inbox_->expect(own_, other);
}

void Handshaker::advance(std::span<const std::byte> records) {
  if (shaken_) {
    // The client sends its last records again: the server's were lost, and reading these sends them again.
    pending_->proves(records);
    return;
  }
  switch (pending_->shake_hands(records)) {
    case Connection::Progress::waits:
      break;
    case Connection::Progress::done:
      shaken_ = true;
      break;
    case Connection::Progress::failed:
      give_up();
      break;
  }
}

std::unique_ptr<Connection> Handshaker::prove(std::span<const std::byte> record) {
  return pending_ && shaken_ && pending_->proves(record) ? finished() : nullptr;
}

std::unique_ptr<Connection> Handshaker::finished() {
  auto connection = std::move(pending_);
  connection->finish();
  give_up();
  return connection;
}

void Handshaker::give_up() {
  pending_ = nullptr;
  shaken_ = false;
  if (server_) {
    draw_session();
  } else {
    own_ = 0;
    inbox_->expect(0, 0);
  }
}

}  // namespace tactus::link
