#pragma once

#include <tactus/core/result.hpp>
#include <tactus/runtime/end_request.hpp>

#include <atomic>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

namespace tactus::cli {

/// While it lives, SIGINT (Ctrl-C), SIGTERM and SIGHUP do not end the program. The first one asks what runs to come to
/// its end. Another SIGINT or SIGTERM insists: no force from the next tick on, and the program ends with the exit
/// status 128 and the signal's number, whatever it was about to write.
///
/// They are waited for by a thread that does nothing else, so that nothing that stalls keeps them from being heard.
/// Signals are held back in the thread that makes it and in those that this one starts afterwards; so make it first.
/// One at a time.
class Interruption {
 public:
  /// `end` must outlive it. Errors: `failed` where the system gives no thread.
  static Result<std::unique_ptr<Interruption>> start(runtime::EndRequest& end);
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;
  ~Interruption();

  /// The number of the first signal; 0 before it.
  [[nodiscard]] int signal() const noexcept { return signal_.load(std::memory_order_relaxed); }
  /// For a job that a signal cut short; 0 where there was none.
  [[nodiscard]] int exit_status() const noexcept { return signal() == 0 ? 0 : 128 + signal(); }
  /// Its name, as `SIGINT`; empty where there was none.
  [[nodiscard]] std::string name() const;

 private:
  explicit Interruption(runtime::EndRequest& end);
  void listen() noexcept;

  runtime::EndRequest* end_;
  sigset_t signals_{};
  sigset_t before_{};
  std::atomic<int> signal_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace tactus::cli
