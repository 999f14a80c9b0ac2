#include <tactus/cli/device.hpp>
#include <tactus/cli/rig_guard.hpp>
#include <tactus/devices/rig/bus_kinds.hpp>

#include <array>
#include <cerrno>
#include <chrono>
#include <memory>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

constexpr char goodbye = 'q';

Error no_guard(int code) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = "no process to guard motors without a watchdog (" + std::system_category().message(code) +
                     "): end other programs",
          .place = {}};
}

struct GuardOptions {
  std::string rig, side;
};

/// Until nobody speaks any more. False where somebody said goodbye.
bool wait_for_silence() {
  for (char word = 0;;) {
    const ssize_t size = read(STDIN_FILENO, &word, 1);
    if (size > 0 && word == goodbye) return false;
    if (size == 0 || (size < 0 && errno != EINTR)) return true;
  }
}

Result<bool> guard(const GuardOptions& options) {
  const auto rig = devices::Rig::load(options.rig);
  if (!rig) return rig.error();
  const auto sides = rig->sides(options.side);
  if (!sides) return rig->locate(sides.error());
  if (!wait_for_silence()) return true;
  // Whoever died may still hold the port for a moment. The first that a bus says is that nobody has power.
  constexpr int most_tries = 200;
  for (int tries = 0; tries < most_tries; ++tries) {
    auto bus = devices::start(sides->front()->bus);
    if (bus) {
      constexpr Seconds longest{2.0};
      return !(*bus)->wait_until_asked(longest);
    }
    if (tries + 1 == most_tries) return bus.error();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

}  // namespace

Result<RigGuard> RigGuard::start(const std::string& file, const devices::RigSide& side) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return no_guard(errno);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  // Ctrl-C at the terminal is not for it, and it does not write where nobody expects it.
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  std::vector<std::string> words{"tactus", "device", "guard", file, side.path};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t process = -1;
  const int failed = posix_spawn(&process, "/proc/self/exe", &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(ends[0]);
  if (failed != 0) {
    close(ends[1]);
    return no_guard(failed);
  }
  return RigGuard(ends[1], process);
}

RigGuard::RigGuard(RigGuard&& other) noexcept
    : pipe_(std::exchange(other.pipe_, -1)), process_(std::exchange(other.process_, -1)) {}

RigGuard::~RigGuard() {
  if (pipe_ < 0) return;
  static_cast<void>(!::write(pipe_, &goodbye, 1));
  close(pipe_);
  waitpid(process_, nullptr, 0);
}

void add_device_guard(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<GuardOptions>();
  CLI::App* verb = device.add_subcommand(
      "guard", "Take the power from motors without a watchdog once standard input ends; 'run' starts it by itself");
  verb->add_option("RIG", options->rig, "The rig file")->required();
  verb->add_option("SIDE", options->side, "A side of it, as arm.leader")->required();
  verb->callback([options, &app, &status] { end_verb(app, guard(*options), status); });
}

}  // namespace tactus::cli
