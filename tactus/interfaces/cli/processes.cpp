// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/processes.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::cli {

namespace {

tasks::Engine* engine_of_this_program = nullptr;

/// How many processes a launcher of MPI has started, as it states in the environment; 1 without a launcher.
long processes_of_launcher() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* text = std::getenv(name);
    if (text != nullptr) return std::strtol(text, nullptr, 10);
  }
  return 1;
}

/// The command in a command line: `run`, `stability map`; empty if only options are there.
std::string command_in(int argc, const char* const* argv) {
  std::vector<std::string_view> words;
  for (int i = 1; i < argc && words.size() < 2; ++i) {
    const std::string_view word = argv[i];
    if (word == "--plugin") ++i;
    if (!word.starts_with('-')) words.push_back(word);
  }
  if (words.empty()) return {};
  if (words[0] == "stability" && words.size() > 1) return "stability " + std::string(words[1]);
  return std::string(words[0]);
}

Error refused(std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = "mpirun"};
}

}  // namespace

tasks::Engine* engine_of_commands() { return is_in_process() ? nullptr : engine_of_this_program; }

void set_engine_of_commands(tasks::Engine* engine) { engine_of_this_program = engine; }

bool presents_results() { return engine_of_commands() == nullptr || engine_of_commands()->leads(); }

Check refuse_processes(int argc, const char* const* argv) {
  if (is_in_process()) return std::nullopt;
  constexpr std::array<std::string_view, 5> allowed{"", "run", "stability map", "help", "completion"};
  const std::string command = command_in(argc, argv);
  const bool shares = std::find(allowed.begin(), allowed.end(), command) != allowed.end();
  if (engine_of_commands() != nullptr) {
    if (shares) return std::nullopt;
    return refuse_to_share("`" + command + "`");
  }
  if (!shares || command.empty() || processes_of_launcher() < 2) return std::nullopt;
  return refused(
      "this tactus was built without the component `mpi`, so its processes cannot share work: install "
      "libopenmpi-dev and build again, or start one process, which uses all cores of its machine");
}

Check refuse_to_share(const std::string& what) {
  if (engine_of_commands() == nullptr || engine_of_commands()->processes() < 2) return std::nullopt;
  return refused(what +
                 " cannot be shared by several processes: start it without mpirun; `stability map` of one axis "
                 "and `run` of a contest can");
}

}  // namespace tactus::cli
