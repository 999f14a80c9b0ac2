// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/colour.hpp>
#include <tactus/interfaces/cli/command.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/help.hpp>
#include <tactus/interfaces/cli/internal/command_words.hpp>
#include <tactus/interfaces/cli/plugin.hpp>
#include <tactus/interfaces/cli/printable_output.hpp>
#include <tactus/interfaces/cli/processes.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/interfaces/cli/suggestion.hpp>
#include <tactus/interfaces/cli/version_text.hpp>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

/// A word of a command line as a person would type it into a shell.
std::string shell_word(std::string_view word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!word.empty() && word.find_first_not_of(plain) == std::string_view::npos) return std::string(word);
  std::string quoted = "'";
  for (const char c : word) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

int refuse(const std::string& name, std::string_view why) {
  return report_error(name, {.code = ErrorCode::syntax,
                             .parameter = {},
                             .message = std::string(why) + ": `" + name + " --help` and `" + name +
                                        " COMMAND --help` list what there is",
                             .place = {}});
}

/// No empty list is shown as a default, here and in all verbs below.
void forget_empty_defaults(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_default_str() == "[]") option->default_str("");
  }
  for (CLI::App* verb : app.get_subcommands({})) forget_empty_defaults(*verb);
}

/// The words with every `--plugin FILE` before the command, wherever it stands up to a `--`: what it brings must be
/// there before the command reads a file that names it.
std::vector<const char*> plugins_first(int argc, const char* const* argv) {
  std::vector<const char*> words(argv, argv + std::min(argc, 1)), others;
  bool options = true;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    options = options && word != "--";
    const bool apart = word == "--plugin" && i + 1 < argc;
    const bool plugin = options && (apart || word.starts_with("--plugin="));
    (plugin ? words : others).push_back(argv[i]);
    if (plugin && apart) words.push_back(argv[++i]);
  }
  words.insert(words.end(), others.begin(), others.end());
  return words;
}

/// What can have a place in a program that is not ours: it computes, and neither drives anything nor takes signals.
Check refuse_in_process(int argc, const char* const* argv) {
  constexpr std::array programs{"device", "doctor", "emulate", "plant", "rehearse", "relay", "serve"};
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const bool plugin = word.starts_with("--plugin");
    if (word.starts_with('-') && !plugin) continue;
    if (!plugin && std::find(programs.begin(), programs.end(), word) == programs.end()) return std::nullopt;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = "is for a process of its own: start the command `tactus` as a program",
                 .place = std::string(word)};
  }
  return std::nullopt;
}

}  // namespace

int run_words(const std::string& name, int argc, const char* const* given) {
  std::string command = shell_word(name);
  for (int i = 1; i < argc; ++i) command += " " + shell_word(given[i]);
  const std::vector<const char*> words = plugins_first(argc, given);
  const char* const* const argv = words.data();
  command = report::printable(command);  // it stands in reports, and in model files as a comment of one line
  if (is_in_process()) {
    if (const auto error = refuse_in_process(argc, argv)) return report_error(name, *error);
  }
  if (const auto error = refuse_processes(argc, argv)) return report_error(name, *error);
  int status = 0;
  CLI::App app{"Crisp and stable force-reflecting teleoperation", name};
  app.set_version_flag("--version", version_text());
  set_help(app);
  // Loaded before the command that follows reads a rig file.
  std::optional<Error> unloaded;
  app.add_option_function<std::vector<std::string>>(
         "--plugin",
         [&unloaded](const std::vector<std::string>& files) {
           for (const std::string& file : files) {
             unloaded = load_plugin(file);
             if (unloaded) throw CLI::RuntimeError(exit_status(*unloaded));
           }
         },
         "Load a shared object that adds drivers for rig files; before or after COMMAND")
      ->type_name("FILE.so")
      ->expected(1)
      ->take_all();
  app.option_defaults()->always_capture_default();
  // None is allowed here and refused below: CLI11 would call every unknown word a missing subcommand.
  app.require_subcommand(0, 1);
  // In the order in which help lists them: those of a group together, as in examples.hpp.
  add_run(app, command, status);
  add_serve(app, command, status);
  add_plant(app, command, status);
  add_key(app, status);
  add_relay(app, command, status);
  add_doctor(app, command, status);
  add_diagnose(app, command, status);
  add_advise(app, command, status);
  add_stability(app, command, status);
  add_faults(app, command, status);
  add_identify(app, command, status);
  add_estimate(app, command, status);
  add_device(app, command, status);
  add_rehearse(app, command, status);
  add_emulate(app, status);
  add_export(app, command, status);
  add_replay(app, command, status);
  add_schema(app, status);
  add_completion(app);
  add_help(app, status);
  add_examples(app);
  forget_empty_defaults(app);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) return refuse(name, "A command is required");
  } catch (const CLI::ParseError& error) {
    if (unloaded) {
      return report_error(name, *unloaded);
    }
    // Help and version come this way too, with a code of 0.
    if (error.get_exit_code() != 0) {
      const std::string unknown = unknown_word(app, argc, argv);
      return refuse(name, unknown.empty() ? error.what() : unknown);
    }
    app.exit(error, result_stream(), message_stream());
  }
  if (status != 0) return status;
  if (const auto error = flush_standard_output()) {
    return report_error(name, *error);
  }
  return 0;
}

namespace {

int run(int argc, char** argv) {
  const std::string name = argc > 0 ? std::filesystem::path(argv[0]).filename().string() : "tactus";
  // Else the number of one that was closed would be given to a log or a socket, which would be read or printed to. This
  // way round, so that reading from it and printing to it fail as before.
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(standard, F_GETFD) < 0) (void)open("/dev/null", standard == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
  const auto painter = [&name](int descriptor) {
    return shows_colour(descriptor) ? std::optional(Painter(name)) : std::nullopt;
  };
  const PrintableOutput output(std::cout, painter(STDOUT_FILENO)), errors(std::cerr, painter(STDERR_FILENO));
  if (shows_colour(STDERR_FILENO)) std::cerr << std::nounitbuf;  // a line is painted as a whole
  if (winsize window{}; ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0) {
    report::set_text_width(window.ws_col);
  }
  // A reader of the results that went away is not the end: files are still written.
  std::signal(SIGPIPE, SIG_IGN);
  // A file that reaches the limit on its size (ulimit -f) is a write that fails, as on a full disk, and not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  return run_words(name, argc, argv);
}

}  // namespace

int run_command(int argc, char** argv, tasks::Engine* engine) {
  set_engine_of_commands(engine);
  // What is thrown is what nobody can do without: memory, or a thread. Told without any of either.
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    std::fputs("tactus: out of memory: free some, raise the limit (ulimit -v), or ask for less at once\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tactus: the system refused what the command needs: %s\n", error.what());
  }
  return 1;
}

}  // namespace tactus::cli
