// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/teleoperator/fault_plan.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

using namespace tactus;

namespace {

/// One of each: numbers, whole numbers, choices, groups and text.
struct Everything {
  simulation::FaultPlan plan{};
  simulation::Impairment link{};
  std::string text = "text";
  static constexpr auto fields() {
    return List{field("plan", &Everything::plan, "A plan."), field("link", &Everything::link, "A link."),
                field("text", &Everything::text, "A text.")};
  }
};

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

/// The input is a file, and after a zero byte overrides, one a line. What is accepted is within its bounds, and what is
/// written of it reads as the same.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const std::size_t end = input.find('\0');
  auto document = configuration::Document::parse(input.substr(0, end), "input");
  if (!document) {
    demand(!document.error().message.empty());
    return 0;
  }
  std::string_view rest = end == std::string_view::npos ? "" : input.substr(end + 1);
  while (!rest.empty()) {
    const std::size_t line = rest.find('\n');
    (void)document->set(rest.substr(0, line));
    rest = line == std::string_view::npos ? "" : rest.substr(line + 1);
  }
  (void)document->text_at("text");
  const auto read = document->read<Everything>();
  if (!read) {
    demand(!describe(read.error()).empty());
    return 0;
  }
  demand(!validate(*read));
  const std::string written = configuration::to_toml(*read);
  const auto again = configuration::Document::parse(written, "written");
  demand(static_cast<bool>(again));
  const auto same = again->read<Everything>();
  demand(same && configuration::to_toml(*same) == written);
  return 0;
}
