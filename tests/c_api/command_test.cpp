// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <vector>

#include "tests/c_api/files.hpp"

namespace tactus::c_api {
namespace {

using CApiCommand = CApi;

struct Printed {
  int exit_status = -1;
  std::string results, messages;
};

Printed printed_by(const std::vector<std::string>& arguments) {
  const Words words(arguments);
  tactus_outcome outcome = 0;
  tactus_error error = 0;
  EXPECT_EQ(tactus_command(words.data(), words.size(), nullptr, &outcome, &error), TACTUS_OK)
      << (error != 0 ? take(error).line : "");
  tactus_outcome_view view = TACTUS_OUTCOME_VIEW_INIT;
  if (tactus_outcome_read(outcome, &view) != TACTUS_OK) return {};
  Printed printed{.exit_status = view.exit_status,
                  .results = std::string(view.results, view.results_size),
                  .messages = std::string(view.messages, view.messages_size)};
  EXPECT_EQ(tactus_outcome_release(outcome), TACTUS_OK);
  return printed;
}

ErrorTexts refusal_of(const std::vector<std::string>& arguments) {
  const Words words(arguments);
  tactus_outcome outcome = 1;
  tactus_error error = 0;
  const tactus_status status = tactus_command(words.data(), words.size(), nullptr, &outcome, &error);
  EXPECT_NE(status, TACTUS_OK);
  EXPECT_EQ(outcome, 0U);
  if (error == 0) return {};
  ErrorTexts texts = take(error);
  EXPECT_EQ(texts.status, status);
  return texts;
}

TEST_F(CApiCommand, ResultsAndMessagesAreWhatTheCommandPrints) {
  const std::string experiment = quick_experiment();
  const Printed json = printed_by({"run", experiment, "--json", "--out", (folder() / "left").string()});
  EXPECT_EQ(json.exit_status, 0);
  EXPECT_TRUE(json.results.starts_with("{")) << json.results;
  EXPECT_NE(json.results.find("\"command\": \"tactus run "), std::string::npos) << json.results.substr(0, 300);
  EXPECT_TRUE(json.messages.starts_with("Report: ")) << json.messages;
  EXPECT_TRUE(std::filesystem::exists(folder() / "left/report.html"));
  const Printed table = printed_by({"run", experiment});
  EXPECT_NE(table.results.find("verdict"), std::string::npos);
  EXPECT_EQ(table.messages, "");
  EXPECT_TRUE(printed_by({"--version"}).results.starts_with("tactus "));
  EXPECT_NE(printed_by({"help", "run"}).results.find("--set"), std::string::npos);
}

TEST_F(CApiCommand, AnErrorHasTheCommandsMessageAndItsParts) {
  const ErrorTexts texts = refusal_of({"run", quick_experiment(), "--set", "control.force_gain=-1"});
  EXPECT_EQ(texts.status, TACTUS_OUT_OF_BOUNDS);
  EXPECT_EQ(texts.exit_status, 2);
  EXPECT_EQ(texts.place, "--set control.force_gain=-1");
  EXPECT_EQ(texts.parameter, "control.force_gain");
  EXPECT_EQ(texts.value, "-1");
  EXPECT_EQ(texts.bounds, "must be at least 0 and at most 1000");
  EXPECT_EQ(texts.line,
            "--set control.force_gain=-1: control.force_gain: -1 is out of bounds: it must be at least 0 "
            "and at most 1000");
  EXPECT_EQ(refusal_of({"run", "missing.toml"}).status, TACTUS_MISSING);
  EXPECT_EQ(refusal_of({"rum"}).line.find("'rum' is no command"), 0U);
  EXPECT_EQ(refusal_of({}).status, TACTUS_SYNTAX);
}

TEST_F(CApiCommand, WhatNeedsAProcessOfItsOwnIsRefused) {
  for (const char* verb : {"device", "doctor", "emulate", "plant", "relay", "serve", "--plugin", "--plugin=x.so"}) {
    const ErrorTexts texts = refusal_of({verb, "list"});
    EXPECT_EQ(texts.status, TACTUS_INCONSISTENT) << verb;
    EXPECT_EQ(texts.remedy, "start the command `tactus` as a program") << verb;
  }
  for (const char* clock : {"--realtime", "--ros2"}) {
    const ErrorTexts texts = refusal_of({"run", quick_experiment(), clock});
    EXPECT_EQ(texts.status, TACTUS_INCONSISTENT) << clock;
    EXPECT_EQ(texts.remedy, "start the command `tactus` as a program of its own") << clock;
  }
}

struct Watch {
  int calls = 0;
  int end_after = 0;  ///< 0: never
  double last = -1.0;
  tactus_status nested = TACTUS_OK;
  tactus_status opened = TACTUS_OK;
};

int32_t watch(double done, void* user) {
  auto& seen = *static_cast<Watch*>(user);
  ++seen.calls;
  EXPECT_GE(done, seen.last);
  seen.last = done;
  tactus_outcome outcome = 0;
  tactus_log log = 0;
  const Words words({"--version"});
  seen.nested = tactus_command(words.data(), words.size(), nullptr, &outcome, nullptr);
  seen.opened = tactus_log_open("/dev/null", nullptr, &log, nullptr);
  return seen.calls == seen.end_after ? 1 : 0;
}

TEST_F(CApiCommand, ProgressIsReportedAndEndsTheCommand) {
  const Words words({"run", quick_experiment(), "--json", "--vary", "control.force_gain=1,2,3", "--out",
                     (folder() / "left").string()});
  Watch seen;
  tactus_command_options options = TACTUS_COMMAND_OPTIONS_INIT;
  options.progress = watch;
  options.user = &seen;
  tactus_outcome outcome = 0;
  tactus_error error = 0;
  seen.end_after = 1;
  ASSERT_EQ(tactus_command(words.data(), words.size(), &options, &outcome, &error), TACTUS_INTERRUPTED);
  EXPECT_EQ(seen.calls, 1);
  EXPECT_EQ(take(error).line, "interrupted: run it again");
  EXPECT_FALSE(std::filesystem::exists(folder() / "left")) << "nothing is left of a run that was ended";
  EXPECT_EQ(seen.nested, TACTUS_FAILED) << "a command in a command";
  EXPECT_EQ(seen.opened, TACTUS_FAILED);
  seen = {};
  ASSERT_EQ(tactus_command(words.data(), words.size(), &options, &outcome, &error), TACTUS_OK);
  EXPECT_GE(seen.calls, 1);
  EXPECT_EQ(tactus_outcome_release(outcome), TACTUS_OK);
}

TEST_F(CApiCommand, ARecordingAndALogAreColumnsWithTheirUnits) {
  const std::string table = write("table.csv", "time_s,force [N]\n0,1.5\n0.001,2\n0.002,-3\n");
  tactus_log log = 0;
  ASSERT_EQ(tactus_log_open(table.c_str(), nullptr, &log, nullptr), TACTUS_OK);
  tactus_table_view view = TACTUS_TABLE_VIEW_INIT;
  ASSERT_EQ(tactus_log_table(log, 0, &view), TACTUS_OK);
  EXPECT_EQ(std::string(view.name), "table.csv");
  EXPECT_EQ(view.rows, 3U);
  ASSERT_EQ(view.columns, 2U);
  EXPECT_EQ(view.times_ns, nullptr);
  tactus_column_view column = TACTUS_COLUMN_VIEW_INIT;
  ASSERT_EQ(tactus_log_column(log, 0, 1, &column), TACTUS_OK);
  EXPECT_EQ(std::string(column.name), "force");
  EXPECT_EQ(std::string(column.unit), "N");
  EXPECT_EQ(std::vector<double>(column.values, column.values + column.rows), (std::vector<double>{1.5, 2.0, -3.0}));
  EXPECT_EQ(tactus_log_table(log, 1, &view), TACTUS_OUT_OF_BOUNDS);
  EXPECT_EQ(tactus_log_column(log, 0, 2, &column), TACTUS_OUT_OF_BOUNDS);
  EXPECT_EQ(tactus_log_release(log), TACTUS_OK);

  printed_by({"run", quick_experiment(), "--out", (folder() / "left").string()});
  ASSERT_EQ(tactus_log_open((folder() / "left/log").c_str(), nullptr, &log, nullptr), TACTUS_OK);
  tactus_log_view content = TACTUS_LOG_VIEW_INIT;
  ASSERT_EQ(tactus_log_read(log, &content), TACTUS_OK);
  EXPECT_EQ(content.complete, 1);
  ASSERT_GE(content.tables, 1U);
  ASSERT_EQ(tactus_log_table(log, 0, &view), TACTUS_OK);
  EXPECT_GT(view.rows, 100U);
  ASSERT_NE(view.times_ns, nullptr);
  EXPECT_LT(view.times_ns[0], view.times_ns[view.rows - 1]);
  ASSERT_EQ(tactus_log_column(log, 0, 0, &column), TACTUS_OK);
  EXPECT_EQ(column.rows, view.rows);
  EXPECT_EQ(tactus_log_release(log), TACTUS_OK);

  tactus_error error = 0;
  ASSERT_EQ(tactus_log_open((folder() / "none.mcap").c_str(), nullptr, &log, &error), TACTUS_MISSING);
  EXPECT_NE(take(error).line.find("none.mcap"), std::string::npos);
  EXPECT_EQ(log, 0U);
}

}  // namespace
}  // namespace tactus::c_api
