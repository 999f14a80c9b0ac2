#include <tactus/cli/help.hpp>
#include <tactus/cli/streams.hpp>
#include <tactus/cli/suggestion.hpp>
#include <tactus/report/text.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
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

/// Help as CLI11 makes it, in lines that fit.
class NarrowHelp final : public CLI::Formatter {
 public:
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

void add_help(CLI::App& app, int& status) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* verb = app.add_subcommand("help", "Print the help of a verb");
  verb->add_option("VERB", *words, "The verb, with the one below it, as in identify frf");
  verb->callback([&app, &status, words] {
    const CLI::App* asked = &app;
    for (const std::string& word : *words) {
      const CLI::App* next = verb_below(*asked, word);
      if (next == nullptr) {
        status = report_error(
            app.get_name(),
            {.code = ErrorCode::unknown_key, .parameter = {}, .message = unknown_verb(*asked, word), .place = {}});
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
