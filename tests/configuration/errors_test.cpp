// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>

#include <string>

#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

using testing::Experiment;

Error error_of(std::string_view text) {
  const Result<Document> document = Document::parse(text, "t.toml");
  if (!document) return document.error();
  const Result<Experiment> experiment = document->read<Experiment>();
  if (experiment) {
    ADD_FAILURE() << "accepted: " << text;
    return {};
  }
  return experiment.error();
}

void expect_error(std::string_view text, ErrorCode code, std::string_view description) {
  const Error error = error_of(text);
  EXPECT_EQ(error.code, code) << text;
  EXPECT_EQ(describe(error), description);
  EXPECT_EQ(exit_status(error), 2);
}

TEST(ConfigurationErrors, AValueOutOfBoundsIsNamedWithPlaceBoundsAndUnit) {
  expect_error("[slave]\n  mass_kg = 0.0", ErrorCode::out_of_bounds,
               "t.toml:2:13: slave.mass_kg: 0 kg is out of bounds: it must be finite and greater than 0 kg");
  expect_error("[control]\ntaps = 4097", ErrorCode::out_of_bounds,
               "t.toml:2:8: control.taps: 4097 is out of bounds: it must be at least 1 and at most 4096");
  EXPECT_EQ(error_of("control.taps = 9223372036854775807").code, ErrorCode::out_of_bounds);
  EXPECT_EQ(error_of("control.taps = -9223372036854775808").code, ErrorCode::out_of_bounds);
  expect_error("control.taps = 123456", ErrorCode::out_of_bounds,
               "t.toml:1:16: control.taps: 123456 is out of bounds: it must be at least 1 and at most 4096");
  expect_error("[slave.velocity_filter]\ncutoff_Hz = 20001", ErrorCode::out_of_bounds,
               "t.toml:2:13: slave.velocity_filter.cutoff_Hz: 20001 Hz is out of bounds: it must be greater than 0 Hz "
               "and at most 20000 Hz");
}

TEST(ConfigurationErrors, WhatIsNotFiniteIsOutOfAnyBounds) {
  for (const char* value : {"nan", "inf", "-inf", "+nan"}) {
    EXPECT_EQ(error_of(std::string("slave.offset_m = ") + value).code, ErrorCode::out_of_bounds) << value;
    EXPECT_EQ(error_of(std::string("slave.stiffness_N_per_m = ") + value).code, ErrorCode::out_of_bounds) << value;
  }
  expect_error("slave.offset_m = inf", ErrorCode::out_of_bounds,
               "t.toml:1:18: slave.offset_m: inf m is out of bounds: it must be finite");
}

TEST(ConfigurationErrors, AnUnknownKeyIsNamedWithTheNearestOneMeant) {
  expect_error("[control]\nforse_gain = 3", ErrorCode::unknown_key,
               "t.toml:2:1: control.forse_gain: unknown key: did you mean force_gain?");
  expect_error("[contrl]\nforce_gain = 3", ErrorCode::unknown_key,
               "t.toml:1:2: contrl: unknown section: did you mean control?");
  expect_error("force_gain = 3", ErrorCode::unknown_key,
               "t.toml:1:1: force_gain: unknown key: did you mean control.force_gain?");
  expect_error("control_force_gain = 3", ErrorCode::unknown_key,
               "t.toml:1:1: control_force_gain: unknown key: did you mean control.force_gain?");
  expect_error("slave.velocity_filter.cutoff = 3", ErrorCode::unknown_key,
               "t.toml:1:23: slave.velocity_filter.cutoff: unknown key: did you mean cutoff_Hz?");
  expect_error("[velocity_filter]", ErrorCode::unknown_key,
               "t.toml:1:2: velocity_filter: unknown section: did you mean slave.velocity_filter?");
}

TEST(ConfigurationErrors, WithNothingNearTheKeysThereAreAreListed) {
  expect_error("[control]\nviscosity = 3", ErrorCode::unknown_key,
               "t.toml:2:1: control.viscosity: unknown key: [control] can have force_gain, cancellation, taps, seed");
  expect_error("[weather]", ErrorCode::unknown_key,
               "t.toml:1:2: weather: unknown section: the file can have slave, control, task, duration_s");
}

TEST(ConfigurationErrors, AQuotedKeyWithADotIsNotMistakenForAKeyInASection) {
  expect_error("\"control.taps\" = 3", ErrorCode::unknown_key,
               "t.toml:1:1: \"control.taps\": unknown key: did you mean control.taps?");
}

