#pragma once

#include <tactus/core/result.hpp>
#include <tactus/devices/rig/rig.hpp>

#include <string>

namespace tactus::cli {

/// A process that takes the power from the motors of a side when this program dies without a word, for motors that have
/// no watchdog of their own. It is this program once more (`tactus device guard`), at the other end of a pipe, and ends
/// in peace where it is told goodbye.
class RigGuard {
 public:
  /// Errors: `failed` where the system gives no process.
  static Result<RigGuard> start(const std::string& file, const devices::RigSide& side);
  RigGuard(RigGuard&& other) noexcept;
  RigGuard& operator=(RigGuard&&) = delete;
  /// Says goodbye, once the motors have no power any more.
  ~RigGuard();

 private:
  RigGuard(int pipe, int process) : pipe_(pipe), process_(process) {}
  int pipe_ = -1;
  int process_ = -1;
};

}  // namespace tactus::cli
