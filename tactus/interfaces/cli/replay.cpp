// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <array>
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

struct ReplayOptions {
  std::string log;
  bool check = false;
  JsonOption json;
};

/// With all digits: two numbers that differ look different.
std::string exact(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.17g", value);
  return text.data();
}

std::string text_of(const runtime::Replay& replay) {
  std::string text = "Replayed " + std::to_string(replay.ticks) + " control cycles of " + replay.of + ": ";
  if (const auto& found = replay.difference) {
    const std::string tap = replay.taps > 0 ? " of tap " + std::to_string(found->tap) : "";
    text += "the first difference is in control cycle " + std::to_string(found->tick) + tap + ", topic " +
            found->topic + (found->joint.empty() ? "" : " (" + report::printable(found->joint) + ")") + ", signal " +
            found->signal + ": recorded " + exact(found->recorded) + ", replayed " + exact(found->replayed) + ".\n";
    if (replay.version != version()) {
      text += "The log was written by version " + replay.version + ", this is " + std::string(version()) + ".\n";
    }
    return text;
  }
  return text + "every output is the recorded one, bit for bit.\n";
}

std::string json_of(const runtime::Replay& replay) {
  nlohmann::ordered_json document{{"of", replay.of},
                                  {"taps", replay.taps},
                                  {"ticks", replay.ticks},
                                  {"equal", !replay.difference.has_value()},
                                  {"log_version", replay.version}};
  if (const auto& found = replay.difference) {
    document["difference"] = {{"topic", found->topic},      {"joint", found->joint},   {"tap", found->tap},
                              {"tick", found->tick},        {"signal", found->signal}, {"recorded", found->recorded},
                              {"replayed", found->replayed}};
  }
  return report::json_text(document);
}

}  // namespace

void add_replay(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* verb =
      app.add_subcommand("replay", "Repeat the control cycles of a logged run with the logged readings, and compare");
  verb->add_option("LOG", options->log,
                   "Log (.mcap), or its folder, of `run --realtime --out` or `run --site --out`, with or without a rig")
      ->required();
  verb->add_flag("--check", options->check, "Exit with status 1 if anything differs from the log");
  add_json_option(*verb, options->json, command);
  verb->callback([options, &app, &status] {
    const auto replayed = real_time::replay(options->log);
    if (!replayed) {
      status = report_error(app.get_name(), replayed.error());
      return;
    }
    result_stream() << (options->json.wanted ? options->json.document(json_of(*replayed)) : text_of(*replayed));
    if (options->check && replayed->difference) status = 1;
  });
}

}  // namespace tactus::cli
