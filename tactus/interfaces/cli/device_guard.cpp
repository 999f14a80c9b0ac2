// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/bus_kinds.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/wire/port.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/interfaces/cli/device.hpp>
#include <tactus/interfaces/cli/guard_page.hpp>
#include <tactus/interfaces/cli/guard_post.hpp>
#include <tactus/runtime/servo/rights.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

struct GuardOptions {
  std::string rig, side;
};

/// The guard of one bus: looks at the beats of the program, and switches the motors off when they stop or the program
/// ends without a word.
class Guard {
 public:
  explicit Guard(devices::StatedBus bus) : bus_(std::move(bus)) {}
  Guard(const Guard&) = delete;
  Guard& operator=(const Guard&) = delete;
  ~Guard() {
    if (port_ >= 0) close(port_);
  }

  /// Until the program says goodbye or ends. Errors: those of the bus, where motors may still have power.
  Check watch() {
    while (true) {
      switch (look()) {
        case Seen::nothing:
          break;
        case Seen::goodbye:
          return std::nullopt;
        case Seen::end:
          return switch_off([] { return false; });
        case Seen::stop:
          stopped();
      }
    }
  }

 private:
  enum class Seen { nothing, goodbye, end, stop };

  /// Takes at most `guard_look_ns` where nothing comes.
  Seen look() {
    constexpr int look_ms = static_cast<int>(guard_look_ns / 1'000'000);
    const GuardWord came = receive_guard_word(STDIN_FILENO, look_ms);
    if (page_) (*page_)->guard_beats.fetch_add(1, std::memory_order_relaxed);
    if (came.kind == GuardWord::Kind::end) return Seen::end;
    if (came.kind == GuardWord::Kind::word) {
      if (came.word == guard_word::goodbye) return Seen::goodbye;
      take(came);
    }
    if (!page_ || (*page_)->powered.load(std::memory_order_relaxed) == 0) {
      program_.restart();
      return Seen::nothing;
    }
    const std::uint64_t beats = (*page_)->program_beats.load(std::memory_order_acquire);
    if (program_.alive(beats, wire::monotonic_ns()) || switched_off_at_ == beats) return Seen::nothing;
    return Seen::stop;
  }

  void take(const GuardWord& came) {
    if (came.word == guard_word::page && came.descriptor >= 0) {
      if (auto page = MappedGuardPage::adopt(came.descriptor)) page_.emplace(*std::move(page));
    } else if (came.descriptor >= 0) {
      if (port_ >= 0) close(port_);
      port_ = came.descriptor;
    }
  }

  /// The program has stopped while it drives. From the first word on its motors are the guard's, until it answers.
  void stopped() {
    const std::uint64_t beats = (*page_)->program_beats.load(std::memory_order_acquire);
    (*page_)->taken.fetch_add(1, std::memory_order_release);
    const auto resumed = [&] {
      (*page_)->guard_beats.fetch_add(1, std::memory_order_relaxed);
      return (*page_)->program_beats.load(std::memory_order_acquire) != beats;
    };
    // A motor that does not answer is tried again for as long as the program stays stopped; once all have answered,
    // nobody gives them power before the program goes on.
    if (!switch_off(resumed)) switched_off_at_ = beats;
    program_.restart();
  }

  /// Whoever died may still hold the port for a moment if the guard was not given it.
  Result<std::unique_ptr<devices::MotorLink>> open() {
    const int own = port_ >= 0 ? fcntl(port_, F_DUPFD_CLOEXEC, 0) : -1;
    if (own >= 0) return devices::start(bus_, wire::Port::of_another(own, bus_.port));
    constexpr int most_tries = 200;
    for (int tries = 1;; ++tries) {
      auto link = devices::start(bus_);
      if (link || tries == most_tries) return link;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }

  /// A bus starts by switching all motors off, and then each of them with an answer. `resumed` ends it.
  template <class Resumed>
  Check switch_off(Resumed resumed) {
    constexpr int most_tries = 3;
    constexpr std::int64_t longest_ns = 2'000'000'000;
    Check wrong;
    for (int tries = 0; tries < most_tries; ++tries) {
      auto link = open();
      if (!link) return link.error();
      for (const std::int64_t until_ns = wire::monotonic_ns() + longest_ns; wire::monotonic_ns() < until_ns;) {
        if (resumed()) return std::nullopt;
        const auto now = (*link)->newest();
        if (now && now->state == devices::BusState::ready) return std::nullopt;
        if ((now && now->state == devices::BusState::refused) || !(*link)->running()) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      constexpr Seconds no_longer{0.0};
      wrong = (*link)->wait_until_asked(no_longer);
    }
    return wrong;
  }

  devices::StatedBus bus_;
  int port_ = -1;
  std::optional<MappedGuardPage> page_;
  BeatWatch program_{program_timeout_ns, 2 * guard_look_ns};
  std::optional<std::uint64_t> switched_off_at_;  ///< the beat at which the program had stopped
};

Result<bool> guard(const GuardOptions& options) {
  // It outlives whatever ends the program: Ctrl-C, a closed terminal, the end of a session.
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM}) std::signal(signal, SIG_IGN);
  const auto rig = devices::Rig::load(options.rig);
  if (!rig) return rig.error();
  const auto sides = rig->sides(options.side);
  if (!sides) return rig->locate(sides.error());
  // Before all that is not real time, so that a busy machine does not keep it from looking; after bus and servo thread.
  constexpr int priority = 60, any_core = -1;
  static_cast<void>(runtime::take_thread_rights(priority, any_core));
  if (Check wrong = Guard(sides->front()->bus).watch()) return *std::move(wrong);
  return true;
}

}  // namespace

void add_device_guard(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<GuardOptions>();
  CLI::App* verb = device.add_subcommand("guard",
                                         "Switch off motors that have no watchdog when standard input ends or when the "
                                         "program that drives them stops; 'run' starts this command by itself");
  verb->add_option("RIG", options->rig, "Rig file")->required();
  verb->add_option("SIDE", options->side, "Side of the rig, such as arm.leader")->required();
  verb->callback([options, &app, &status] { end_command(app, guard(*options), status); });
}

}  // namespace tactus::cli
