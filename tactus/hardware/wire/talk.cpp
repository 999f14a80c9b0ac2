// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/talk.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>
#include <string>
#include <system_error>

#include <poll.h>
#include <sys/prctl.h>
#include <time.h>
#include <unistd.h>

namespace tactus::wire {

namespace {

constexpr std::int64_t shortest_wait_ns = 50'000, longest_wait_ns = 20'000'000;
constexpr unsigned long timer_slack_ns = 1'000;

timespec timespec_of(std::int64_t ns) {
  constexpr std::int64_t second_ns = 1'000'000'000;
  return {.tv_sec = ns / second_ns, .tv_nsec = ns % second_ns};
}

bool nothing_now() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

Error gone(const Port& port, const std::string& why) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = "the port was closed (" + why +
                     "): plug the device in again, check its power and the output of dmesg, and start again",
          .place = port.path()};
}

/// What the port took only a part of. Nothing else may go before the rest of it.
class Remainder {
 public:
  [[nodiscard]] bool empty() const noexcept { return first_ == end_; }
  void keep(std::span<const std::uint8_t> bytes) noexcept {
    first_ = 0;
    end_ = std::min(bytes.size(), bytes_.size());
    std::copy_n(bytes.begin(), end_, bytes_.begin());
  }
  void write(const Port& port) noexcept { first_ += port.write({bytes_.data() + first_, end_ - first_}); }

 private:
  std::array<std::uint8_t, 4096> bytes_{};
  std::size_t first_ = 0, end_ = 0;
};

}  // namespace

std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

Check talk(WireEnd& end, Port& port, const std::function<bool()>& stop) {
  prctl(PR_SET_TIMERSLACK, timer_slack_ns, 0, 0, 0);
  const int descriptor = port.descriptor();
  std::array<std::uint8_t, 4096> bytes{};
  Remainder remainder;
  while (!stop()) {
    if (!remainder.empty()) remainder.write(port);
    const std::int64_t now_ns = monotonic_ns();
    for (auto packet = end.say(now_ns); !packet.empty(); packet = end.say(now_ns)) {
      if (!remainder.empty()) continue;
      const std::size_t written = port.write(packet);
      if (written > 0) remainder.keep(packet.subspan(written));
    }
    const std::int64_t wait_ns =
        std::clamp(end.wakes_ns() - std::min(now_ns, end.wakes_ns()), shortest_wait_ns, longest_wait_ns);
    pollfd there{.fd = descriptor, .events = POLLIN, .revents = 0};
    if (!remainder.empty()) there.events |= POLLOUT;
    const timespec wait = timespec_of(wait_ns);
    if (ppoll(&there, 1, &wait, nullptr) <= 0) continue;
    if ((there.revents & (POLLIN | POLLHUP | POLLERR | POLLNVAL)) == 0) continue;
    const ssize_t count = read(descriptor, bytes.data(), bytes.size());
    if (count > 0) {
      end.hear({bytes.data(), static_cast<std::size_t>(count)}, monotonic_ns());
    } else if (count == 0 || !nothing_now()) {
      return gone(port, count == 0 ? "its other end is gone" : std::system_category().message(errno));
    }
  }
  return std::nullopt;
}

}  // namespace tactus::wire
