// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/quiet_thread.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <array>
#include <chrono>
#include <utility>

#include <time.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

using std::chrono::steady_clock;

/// One Ctrl-C can come as two signals, to the process and to its group; nobody presses twice within this.
constexpr std::chrono::milliseconds same_request{50};
/// For a servo thread to have its next tick.
constexpr useconds_t last_tick_us = 20'000;
constexpr timespec look_up{.tv_sec = 0, .tv_nsec = 50'000'000};

struct Named {
  int signal;
  const char* name;
};
/// All that would end a program, but for those that a fault of its own raises. SIGKILL cannot be caught; SIGPIPE and
/// SIGXFSZ are ignored by the command, so that the write fails.
constexpr std::array ending{Named{SIGINT, "SIGINT"},       Named{SIGTERM, "SIGTERM"},     Named{SIGQUIT, "SIGQUIT"},
                            Named{SIGHUP, "SIGHUP"},       Named{SIGUSR1, "SIGUSR1"},     Named{SIGUSR2, "SIGUSR2"},
                            Named{SIGALRM, "SIGALRM"},     Named{SIGVTALRM, "SIGVTALRM"}, Named{SIGPROF, "SIGPROF"},
                            Named{SIGXCPU, "SIGXCPU"},     Named{SIGIO, "SIGIO"},         Named{SIGPWR, "SIGPWR"},
                            Named{SIGSTKFLT, "SIGSTKFLT"}, Named{SIGTSTP, "SIGTSTP"}};

/// Whether whoever sends it twice wants the end at once. The others come more than once by themselves: SIGXCPU each
/// second, SIGHUP from shell and terminal.
bool insists(int signal) { return signal == SIGINT || signal == SIGTERM || signal == SIGQUIT; }

/// Whether nobody else has a use for it. Under nohup the loss of the terminal is to be nothing; any other signal that
/// is ignored, as SIGINT in a background job of a shell, is waited for all the same.
bool is_free(int signal) {
  struct sigaction action {};
  if (sigaction(signal, nullptr, &action) != 0) return true;
  return action.sa_handler == SIG_DFL || (action.sa_handler == SIG_IGN && signal != SIGHUP);
}

}  // namespace

Result<std::unique_ptr<Interruption>> Interruption::start(runtime::EndRequest& end, Interrupted what) {
  if (is_in_process()) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message =
                     "what runs at the real clock takes the signals of its process: start the command `tactus` as a "
                     "program of its own",
                 .place = {}};
  }
  std::unique_ptr<Interruption> made(new Interruption(end, what));
  auto thread = start_quiet_thread([self = made.get()] { self->listen(); });
  if (!thread) return thread.error();
  made->thread_ = *std::move(thread);
  return made;
}

Interruption::Interruption(runtime::EndRequest& end, Interrupted what) : end_(&end) {
  sigemptyset(&signals_);
  const int not_waited_for = what == Interrupted::site ? SIGUSR1 : SIGTSTP;
  for (const Named& each : ending) {
    if (each.signal != not_waited_for && is_free(each.signal)) sigaddset(&signals_, each.signal);
  }
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) {
    if (is_free(signal)) sigaddset(&signals_, signal);
  }
  blocked_ = signals_;
  if (what == Interrupted::site) {
    // A terminal stops who reads or writes in its background; blocked, the read fails, which is the end of the input.
    for (const int signal : {SIGUSR1, SIGTTIN, SIGTTOU}) sigaddset(&blocked_, signal);
  }
  pthread_sigmask(SIG_BLOCK, &blocked_, &before_);
}

Interruption::~Interruption() {
  stopping_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  // What came since has been answered: the end is near. It would end the program without its exit status.
  constexpr timespec at_once{};
  while (sigtimedwait(&blocked_, nullptr, &at_once) > 0) {
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::string Interruption::name() const {
  const int number = signal();
  if (number == 0) return {};
  for (const Named& each : ending) {
    if (each.signal == number) return each.name;
  }
  return "signal " + std::to_string(number);
}

void Interruption::listen() noexcept {
  steady_clock::time_point first;
  while (!stopping_.load(std::memory_order_relaxed)) {
    const int signal = sigtimedwait(&signals_, nullptr, &look_up);
    if (signal < 0) continue;
    if (signal_.load(std::memory_order_relaxed) == 0) {
      signal_.store(signal, std::memory_order_relaxed);
      end_->ask();
      first = steady_clock::now();
      continue;
    }
    if (!insists(signal) || steady_clock::now() - first < same_request) continue;
    end_->insist();
    usleep(last_tick_us);
    _exit(128 + signal);
  }
}

}  // namespace tactus::cli
