// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/suggestion.hpp>
#include <tactus/kernel/core/spelling.hpp>

#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

std::string quoted(const std::string& word) { return "'" + word + "'"; }

std::string did_you_mean(std::string_view given, const std::vector<std::string>& words) {
  const std::vector<std::string_view> views(words.begin(), words.end());
  const std::string_view nearest = nearest_word(given, views);
  return nearest.empty() ? "" : ": did you mean " + std::string(nearest) + "?";
}

/// The present name of an option that had another one; empty for any other.
std::string new_name_of(std::string_view option) {
  return option == "--duration" || option == "--for" ? "--duration-s" : "";
}

std::vector<std::string> option_names_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

const CLI::App* verb_below(const CLI::App& app, const std::string& name) {
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == name) return verb;
  }
  return nullptr;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(verb->get_name());
  }
  return quoted(word) + " is no command" + did_you_mean(word, names);
}

std::string unknown_word(const CLI::App& app, int argc, const char* const* argv) {
  const CLI::App* at = &app;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.starts_with("--")) {
      const std::string name = word.substr(0, word.find('='));
      const auto options = option_names_of(*at);
      if (name != "--" && std::find(options.begin(), options.end(), name) == options.end()) {
        if (const std::string now = new_name_of(name);
            std::find(options.begin(), options.end(), now) != options.end()) {
          return quoted(name) + " is now called " + now;
        }
        return quoted(name) + " is no option of " + at->get_name() + did_you_mean(name, options);
      }
      continue;
    }
    if (at->get_subcommands([](const CLI::App*) { return true; }).empty()) continue;
    const CLI::App* next = verb_below(*at, word);
    if (next == nullptr) return unknown_command(*at, word);
    at = next;
  }
  return "";
}

}  // namespace tactus::cli
