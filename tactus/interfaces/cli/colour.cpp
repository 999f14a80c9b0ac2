// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/colour.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>

#include <unistd.h>

namespace tactus::cli {

namespace {

constexpr std::string_view green = "\x1b[32m", yellow = "\x1b[33m", red = "\x1b[31m", bold_red = "\x1b[1;31m",
                           uncoloured = "\x1b[0m";

struct Tinted {
  std::string_view word, colour;
};
constexpr std::array<Tinted, 11> verdicts{{{"settled", green},
                                           {"good", green},
                                           {"well", green},
                                           {"ringing", yellow},
                                           {"poor", yellow},
                                           {"not asked", yellow},
                                           {"limit-cycle", red},
                                           {"diverged", red},
                                           {"stopped", red},
                                           {"bad", red},
                                           {"wrong", red}}};

std::string tinted(std::string_view text, std::string_view colour) {
  return std::string(colour) + std::string(text) + std::string(uncoloured);
}

/// A cell of a table: colour for a verdict, alone or with its cause behind a colon.
std::string painted_cell(std::string_view text) {
  const std::string_view verdict = text.substr(0, text.find(':'));
  const auto found = std::find_if(verdicts.begin(), verdicts.end(), [&](const Tinted& t) { return t.word == verdict; });
  if (found == verdicts.end()) return std::string(text);
  return tinted(verdict, found->colour) + std::string(text.substr(verdict.size()));
}

}  // namespace

bool shows_colour(int descriptor) {
  const char* refused = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(descriptor) == 1 && (refused == nullptr || *refused == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

std::string Painter::paint(std::string_view line) {
  if (line.starts_with("─")) {
    rules_ = (rules_ + 1) % 3;
    return std::string(line);
  }
  if (rules_ != 2) {
    const bool error = line.size() > name_.size() && line.starts_with(name_) && line[name_.size()] == ':';
    if (!error) return std::string(line);
    return tinted(line.substr(0, name_.size() + 1), bold_red) + std::string(line.substr(name_.size() + 1));
  }
  std::string painted;
  while (!line.empty()) {
    const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size());
    painted += line.substr(0, blanks);
    line.remove_prefix(blanks);
    const std::size_t end = std::min(line.find("  "), line.size());
    painted += painted_cell(line.substr(0, end));
    line.remove_prefix(end);
  }
  return painted;
}

}  // namespace tactus::cli
