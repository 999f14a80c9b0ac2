// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/link/key.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace tactus::link {

/// What goes around the records of a hand-shake, so that nothing is done for a stranger: who sends, which session of
/// the other site it answers, a number, and a tag that only who knows the key can make. A frame without records is a
/// greeting. docs/reference/wire-format.md shows the bytes.
struct HandshakeFrame {
  std::uint64_t session = 0;             ///< drawn by the sender for this hand-shake, never 0
  std::uint64_t peer = 0;                ///< the session of the other site that it answers, 0 for none
  std::uint64_t number = 0;              ///< from 1, one more for each frame of the sender
  std::span<const std::byte> records{};  ///< of DTLS
  std::uint16_t version = datagram_version;
  std::uint8_t joints = 1;  ///< that the sender has: set by `read`
};

inline constexpr std::size_t frame_head_bytes = 32;
inline constexpr std::size_t frame_tag_bytes = 16;
/// A hand-shake with a pre-shared key needs no more in one datagram.
inline constexpr std::size_t most_record_bytes = 512;
inline constexpr std::size_t shortest_frame_bytes = frame_head_bytes + frame_tag_bytes;
inline constexpr std::size_t longest_frame_bytes = shortest_frame_bytes + most_record_bytes;
using FrameBytes = std::array<std::byte, longest_frame_bytes>;

/// The first bytes of every frame: magic, version and who sends are there in every version of the format.
inline constexpr std::uint32_t frame_magic = 0x48544354;  // "TCTH" in the order of the bytes
inline constexpr std::size_t frame_site_at = 6;

/// Whether bytes begin as a frame and can be one by their size, whoever made it. Real-time safe.
bool is_a_frame(std::span<const std::byte> bytes) noexcept;

/// Writes the frames of one site and reads those of the other. The tag is SipHash-2-4 (J.-P. Aumasson and
/// D. J. Bernstein, INDOCRYPT 2012), 128 bits wide, under a key that HKDF (RFC 5869) derives from the shared one for
/// this alone. By OpenSSL. Belongs to one thread.
class FrameTags {
 public:
  /// Of a site of so many joints. Errors: `failed` where OpenSSL lacks something.
  static Result<FrameTags> make(const Key& key, SiteRole own_site, std::size_t joints = 1);
  FrameTags(FrameTags&&) noexcept;
  FrameTags& operator=(FrameTags&&) noexcept;
  ~FrameTags();

  /// The bytes of a frame of this site, with its number of joints and at most `most_record_bytes` of records, which
  /// are in `bytes`. Real-time safe.
  std::span<const std::byte> write(const HandshakeFrame& frame, FrameBytes& bytes) noexcept;

  enum class Verdict : std::uint8_t {
    none,     ///< no frame of the other site, by size and first bytes
    forged,   ///< made by somebody without the key, or damaged
    version,  ///< made with the key, in another version of the format
    joints,   ///< made with the key, by a site of another number of joints
    genuine,
  };
  /// What bytes from anywhere contain, for the price of one tag at most. `frame` is filled where it is genuine or of
  /// another number of joints, its records being among the bytes; of one of another version only that. Real-time safe.
  Verdict read(std::span<const std::byte> bytes, HandshakeFrame& frame) noexcept;

 private:
  class Mac;
  FrameTags(std::unique_ptr<Mac> mac, SiteRole own_site, std::size_t joints);
  std::unique_ptr<Mac> mac_;
  SiteRole own_site_;
  std::uint8_t joints_;
};

}  // namespace tactus::link
