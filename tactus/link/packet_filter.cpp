#include <tactus/link/packet_filter.hpp>
#include <tactus/link/secure_channel.hpp>

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

bool admit_records(int descriptor, std::size_t message_bytes, std::uint64_t least) noexcept {
  constexpr std::uint32_t content_type = 23, first_handshake_type = 20, other_types = 24;
  const auto record = static_cast<std::uint32_t>(udp_head + message_bytes + SecureChannel::overhead_bytes);
  const auto upper = static_cast<std::uint32_t>(least >> 32), lower = static_cast<std::uint32_t>(least);
  return attach(descriptor, std::array{load(BPF_B, 1),
                                       equal(0xfe, 0, 17),  // version 1.0 or 1.2
                                       load(BPF_B, 2),
                                       equal(0xfd, 1, 0),
                                       equal(0xff, 0, 14),  //
                                       load(BPF_B, 0),
                                       equal(content_type, 2, 0),  //
                                       at_least(first_handshake_type, 0, 11),
                                       at_least(other_types, 10, 9),
                                       load(BPF_H, 3),
                                       equal(1, 0, 8),  // epoch
                                       load(BPF_H, 5),
                                       more_than(upper, 3, 0),
                                       equal(upper, 0, 5),  // number
                                       load(BPF_W, 7),
                                       at_least(lower, 0, 3),  //
                                       load_size(),
                                       equal(record, 0, 1),
                                       admit(),
                                       drop()});
}

}  // namespace tactus::link
