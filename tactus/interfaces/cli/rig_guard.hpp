// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/wire/port.hpp>
#include <tactus/interfaces/cli/guard_page.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>

namespace tactus::cli {

/// A process that switches off the motors of a side, which have no watchdog of their own, when this program ends
/// without a word, or when its beats stop for `program_timeout_ns` while it drives them. It is this program once more
/// (`tactus device guard`), at the other end of a socket. It has the port open too, so it needs neither the rig file
/// nor the end of a program that is only stopped.
class RigGuard {
 public:
  /// Returns when the guard watches. Errors: `failed` where the system gives no process, or the guard does not start.
  static Result<RigGuard> start(const std::string& file, const devices::RigSide& side);
  RigGuard(RigGuard&& other) noexcept;
  RigGuard& operator=(RigGuard&&) = delete;
  /// Ends the guard, after the motors have lost their power. A guard that does not end within 1 s is killed.
  ~RigGuard();

  /// Gives the guard the port by which it switches the motors off. Errors: `failed` where the guard is gone.
  Check give(const wire::Port& port) const;
  [[nodiscard]] GuardPage& page() const noexcept { return *page_; }
  /// Notes in the page if the process has ended. One system call; the thread that started it.
  void look() noexcept;

 private:
  RigGuard(int socket, int process, MappedGuardPage page)
      : socket_(socket), process_(process), page_(std::move(page)) {}
  int socket_ = -1;
  int process_ = -1;
  MappedGuardPage page_;
};

}  // namespace tactus::cli
