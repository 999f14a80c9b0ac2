#include <tactus/cli/interruption.hpp>
#include <tactus/cli/quiet_thread.hpp>

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

}  // namespace

Result<std::unique_ptr<Interruption>> Interruption::start(runtime::EndRequest& end) {
  std::unique_ptr<Interruption> made(new Interruption(end));
  auto thread = start_quiet_thread([self = made.get()] { self->listen(); });
  if (!thread) return thread.error();
  made->thread_ = *std::move(thread);
  return made;
}

Interruption::Interruption(runtime::EndRequest& end) : end_(&end) {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  // Under nohup the loss of the terminal is to be nothing.
  struct sigaction hangup {};
  if (sigaction(SIGHUP, nullptr, &hangup) != 0 || hangup.sa_handler != SIG_IGN) sigaddset(&signals_, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
}

Interruption::~Interruption() {
  stopping_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

std::string Interruption::name() const {
  switch (signal()) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    default:
      return {};
  }
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
    // A terminal that goes away says so more than once.
    if (signal == SIGHUP || steady_clock::now() - first < same_request) continue;
    end_->insist();
    usleep(last_tick_us);
    _exit(128 + signal);
  }
}

}  // namespace tactus::cli
