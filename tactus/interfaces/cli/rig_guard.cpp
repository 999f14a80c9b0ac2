// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/guard_post.hpp>
#include <tactus/interfaces/cli/rig_guard.hpp>

#include <array>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

using std::chrono::steady_clock;

Error no_guard(const std::string& why) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = "no process to guard motors without a watchdog (" + why + "): end other programs",
          .place = {}};
}

Error no_guard(int code) { return no_guard(std::system_category().message(code)); }

/// The guard at the socket, or the number of the error.
int spawn(pid_t& process, int socket, std::vector<std::string> words) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, socket, STDIN_FILENO);
  // Ctrl-C and Ctrl-Z at the terminal are not for it, and it does not write where nobody expects it.
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const int failed = posix_spawn(&process, "/proc/self/exe", &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  return failed;
}

}  // namespace

Result<RigGuard> RigGuard::start(const std::string& file, const devices::RigSide& side) {
  auto page = MappedGuardPage::create();
  if (!page) return no_guard(errno);
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) return no_guard(errno);
  pid_t process = -1;
  const int failed = spawn(process, ends[0], {"tactus", "device", "guard", file, side.path});
  close(ends[0]);
  if (failed != 0) {
    close(ends[1]);
    return no_guard(failed);
  }
  RigGuard guard(ends[1], process, *std::move(page));
  if (!send_to_guard(guard.socket_, guard_word::page, guard.page_.descriptor())) return no_guard("it ended at once");
  constexpr std::chrono::seconds longest{10};
  for (const auto until = steady_clock::now() + longest; guard.page().guard_beats.load() == 0;) {
    guard.look();
    if (guard.page().guard_ended.load() != 0) return no_guard("it ended at once");
    if (steady_clock::now() > until) return no_guard("it did not start within 10 s");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return guard;
}

RigGuard::RigGuard(RigGuard&& other) noexcept
    : socket_(std::exchange(other.socket_, -1)),
      process_(std::exchange(other.process_, -1)),
      page_(std::move(other.page_)) {}

Check RigGuard::give(const wire::Port& port) const {
  if (send_to_guard(socket_, guard_word::port, port.descriptor())) return std::nullopt;
  return no_guard("it has ended");
}

void RigGuard::look() noexcept {
  if (process_ < 0 || waitpid(process_, nullptr, WNOHANG) == 0) return;
  process_ = -1;
  page_->guard_ended.store(1, std::memory_order_relaxed);
}

RigGuard::~RigGuard() {
  if (socket_ < 0) return;
  static_cast<void>(send_to_guard(socket_, guard_word::goodbye));
  close(socket_);
  // A guard that is stopped does not keep this program from its end.
  constexpr std::chrono::seconds longest{1};
  for (const auto until = steady_clock::now() + longest; process_ >= 0; look()) {
    if (steady_clock::now() > until) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // namespace tactus::cli
