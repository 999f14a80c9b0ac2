// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/handshake_frame.hpp>
#include <tactus/runtime/link/packet_filter.hpp>
#include <tactus/runtime/link/secure_channel.hpp>

#include <array>
#include <cstdint>

#include <linux/filter.h>
#include <sys/socket.h>

namespace tactus::link {

namespace {

/// A filter of a UDP socket sees the head of UDP too.
constexpr std::uint32_t udp_head = 8;

constexpr sock_filter load_size() { return BPF_STMT(BPF_LD | BPF_W | BPF_LEN, 0); }
/// Loads `BPF_B`, `BPF_H` or `BPF_W` from a place of the payload, highest byte first. Beyond its end: dropped.
constexpr sock_filter load(std::uint16_t width, std::uint32_t at) {
  return BPF_STMT(static_cast<std::uint16_t>(BPF_LD | width | BPF_ABS), udp_head + at);
}
/// So many instructions are left out where the value is, and is not, `value`.
constexpr sock_filter equal(std::uint32_t value, std::uint8_t if_so, std::uint8_t if_not) {
  return BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, value, if_so, if_not);
}
constexpr sock_filter at_least(std::uint32_t value, std::uint8_t if_so, std::uint8_t if_not) {
  return BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, value, if_so, if_not);
}
constexpr sock_filter more_than(std::uint32_t value, std::uint8_t if_so, std::uint8_t if_not) {
  return BPF_JUMP(BPF_JMP | BPF_JGT | BPF_K, value, if_so, if_not);
}
constexpr sock_filter admit() { return BPF_STMT(BPF_RET | BPF_K, 0xffffffff); }
constexpr sock_filter drop() { return BPF_STMT(BPF_RET | BPF_K, 0); }

template <std::size_t Count>
bool attach(int descriptor, std::array<sock_filter, Count> instructions) noexcept {
  const sock_fprog program{.len = static_cast<unsigned short>(Count), .filter = instructions.data()};
  return setsockopt(descriptor, SOL_SOCKET, SO_ATTACH_FILTER, &program, sizeof(program)) == 0;
}

}  // namespace

bool admit_records(int descriptor, SiteRole own_site, std::size_t message_bytes, std::uint64_t least) noexcept {
  constexpr std::uint32_t dtls_1_2 = 0xfefd, message_type = 23;
  // The kernel reads numbers highest byte first, as DTLS writes them; a frame has its lowest byte first.
  constexpr std::uint32_t head_of_a_frame =
      (frame_magic & 0xff) << 24 | (frame_magic & 0xff00) << 8 | (frame_magic >> 8 & 0xff00) | frame_magic >> 24;
  constexpr auto shortest = static_cast<std::uint32_t>(udp_head + shortest_frame_bytes);
  constexpr auto longest = static_cast<std::uint32_t>(udp_head + longest_frame_bytes);
  const std::uint32_t other = site_byte(own_site == SiteRole::master ? SiteRole::slave : SiteRole::master);
  const auto record = static_cast<std::uint32_t>(udp_head + message_bytes + SecureChannel::overhead_bytes);
  // "TCT" and any digit. With a link it is dropped as all else.
  constexpr std::uint32_t head_of_plain_text =
      (datagram_magic & 0xff) << 24 | (datagram_magic & 0xff00) << 8 | (datagram_magic >> 8 & 0xff00);
  const std::uint8_t plain_text_goes = least == 0 ? 13 : 14;
  const auto upper = static_cast<std::uint32_t>(least >> 32), lower = static_cast<std::uint32_t>(least);
  return attach(descriptor, std::array{load(BPF_W, 0),
                                       equal(head_of_a_frame, 0, 5),  // a frame
                                       load(BPF_B, frame_site_at),
                                       equal(other, 0, 19),
                                       load_size(),
                                       at_least(shortest, 0, 17),
                                       more_than(longest, 16, 15),
                                       sock_filter(BPF_STMT(BPF_ALU | BPF_AND | BPF_K, 0xffffff00)),
                                       equal(head_of_plain_text, plain_text_goes, 0),
                                       load(BPF_B, 0),  // a record
                                       equal(message_type, 0, 12),
                                       load(BPF_H, 1),
                                       equal(dtls_1_2, 0, 10),
                                       load(BPF_H, 3),
                                       equal(1, 0, 8),  // epoch
                                       load(BPF_H, 5),
                                       more_than(upper, 3, 0),
                                       equal(upper, 0, 5),  // number
                                       load(BPF_W, 7),
                                       at_least(lower, 0, 3),
                                       load_size(),
                                       equal(record, 0, 1),
                                       admit(),
                                       drop()});
}

}  // namespace tactus::link
