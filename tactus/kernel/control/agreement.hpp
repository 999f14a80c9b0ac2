// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

/// How two sites find out that they do not work by the same parameters, from a few bytes in each packet.
namespace tactus::control {

/// What a packet states of the sender's agreement: the digest of all of it, and one cell, another one in each packet.
struct AgreementExcerpt {
  std::uint64_t digest = 0;
  std::uint64_t cell = 0;   ///< its number
  std::uint64_t value = 0;  ///< its bits
};

/// What a site must have in common with the other, in cells of eight bytes. `agreement_of` makes it of parameters; one
/// without a cell agrees with its like.
class Agreement {
 public:
  static constexpr std::size_t most_cells = 512;

  Agreement() = default;
  /// The one that gave this digest and these cells, at most `most_cells`; it sends and decides the same.
  Agreement(std::uint64_t digest, std::span<const std::uint64_t> cells) noexcept : digest_(digest) {
    for (const std::uint64_t value : cells) {
      if (size_ < most_cells) cells_[size_++] = value;
    }
  }

  /// Adds a cell, and both to the digest. What has no room is in the digest alone.
  void add(std::string_view key, std::uint64_t value) noexcept {
    add_to_digest(key);
    for (int shift = 0; shift < 64; shift += 8) fold(static_cast<unsigned char>(value >> shift));
    if (size_ < most_cells) cells_[size_++] = value;
  }
  /// Adds what no cell carries.
  void add_to_digest(std::string_view text) noexcept {
    for (const char letter : text) fold(static_cast<unsigned char>(letter));
  }

  /// Of all that was added, in order: FNV-1, 64 bits wide. It distinguishes mistakes, not forgeries: the link does
  /// those.
  [[nodiscard]] std::uint64_t digest() const noexcept { return digest_; }
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] std::uint64_t operator[](std::size_t cell) const noexcept { return cells_[cell]; }
  /// What packet number `count` states.
  [[nodiscard]] AgreementExcerpt excerpt(std::int64_t count) const noexcept {
    if (size_ == 0) return {.digest = digest_};
    const std::size_t cell = static_cast<std::size_t>(count) % size_;
    return {.digest = digest_, .cell = cell, .value = cells_[cell]};
  }

 private:
  void fold(unsigned char byte) noexcept { digest_ = (digest_ * 0x100000001b3U) ^ byte; }

  std::uint64_t digest_ = 0;
  std::size_t size_ = 0;
  std::array<std::uint64_t, most_cells> cells_{};
};

/// What the other site states, alongside the own agreement. The digest alone decides; the cells are for words.
/// Real-time safe.
class AgreementCheck {
 public:
  explicit AgreementCheck(const Agreement& own = {}) : own_(own) {}

  /// What a packet of the other site's `session` states.
  void take(std::int64_t session, const AgreementExcerpt& said) noexcept {
    if (session != session_) {
      session_ = session;
      told_ = {};
      count_ = first_ = 0;
    }
    digest_ = said.digest;
    if (said.cell >= own_.size() || told_[said.cell]) return;
    told_[said.cell] = true;
    other_[said.cell] = said.value;
    ++count_;
    const std::size_t number = static_cast<std::size_t>(said.cell) + 1;
    if (said.value != own_[said.cell] && (first_ == 0 || number < first_)) first_ = number;
  }

  /// Whether the other site was received and works by other parameters.
  [[nodiscard]] bool disagrees() const noexcept { return session_ != 0 && digest_ != own_.digest(); }
  /// Whether all of its cells were received.
  [[nodiscard]] bool complete() const noexcept { return count_ == own_.size(); }
  /// Number of the first cell known to differ, from 1; 0 for none.
  [[nodiscard]] std::size_t first_difference() const noexcept { return first_; }
  [[nodiscard]] std::int64_t session() const noexcept { return session_; }
  [[nodiscard]] const Agreement& own() const noexcept { return own_; }
  /// The other site's; 0 where it was not reported.
  [[nodiscard]] std::uint64_t other(std::size_t cell) const noexcept { return told_[cell] ? other_[cell] : 0; }

 private:
  Agreement own_;
  std::int64_t session_ = 0;
  std::uint64_t digest_ = 0;
  std::size_t count_ = 0;  ///< of the cells that were sent
  std::size_t first_ = 0;
  std::array<bool, Agreement::most_cells> told_{};
  std::array<std::uint64_t, Agreement::most_cells> other_{};
};

}  // namespace tactus::control
