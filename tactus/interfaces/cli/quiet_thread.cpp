// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/quiet_thread.hpp>

#include <csignal>
#include <system_error>
#include <utility>

namespace tactus::cli {

Result<std::thread> start_quiet_thread(std::function<void()> body) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread thread;
  try {
    thread = std::thread(std::move(body));
  } catch (const std::system_error&) {  // reported below
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (thread.joinable()) return thread;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "no thread could be started: raise the limit on processes (ulimit -u)",
               .place = {}};
}

}  // namespace tactus::cli
