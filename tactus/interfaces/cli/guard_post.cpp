// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/guard_post.hpp>

#include <array>
#include <cerrno>
#include <cstring>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

/// A control message with one descriptor.
union Passed {
  std::array<char, CMSG_SPACE(sizeof(int))> bytes;
  cmsghdr aligned;
};

}  // namespace

bool send_to_guard(int socket, char word, int descriptor) noexcept {
  iovec text{.iov_base = &word, .iov_len = 1};
  msghdr message{};
  message.msg_iov = &text;
  message.msg_iovlen = 1;
  Passed passed{};
  if (descriptor >= 0) {
    message.msg_control = passed.bytes.data();
    message.msg_controllen = passed.bytes.size();
    cmsghdr* header = CMSG_FIRSTHDR(&message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(sizeof descriptor);
    std::memcpy(CMSG_DATA(header), &descriptor, sizeof descriptor);
  }
  ssize_t sent = -1;
  do {
    sent = sendmsg(socket, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  } while (sent < 0 && errno == EINTR);
  return sent == 1;
}

GuardWord receive_guard_word(int socket, int longest_ms) noexcept {
  pollfd input{.fd = socket, .events = POLLIN, .revents = 0};
  if (poll(&input, 1, longest_ms) <= 0) return {};
  GuardWord came;
  iovec text{.iov_base = &came.word, .iov_len = 1};
  msghdr message{};
  message.msg_iov = &text;
  message.msg_iovlen = 1;
  Passed passed{};
  message.msg_control = passed.bytes.data();
  message.msg_controllen = passed.bytes.size();
  ssize_t size = recvmsg(socket, &message, MSG_CMSG_CLOEXEC);
  if (size < 0 && errno == ENOTSOCK) {
    message.msg_controllen = 0;
    size = read(socket, &came.word, 1);
  }
  if (size < 0 && (errno == EINTR || errno == EAGAIN)) return {};
  came.kind = size > 0 ? GuardWord::Kind::word : GuardWord::Kind::end;
  const cmsghdr* header = CMSG_FIRSTHDR(&message);
  if (size > 0 && header != nullptr && header->cmsg_type == SCM_RIGHTS) {
    std::memcpy(&came.descriptor, CMSG_DATA(header), sizeof came.descriptor);
  }
  return came;
}

}  // namespace tactus::cli
