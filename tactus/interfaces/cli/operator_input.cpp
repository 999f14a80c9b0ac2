// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/operator_input.hpp>
#include <tactus/interfaces/cli/quiet_thread.hpp>

#include <array>
#include <cerrno>
#include <exception>
#include <string_view>
#include <utility>

#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

std::atomic<bool> asked_to_arm{false};
constexpr int look_up_ms = 20;
/// No word is that long: what is piped in without an end of line shall not fill the memory.
constexpr std::size_t longest_line = 1000;

sigset_t arming_signal() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR1);
  return set;
}

}  // namespace

Result<std::unique_ptr<OperatorInput>> OperatorInput::listen_to(int descriptor, control::SiteRole role,
                                                                runtime::SiteExchange& exchange, LineWriter& lines) {
  std::unique_ptr<OperatorInput> made(new OperatorInput(descriptor, role, exchange, lines));
  auto thread = start_quiet_thread([self = made.get()] { self->listen(); });
  if (!thread) return thread.error();
  made->thread_ = *std::move(thread);
  return made;
}

OperatorInput::OperatorInput(int descriptor, control::SiteRole role, runtime::SiteExchange& exchange, LineWriter& lines)
    : descriptor_(descriptor), role_(role), exchange_(&exchange), lines_(&lines) {
  asked_to_arm.store(false, std::memory_order_relaxed);
  const sigset_t set = arming_signal();
  pthread_sigmask(SIG_BLOCK, &set, &mask_before_);
  // One that came before there was anything to arm arms nothing later.
  constexpr timespec at_once{};
  while (sigtimedwait(&set, nullptr, &at_once) > 0) {
  }
  // Without SA_RESTART: it ends a wait for input too.
  struct sigaction note {};
  note.sa_handler = [](int) { asked_to_arm.store(true, std::memory_order_relaxed); };
  sigaction(SIGUSR1, &note, &action_before_);
}

OperatorInput::~OperatorInput() {
  stopping_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) {
    // It may wait in a read for what another program took from the same terminal.
    while (!stopped_.load(std::memory_order_acquire)) {
      pthread_kill(thread_.native_handle(), SIGUSR1);
      usleep(1000);
    }
    thread_.join();
  }
  sigaction(SIGUSR1, &action_before_, nullptr);
  pthread_sigmask(SIG_SETMASK, &mask_before_, nullptr);
}

void OperatorInput::listen() {
  const sigset_t set = arming_signal();
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
  while (!stopping_.load(std::memory_order_relaxed)) {
    try {
      pass_on();
      read_what_waits();
    } catch (const std::exception&) {
      // Without memory for a word nobody is heard.
      open_ = false;
      typed_.clear();
      exchange_->person_lost.store(true, std::memory_order_relaxed);
    }
  }
  stopped_.store(true, std::memory_order_release);
}

/// As far as there is room; the rest is passed on later.
void OperatorInput::pass_on() {
  const bool master = role_ == control::SiteRole::master;
  arm_ = (asked_to_arm.exchange(false, std::memory_order_relaxed) && master) || arm_;
  if (arm_) arm_ = !exchange_->ask(runtime::SiteWord::arm);
  for (auto end = typed_.find('\n'); end != std::string::npos; end = typed_.find('\n')) {
    const auto asked = runtime::parse_site_command(std::string_view(typed_).substr(0, end), role_, exchange_->settable);
    if (!asked) {
      lines_->say("tactus: " + describe(asked.error()) + "\n");
    } else if (!exchange_->ask(*asked)) {
      return;
    }
    typed_.erase(0, end + 1);
  }
}

/// No more than a line ahead of what was passed on.
void OperatorInput::read_what_waits() {
  const bool wants = open_ && typed_.find('\n') == std::string::npos;
  pollfd input{.fd = wants ? descriptor_ : -1, .events = POLLIN, .revents = 0};
  if (poll(&input, 1, look_up_ms) <= 0 || !wants) return;
  std::array<char, 256> text{};
  const ssize_t size = read(descriptor_, text.data(), text.size());
  if (size > 0) {
    typed_.append(text.data(), static_cast<std::size_t>(size));
    if (typed_.size() > longest_line && typed_.find('\n') == std::string::npos) typed_ += '\n';
  } else if (size == 0 || (errno != EINTR && errno != EAGAIN)) {
    lose();
  }
}

void OperatorInput::lose() {
  open_ = false;
  if (!typed_.empty()) typed_ += '\n';
  exchange_->person_lost.store(true, std::memory_order_relaxed);
  if (role_ == control::SiteRole::slave) return;
  lines_->say(
      "tactus: standard input has ended: that is `release`, and nobody can press the dead-man switch again; give the "
      "master a terminal, or a pipe that stays open\n");
}

}  // namespace tactus::cli
