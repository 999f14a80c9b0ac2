// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/site_exchange.hpp>

#include <atomic>
#include <csignal>
#include <memory>
#include <string>
#include <thread>

namespace tactus::cli {

/// What a user asks of sites that run: words that come on a descriptor, a line each, and SIGUSR1, which arms. A
/// thread that does nothing else passes them on, in their order; it never writes, so no terminal keeps a word from
/// being received.
///
/// The dead-man switch is what that descriptor holds: where it ends, is closed or fails, or there is no memory for a
/// word, nobody is there, and the switch stays released. Its thread alone takes SIGUSR1, so make it before others. One
/// at a time.
class OperatorInput {
 public:
  /// All else must outlive it. A wrong word, and the end at the master, are reported on `lines`. Errors: `failed` where
  /// the system gives no thread.
  static Result<std::unique_ptr<OperatorInput>> listen_to(int descriptor, control::SiteRole role,
                                                          runtime::SiteExchange& exchange, LineWriter& lines);
  OperatorInput(const OperatorInput&) = delete;
  OperatorInput& operator=(const OperatorInput&) = delete;
  ~OperatorInput();

 private:
  OperatorInput(int descriptor, control::SiteRole role, runtime::SiteExchange& exchange, LineWriter& lines);
  void listen();
  void pass_on();
  void read_what_waits();
  void lose();

  int descriptor_;
  control::SiteRole role_;
  runtime::SiteExchange* exchange_;
  LineWriter* lines_;
  std::string typed_;
  bool open_ = true;
  bool arm_ = false;
  sigset_t mask_before_{};
  struct sigaction action_before_ {};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> stopped_{false};
  std::thread thread_;
};

}  // namespace tactus::cli
