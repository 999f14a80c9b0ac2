// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/ring.hpp>
#include <tactus/runtime/link/handshake_frame.hpp>
#include <tactus/runtime/link/replay_window.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus::link {

/// Records of a hand-shake on their way between two threads.
struct HandshakeLetter {
  std::uint64_t session = 0, peer = 0, number = 0;  ///< as in `HandshakeFrame`
  std::size_t size = 0;
  std::array<std::byte, most_record_bytes> data;
  [[nodiscard]] std::span<const std::byte> records() const noexcept { return {data.data(), size}; }
};

/// Where the servo's thread puts genuine frames for the thread of the hand-shakes. What a stranger has recorded and
/// sends again is genuine too, so there are two queues: frames of the hand-shake under way, each of which comes in
/// once, and beginnings, any of which may be a recording. However many of those come, the former find room.
class HandshakeInbox {
 public:
  /// A server lets every beginning in; a client only those that answer it.
  explicit HandshakeInbox(SiteRole own_site) : server_(own_site == SiteRole::slave) {}

  // The thread of the hand-shakes.

  /// From now on frames shall answer `own`; 0 is none. `other` is the session of the other site with which hands are
  /// being shaken; 0 is none yet.
  void expect(std::uint64_t own, std::uint64_t other) noexcept {
    own_.store(own, std::memory_order_relaxed);
    other_.store(other, std::memory_order_relaxed);
  }
  bool next_beginning(HandshakeLetter& letter) noexcept { return beginnings_.try_pop(letter); }
  bool next_under_way(HandshakeLetter& letter) noexcept { return under_way_.try_pop(letter); }

  // The servo's thread.

  enum class Verdict : std::uint8_t { passed_on, refused, full };
  /// Passes a frame on, of the hand-shake under way each once. Real-time safe.
  Verdict take(const HandshakeFrame& frame) noexcept {
    // A glance between the two stores of `expect` costs a frame, which is sent again.
    const std::uint64_t own = own_.load(std::memory_order_relaxed), other = other_.load(std::memory_order_relaxed);
    const bool under_way = other != 0 && frame.session == other && frame.peer == own;
    if (under_way) {
      if (own != window_own_ || other != window_other_) {
        window_ = {};
        window_own_ = own;
        window_other_ = other;
      }
      if (window_.judge(frame.number) == ReplayWindow::Verdict::repeated) return Verdict::refused;
    } else if (!server_ && (own == 0 || frame.peer != own)) {
      return Verdict::refused;
    }
    HandshakeLetter letter;
    letter.session = frame.session;
    letter.peer = frame.peer;
    letter.number = frame.number;
    letter.size = frame.records.size();
    std::copy(frame.records.begin(), frame.records.end(), letter.data.begin());
    const bool passed = under_way ? under_way_.try_push(letter) : beginnings_.try_push(letter);
    return passed ? Verdict::passed_on : Verdict::full;
  }

 private:
  bool server_;
  std::atomic<std::uint64_t> own_{0}, other_{0};
  ReplayWindow window_;  ///< of the servo's thread, as what follows
  std::uint64_t window_own_ = 0, window_other_ = 0;
  telemetry::Ring<HandshakeLetter, 16> under_way_;
  telemetry::Ring<HandshakeLetter, 128> beginnings_;
};

}  // namespace tactus::link
