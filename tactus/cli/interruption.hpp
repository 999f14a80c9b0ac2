#pragma once

#include <atomic>
#include <csignal>

namespace tactus::cli {

/// While it lives, Ctrl-C (SIGINT) and SIGTERM are noted and do not end the program, so that what runs can come to its
/// own end. One at a time.
class Interruption {
 public:
  Interruption() noexcept : before_{std::signal(SIGINT, &note), std::signal(SIGTERM, &note)} {
    asked_.store(false, std::memory_order_relaxed);
  }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption() {
    std::signal(SIGINT, before_[0]);
    std::signal(SIGTERM, before_[1]);
  }

  /// Whether somebody has asked for the end. Real-time safe.
  [[nodiscard]] bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }

 private:
  static void note(int) { asked_.store(true, std::memory_order_relaxed); }
  static inline std::atomic<bool> asked_{false};
  void (*before_[2])(int);
};

}  // namespace tactus::cli
