// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/streams.hpp>

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

const auto any_command = [](const CLI::App*) { return true; };

/// The words that a value is one of, from what help says of it (`TEXT:{h1,h2,etfe}`); empty where it may be any.
std::string choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos) return "";
  std::string words = type.substr(open + 1, close - open - 1);
  for (char& c : words) c = c == ',' ? ' ' : c;
  return words;
}

/// A case for each verb: what may stand behind it, and what behind its options.
void add_cases(const CLI::App& app, const std::string& path, std::string& words, std::string& values) {
  std::string all;
  for (const CLI::App* verb : app.get_subcommands(any_command)) {
    all += verb->get_name() + " ";
    add_cases(*verb, path + " " + verb->get_name(), words, values);
  }
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) {
      all += "--" + name + " ";
      if (option->get_expected_max() == 0) continue;
      values += "    '" + path + " --" + name + "') choices='" + choices_of(*option) + "' ;;\n";
    }
  }
  words += "    '" + path + "') words='" + all + "' ;;\n";
}

std::string bash_script(const CLI::App& app) {
  std::string words, values;
  add_cases(app, "", words, values);
  const std::string name = app.get_name();
  return "# Completion of " + name + " for bash, as `" + name + " completion bash` prints it.\n" + "_" + name +
         "() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}\n"
         "  local path= words= choices=- i\n"
         "  _" +
         name + "_words\n" +
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \" $words \" in\n"
         "    *\" ${COMP_WORDS[i]} \"*)\n"
         "      case ${COMP_WORDS[i]} in -*) ;; *) path=\"$path ${COMP_WORDS[i]}\" ;; esac\n"
         "      _" +
         name + "_words ;;\n" +
         "    esac\n"
         "  done\n"
         "  case \"$path $before\" in\n" +
         values +
         "  esac\n"
         "  # Files complete an option that takes any value, and a word that is no command or option.\n"
         "  COMPREPLY=()\n"
         "  if [ \"$choices\" != - ]; then\n"
         "    words=$choices\n"
         "  fi\n"
         "  if [ -n \"$words\" ]; then COMPREPLY=($(compgen -W \"$words\" -- \"$current\")); fi\n"
         "}\n"
         "_" +
         name +
         "_words() {\n"
         "  case \"$path\" in\n" +
         words +
         "  esac\n"
         "}\n"
         "complete -o default -F _" +
         name + " " + name + "\n";
}

}  // namespace

void add_completion(CLI::App& app) {
  auto shell = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("completion", "Print the shell completion of this command");
  verb->add_option("SHELL", *shell, "Shell")->required()->check(CLI::IsMember({"bash"}));
  verb->callback([&app, shell] { result_stream() << bash_script(app); });
}

}  // namespace tactus::cli
