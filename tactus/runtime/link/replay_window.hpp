// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace tactus::link {

/// Determines for each sequence number whether it is newer than all before, late, or was seen already: the sliding
/// window of RFC 6347, Sec. 4.1.2.6, 64 numbers wide. What is older than the window counts as seen. Real-time safe.
class ReplayWindow {
 public:
  enum class Verdict { newest, late, repeated };

  Verdict judge(std::uint64_t sequence) noexcept {
    if (sequence > newest_) {
      const std::uint64_t ahead = sequence - newest_;
      seen_ = ahead < 64 ? (seen_ << ahead) | 1U : 1U;
      newest_ = sequence;
      return Verdict::newest;
    }
    const std::uint64_t behind = newest_ - sequence;
    if (sequence == 0 || behind >= 64 || ((seen_ >> behind) & 1U) != 0) return Verdict::repeated;
    seen_ |= std::uint64_t{1} << behind;
    return Verdict::late;
  }

  /// The highest number so far, 0 before the first.
  [[nodiscard]] std::uint64_t newest() const noexcept { return newest_; }

 private:
  std::uint64_t newest_ = 0;
  std::uint64_t seen_ = 0;  ///< bit i: `newest_ - i` was seen
};

}  // namespace tactus::link
