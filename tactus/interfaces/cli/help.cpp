// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/examples.hpp>
#include <tactus/interfaces/cli/help.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/interfaces/cli/suggestion.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

/// Words in lines of at most `width`, the second and all further ones behind `indent` blanks.
std::string in_lines(std::string_view text, std::size_t at, std::size_t indent, std::size_t width) {
  std::string lines;
  std::size_t used = at;
  bool fresh = true;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    const std::string word(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (word.empty()) continue;
    const std::size_t wide = report::display_width(word);
    if (!fresh && used + 1 + wide > width) {
      lines += "\n" + std::string(indent, ' ');
      used = indent;
      fresh = true;
    }
    lines += (fresh ? "" : " ") + word;
    used += wide + (fresh ? 0 : 1);
    fresh = false;
  }
  return lines;
}

/// Options that several commands have, in the order in which help lists them: first what is read, last what is written.
/// All others are in between, in the order in which the command adds them.
constexpr std::array first_options{std::string_view("--help"), std::string_view("--with"), std::string_view("--set"),
                                   std::string_view("--vary")};
constexpr std::array last_options{
    std::string_view("--duration-s"), std::string_view("--seed"),      std::string_view("--priority"),
    std::string_view("--core"),       std::string_view("--spin-s"),    std::string_view("--out"),
    std::string_view("--overwrite"),  std::string_view("--log-limit"), std::string_view("--json")};

std::size_t rank_of(const CLI::Option& option) {
  const auto index = [&option](const auto& names) {
    const auto is_it = [&option](std::string_view name) { return option.check_name(std::string(name)); };
    return static_cast<std::size_t>(std::find_if(names.begin(), names.end(), is_it) - names.begin());
  };
  if (const std::size_t at = index(first_options); at < first_options.size()) return at;
  const std::size_t at = index(last_options);
  return first_options.size() + (at < last_options.size() ? 1 + at : 0);
}

/// Help as CLI11 makes it, in lines that fit.
class NarrowHelp final : public CLI::Formatter {
 public:
  std::string make_group(std::string group, bool is_positional,
                         std::vector<const CLI::Option*> options) const override {
    std::stable_sort(options.begin(), options.end(),
                     [](const CLI::Option* one, const CLI::Option* other) { return rank_of(*one) < rank_of(*other); });
    return CLI::Formatter::make_group(std::move(group), is_positional, std::move(options));
  }
  std::string make_footer(const CLI::App* app) const override {
    const std::string example = app->get_footer();
    if (example.empty()) return "";
    std::string lines = in_lines(example, 2, 6, report::text_width() - 2);
    for (std::size_t end = lines.find('\n'); end != std::string::npos; end = lines.find('\n', end + 3)) {
      lines.insert(end, " \\");
    }
    return "Example:\n  " + lines + "\n";
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return two_columns(make_option_name(option, is_positional) + make_option_opts(option), make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* verb) const override {
    return two_columns(verb->get_display_name(true), verb->get_description());
  }
  std::string make_description(const CLI::App* app) const override {
    const std::string text = app->get_description();
    return text.empty() ? "" : in_lines(text, 0, 0, report::text_width()) + "\n";
  }
  std::string make_usage(const CLI::App* app, std::string name) const override {
    return in_lines(CLI::Formatter::make_usage(app, std::move(name)), 0, 4, report::text_width()) + "\n";
  }

 private:
  [[nodiscard]] std::string two_columns(std::string name, const std::string& meaning) const {
    constexpr std::size_t margin = 2, under = 6;
    const std::size_t width = report::text_width(), column = get_column_width();
    if (margin + report::display_width(name) > width) {  // a list of words, which is broken between them
      for (std::size_t at = name.find(','); at != std::string::npos; at = name.find(',', at + 1))
        name.insert(at + 1, " ");
    }
    std::string text = std::string(margin, ' ') + in_lines(name, margin, under, width);
    if (meaning.empty()) return text + "\n";
    const bool beside = margin + report::display_width(name) + 1 < column;
    text += beside ? std::string(column - margin - report::display_width(name), ' ') : "\n" + std::string(column, ' ');
    return text + in_lines(meaning, column, column, width) + "\n";
  }
};

}  // namespace

void set_help(CLI::App& app) { app.formatter(std::make_shared<NarrowHelp>()); }

void add_examples(CLI::App& app) {
  for (const Example& example : examples) {
    CLI::App* at = &app;
    for (std::string_view words = example.command; at != nullptr && !words.empty();) {
      const std::size_t end = std::min(words.find(' '), words.size());
      const std::vector<CLI::App*> below = at->get_subcommands({});
      const auto named = [name = words.substr(0, end)](const CLI::App* one) { return one->get_name() == name; };
      const auto found = std::find_if(below.begin(), below.end(), named);
      at = found == below.end() ? nullptr : *found;
      words.remove_prefix(std::min(end + 1, words.size()));
    }
    if (at == nullptr) continue;
    if (!example.group.empty()) at->group(std::string(example.group));
    at->footer(app.get_name() + " " + std::string(example.words));
  }
}

void add_help(CLI::App& app, int& status) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* verb = app.add_subcommand("help", "Print the help of a command");
  verb->add_option("COMMAND", *words, "Command, with its subcommand, such as identify frf");
  verb->callback([&app, &status, words] {
    const CLI::App* asked = &app;
    for (const std::string& word : *words) {
      const CLI::App* next = verb_below(*asked, word);
      if (next == nullptr) {
        status = report_error(
            app.get_name(),
            {.code = ErrorCode::unknown_key, .parameter = {}, .message = unknown_command(*asked, word), .place = {}});
        return;
      }
      asked = next;
    }
    std::string name = app.get_name();
    for (const std::string& word : *words) name += " " + word;
    result_stream() << asked->get_formatter()->make_help(asked, name, CLI::AppFormatMode::Normal);
  });
}

}  // namespace tactus::cli