TEST(ConfigurationErrors, AWrongTypeIsNamedWithWhatIsAskedForAndAnExample) {
  expect_error("slave.mass_kg = 'heavy'", ErrorCode::wrong_type,
               "t.toml:1:17: slave.mass_kg: \"heavy\" is a text, but a number in kg is asked for, and it must be "
               "finite and greater than 0 kg: write for instance mass_kg = 0.5");
  expect_error("control.taps = 3.5", ErrorCode::wrong_type,
               "t.toml:1:16: control.taps: 3.5 is a decimal number, but a whole number is asked for, and it must be at "
               "least 1 and at most 4096: write for instance taps = 32");
  expect_error("control.seed = 3.0", ErrorCode::wrong_type,
               "t.toml:1:16: control.seed: 3.0 is a decimal number, but a whole number is asked for: write for "
               "instance seed = 1");
  expect_error("control.taps = 3.0", ErrorCode::wrong_type,
               "t.toml:1:16: control.taps: 3.0 is a decimal number, but a whole number is asked for, and it must be at "
               "least 1 and at most 4096: write for instance taps = 32");
  expect_error("[slave]\nvelocity_filter.enabled = 1", ErrorCode::wrong_type,
               "t.toml:2:27: slave.velocity_filter.enabled: 1 is a whole number, but true or false is asked for: write "
               "for instance enabled = true");
  expect_error("task.kind = 2024-01-01", ErrorCode::wrong_type,
               "t.toml:1:13: task.kind: this is a date, but a text in quotes is asked for: write for instance kind = "
               "\"tapping\"");
  expect_error("control.cancellation = true", ErrorCode::wrong_type,
               "t.toml:1:24: control.cancellation: true is a boolean, but \"off\", \"model\" or \"adaptive\" is asked "
               "for: write for instance cancellation = \"model\"");
  for (const char* value : {"[1]", "12:00:00", "2024-01-01T12:00:00Z", "true", "''"}) {
    EXPECT_EQ(error_of(std::string("duration_s = ") + value).code, ErrorCode::wrong_type) << value;
  }
}

TEST(ConfigurationErrors, ASectionIsNoValueAndAValueIsNoSection) {
  expect_error("[slave.mass_kg]\nx = 1", ErrorCode::wrong_type,
               "t.toml:1:1: slave.mass_kg: this is a section, but a number in kg is asked for, and it must be finite "
               "and greater than 0 kg: write for instance mass_kg = 0.5");
  expect_error(
      "slave = 3", ErrorCode::wrong_type,
      "t.toml:1:9: slave: 3 is a whole number, but a section is asked for: write [slave] with its keys below it");
  expect_error("[[slave]]\nmass_kg = 1", ErrorCode::wrong_type,
               "t.toml:1:1: slave: this is an array, but a section is asked for: write [slave] with its keys below it");
}

TEST(ConfigurationErrors, AnUnknownWordIsNamedWithTheWordsThereAreAndTheNearest) {
  expect_error("control.cancellation = 'modle'", ErrorCode::out_of_bounds,
               "t.toml:1:24: control.cancellation: \"modle\" is no choice here: it must be \"off\", \"model\" or "
               "\"adaptive\"; did you mean \"model\"?");
  expect_error(
      "control.cancellation = 'full'", ErrorCode::out_of_bounds,
      "t.toml:1:24: control.cancellation: \"full\" is no choice here: it must be \"off\", \"model\" or \"adaptive\"");
}

TEST(ConfigurationErrors, TheFirstErrorInTheFileIsTheOneReported) {
  EXPECT_EQ(error_of("[task]\nkind = 1\n[slave]\nmass_kg = -1\n[control]\nx = 1").place, "t.toml:2:8");
  EXPECT_EQ(error_of("[slave]\nmass_kg = -1\n[task]\nkind = 1\n[control]\nx = 1").place, "t.toml:2:11");
  EXPECT_EQ(error_of("[control]\nx = 1\n[slave]\nmass_kg = -1\n[task]\nkind = 1").place, "t.toml:2:1");
}

TEST(ConfigurationErrors, BrokenTomlIsASyntaxErrorAtItsLine) {
  const auto expect_syntax = [](std::string_view text, std::string_view place) {
    const Error error = error_of(text);
    EXPECT_EQ(error.code, ErrorCode::syntax) << text;
    EXPECT_TRUE(error.place.starts_with(place)) << text << ": " << error.place;
    EXPECT_FALSE(error.message.empty());
  };
  expect_syntax("[control]\ntaps = 1\ntaps = 2", "t.toml:3:");
  expect_syntax("[control]\n[control]\n", "t.toml:2:");
  expect_syntax("a = 1\n[slave\nmass_kg = 1", "t.toml:2:");
  expect_syntax("a = \n", "t.toml:1:");
  expect_syntax("a = 99999999999999999999", "t.toml:1:");
  expect_syntax("a = 1e999", "t.toml:1:");
  expect_syntax("a = \"\xff\"", "t.toml:1:");
  expect_syntax(std::string_view("\177ELF\002\000\000\377", 8), "t.toml:1:");
  EXPECT_NE(error_of("a = off").message.find("a text needs quotes, as in \"off\""), std::string::npos);
}

}  // namespace
}  // namespace tactus::configuration
