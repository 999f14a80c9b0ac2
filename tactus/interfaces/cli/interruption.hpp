// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/end_request.hpp>

#include <atomic>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

namespace tactus::cli {

/// What runs while signals are waited for.
enum class Interrupted {
  job,  ///< it has no operator: SIGUSR1 ends it too, and Ctrl-Z stops it as any program
  site  ///< SIGUSR1 is the operator's, see `OperatorInput`; Ctrl-Z (SIGTSTP) ends it, because a stopped program
        ///< does not control its devices. In the background of a terminal (SIGTTIN, SIGTTOU) it continues
};

/// While it lives, no signal that can be caught ends the program. The first one requests the end of what runs: SIGINT
/// (Ctrl-C), SIGTERM, SIGQUIT, SIGHUP, SIGUSR2, SIGALRM, SIGXCPU and whatever else would end a program. Another SIGINT,
/// SIGTERM or SIGQUIT insists: no force from the next tick on, and the program ends with the exit status 128 and the
/// signal's number, whatever it was about to write. Signals for which the program has a handler keep it, and so does a
/// SIGHUP that is ignored, as under nohup. SIGSEGV and its like are not waited for: they end the program.
///
/// They are waited for by a thread that does nothing else, so that nothing that stalls delays them. Signals are blocked
/// in the thread that makes it and in those that this one starts afterwards; so make it first. One at a time.
class Interruption {
 public:
  /// `end` must outlive it. Errors: `failed` where the system gives no thread; `inconsistent` in a
  /// program that runs commands itself (`run_in_process`), whose signals are its own.
  static Result<std::unique_ptr<Interruption>> start(runtime::EndRequest& end, Interrupted what = Interrupted::job);
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
  Interruption(runtime::EndRequest& end, Interrupted what);
  void listen() noexcept;

  runtime::EndRequest* end_;
  sigset_t signals_{};  ///< that are waited for
  sigset_t blocked_{};  ///< these, and those of the operator
  sigset_t before_{};
  std::atomic<int> signal_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

}  // namespace tactus::cli
