// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/application.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>

namespace tactus::live {

/// A frame on its way to a client: a head of its own before bytes that it may share with others.
struct Frame {
  bool binary = false;
  bool may_be_dropped = false;
  std::string head;
  Payload payload = {};  ///< may be null
  [[nodiscard]] std::size_t size() const { return head.size() + (payload ? payload->size() : 0); }
};

/// What waits to be sent to one client: never more than so many frames, bytes and answers. A client that does not keep
/// up loses the oldest of what may be dropped (samples, never answers), and the loss is counted. A push looks past no
/// more frames than there may be answers, whatever waits.
class Outbox {
 public:
  struct Limits {
    std::size_t frames = 8192;
    std::size_t bytes = std::size_t{8} * 1024 * 1024;
    std::size_t answers = 256;  ///< frames that may not be dropped
  };

  explicit Outbox(const Limits& limits) : limits_(limits) {}

  /// False where the frame may not be dropped and there are too many such, or no room even without all that may be: a
  /// client that asks and never reads the answers. The frame that is being sent is not touched.
  [[nodiscard]] bool push(Frame frame) {
    if (!frame.may_be_dropped) {
      if (answers_ == limits_.answers) return false;
      ++answers_;
    }
    bytes_ += frame.size();
    frames_.push_back(std::move(frame));
    std::size_t next = 0;
    while (size() > limits_.frames || bytes_ > limits_.bytes) {
      while (next < frames_.size() && !frames_[next].may_be_dropped) ++next;
      if (next == frames_.size()) return false;
      bytes_ -= frames_[next].size();
      frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(next));
      ++dropped_;
    }
    return true;
  }

  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] bool is_sending() const { return sending_.has_value(); }
  [[nodiscard]] std::size_t size() const { return frames_.size() + (sending_ ? 1 : 0); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Frames lost so far.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  /// So many frames are lost before they were made.
  void lose(std::size_t frames) { dropped_ += frames; }

  /// The oldest frame. It and its bytes stay where they are until `sent`, whatever is pushed meanwhile. There must be
  /// one, and none that is being sent.
  const Frame& begin_sending() {
    sending_ = std::move(frames_.front());
    frames_.pop_front();
    return *sending_;
  }
  void sent() {
    bytes_ -= sending_->size();
    if (!sending_->may_be_dropped) --answers_;
    sending_.reset();
  }

 private:
  Limits limits_;
  std::deque<Frame> frames_;
  std::optional<Frame> sending_;  ///< out of the queue, where a dropped frame moves its neighbours
  std::size_t bytes_ = 0;
  std::size_t answers_ = 0;
  std::uint64_t dropped_ = 0;
};

}  // namespace tactus::live
