// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/emulate_live.hpp>

#include <bit>
#include <cstdio>
#include <iostream>
#include <string_view>

#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

void LiveConsole::look(std::int64_t now_ns) {
  constexpr std::int64_t every_ns = 1'000'000;
  if (now_ns - looked_ns_ < every_ns) return;
  looked_ns_ = now_ns;
  if (!ended_) read_faults(now_ns);
  const std::uint32_t now = motors_.powered(now_ns);
  for (std::uint32_t changed = now ^ powered_; changed != 0; changed &= changed - 1) {
    const int motor = std::countr_zero(changed);
    std::array<char, 80> text{};
    std::snprintf(text.data(), text.size(), "power %d %s %.6f\n", motor + 1, (now >> motor & 1U) != 0 ? "on" : "off",
                  static_cast<double>(now_ns) * 1e-9);
    std::cout << text.data() << std::flush;
  }
  powered_ = now;
}

void LiveConsole::read_faults(std::int64_t now_ns) {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (poll(&input, 1, 0) <= 0) return;
  std::array<char, 4096> bytes{};
  const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) {
    ended_ = true;
    return;
  }
  for (const char byte : std::string_view(bytes.data(), static_cast<std::size_t>(count))) {
    if (byte != '\n') {
      line_ += byte;
      continue;
    }
    if (const Check error = line_.empty() ? std::nullopt : motors_.inject(line_, now_ns)) {
      std::cerr << describe(*error) << "\n";
    }
    line_.clear();
  }
}

}  // namespace tactus::cli
