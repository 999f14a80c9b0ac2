#include <tactus/cli/verbs.hpp>
#include <tactus/core/version.hpp>

#include <string>
#include <string_view>

namespace {

/// A word of a command line as a person would type it into a shell.
std::string shell_word(std::string_view word) {
  constexpr std::string_view plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
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

}  // namespace

int main(int argc, char** argv) {
  std::string command = "tactus";
  for (int i = 1; i < argc; ++i) command += " " + shell_word(argv[i]);

  int status = 0;
  CLI::App app{"Crisp and stable force-reflecting teleoperation", "tactus"};
  app.set_version_flag("--version", "tactus " + std::string(tactus::version()));
  app.require_subcommand(1);
  tactus::cli::add_run(app, command, status);
  tactus::cli::add_schema(app, status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    // Help and version come this way too, with a code of 0.
    return app.exit(error) == 0 ? 0 : 2;
  }
  return status;
}
