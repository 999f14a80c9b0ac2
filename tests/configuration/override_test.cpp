// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>

#include <string>

#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

using testing::Cancellation;
using testing::Experiment;

Document document(std::string_view text = "[control]\nforce_gain = 2\n[task]\nkind = \"hold\"\n") {
  return *Document::parse(text, "t.toml");
}

Check set_and_read(std::string_view assignment) {
  Document written = document();
  if (Check problem = written.set(assignment)) return problem;
  const Result<Experiment> read = written.read<Experiment>();
  return read ? Check{} : Check(read.error());
}

void expect_override_error(std::string_view assignment, ErrorCode code, std::string_view description) {
  const Check error = set_and_read(assignment);
  ASSERT_TRUE(error) << assignment;
  EXPECT_EQ(error->code, code) << assignment;
  EXPECT_EQ(describe(*error), description);
}

TEST(Override, ItReplacesWhatTheFileSaysAndAddsWhatItDoesNot) {
  Document written = document();
  for (const char* assignment : {"control.force_gain=3", " control.cancellation = off ", "duration_s=7",
                                 "slave.velocity_filter.enabled=false", "slave.velocity_filter.cutoff_Hz=1e2"}) {
    const Check problem = written.set(assignment);
    EXPECT_FALSE(problem) << describe(*problem);
  }
  const Result<Experiment> read = written.read<Experiment>();
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->control.force_gain, 3.0);
  EXPECT_EQ(read->control.cancellation, Cancellation::off);
  EXPECT_EQ(read->duration_s, 7.0);
  EXPECT_FALSE(read->slave.velocity_filter.enabled);
  EXPECT_EQ(read->slave.velocity_filter.cutoff_Hz, 100.0);
  EXPECT_EQ(read->task.kind, "hold") << "untouched";
}

TEST(Override, OfAKeyThatIsOverriddenTwiceTheLastWins) {
  Document written = document();
  EXPECT_FALSE(written.set("control.force_gain=-1"));
  EXPECT_FALSE(written.set("control.force_gain=4"));
  EXPECT_EQ(written.read<Experiment>()->control.force_gain, 4.0);
}

TEST(Override, ItMendsABadValueInTheFile) {
  Document written = document("[control]\nforce_gain = 'high'\n");
  EXPECT_FALSE(written.set("control.force_gain=4"));
  EXPECT_EQ(written.read<Experiment>()->control.force_gain, 4.0);
}

TEST(Override, ACopyOfADocumentIsIndependent) {
  const Document original = document();
  Document copy = original;
  EXPECT_FALSE(copy.set("control.force_gain=9"));
  EXPECT_EQ(original.read<Experiment>()->control.force_gain, 2.0);
  EXPECT_EQ(copy.read<Experiment>()->control.force_gain, 9.0);
}

TEST(Override, ATextTakesWhatWasTypedEvenWhereTomlSeesAnotherType) {
  for (const std::string text :
       {"plain", "a b", "7", "true", "2024-01-01", "1 # x", "[x", "{", "a=b", "a\nb = 2", "\"", "x\"y", "\\", ""}) {
    Document written = document();
    const Check problem = written.set("task.recording=" + text);
    EXPECT_FALSE(problem) << describe(*problem);
    EXPECT_EQ(written.read<Experiment>()->task.recording, text);
  }
  Document written = document();
  EXPECT_FALSE(written.set("task.recording=\" quoted\\t\""));
  EXPECT_EQ(written.read<Experiment>()->task.recording, " quoted\t");
}

TEST(Override, ItsErrorsSayWhatWasTyped) {
  expect_override_error(
      "control.force_gain=-1", ErrorCode::out_of_bounds,
      "--set control.force_gain=-1: control.force_gain: -1 is out of bounds: it must be at least 0 and at most 10");
  expect_override_error("control.forcegain=1", ErrorCode::unknown_key,
                        "--set control.forcegain=1: control.forcegain: unknown key: did you mean force_gain?");
  expect_override_error("contro.force_gain=1", ErrorCode::unknown_key,
                        "--set contro.force_gain=1: contro: unknown section: did you mean control?");
  expect_override_error(
      "control.taps=many", ErrorCode::wrong_type,
      "--set control.taps=many: control.taps: \"many\" is a text, but a whole number is asked for, and it "
      "must be at least 1 and at most 4096: write for instance taps = 32");
  expect_override_error(
      "control.cancellation=7", ErrorCode::out_of_bounds,
      "--set control.cancellation=7: control.cancellation: \"7\" is no choice here: it must be \"off\", "
      "\"model\" or \"adaptive\"");
}

TEST(Override, AMalformedAssignmentIsRefusedAtOnce) {
  expect_override_error("control.force_gain", ErrorCode::syntax,
                        "--set control.force_gain: there is no = in it: write key=value, as in control.force_gain=3");
  EXPECT_EQ(set_and_read("")->code, ErrorCode::syntax);
  for (const std::string key : {"", " ", ".", "a.", ".a", "a..b", "a b", "\"a\"", "[a]", "\xff"}) {
    Document written = document();
    const Check problem = written.set(key + "=1");
    ASSERT_TRUE(problem) << key;
    EXPECT_EQ(problem->code, ErrorCode::syntax);
    EXPECT_NE(problem->message.find("is no key"), std::string::npos) << problem->message;
    EXPECT_EQ(written.read<Experiment>()->control.force_gain, 2.0) << "and changes nothing";
  }
  EXPECT_EQ(set_and_read("task.recording=\xff\xfe")->code, ErrorCode::syntax);
  std::string deep = "a";
  for (int i = 0; i < 100000; ++i) deep += ".a";
  EXPECT_EQ(set_and_read(deep + "=1")->code, ErrorCode::syntax);
}

TEST(Override, ASectionAndAValueDoNotTakeEachOthersPlace) {
  expect_override_error("task.kind.speed=3", ErrorCode::wrong_type,
                        "--set task.kind.speed=3: task.kind.speed: task.kind is a value, so no key can lie below it");
  expect_override_error("control=3", ErrorCode::wrong_type,
                        "--set control=3: control: this is a section: set one of its keys, as in control.some_key=3");
  expect_override_error(
      "slave={mass_kg=1}", ErrorCode::wrong_type,
      "--set slave={mass_kg=1}: slave: a section cannot be set at once: set each of its keys, as in slave.some_key=3");
  expect_override_error(
      "slave=3", ErrorCode::wrong_type,
      "--set slave=3: slave: 3 is a whole number, but a section is asked for: write [slave] with its keys below it");
  expect_override_error(
      "slave.mass_kg.x=3", ErrorCode::wrong_type,
      "--set slave.mass_kg.x=3: slave.mass_kg: this is a section, but a number in kg is asked for, and it "
      "must be finite and greater than 0 kg: write for instance mass_kg = 0.5");
}

TEST(Merge, AnotherFilesKeysTakeThePlaceOfTheFirstsAndTheRestStay) {
  Document written = document("duration_s = 3\n[control]\nforce_gain = 2\n[task]\nkind = \"hold\"\n");
  const Document other = *Document::parse("[slave]\nmass_kg = 2\n[control]\nforce_gain = 7\n", "model.toml");
  ASSERT_FALSE(written.merge(other));
  const Result<Experiment> read = written.read<Experiment>();
  ASSERT_TRUE(read) << describe(read.error());
  EXPECT_EQ(read->control.force_gain, 7.0);
  EXPECT_EQ(read->slave.mass_kg, 2.0);
  EXPECT_EQ(read->duration_s, 3.0);
  ASSERT_FALSE(written.set("control.force_gain=1"));
  EXPECT_EQ(written.read<Experiment>()->control.force_gain, 1.0);
}

TEST(Merge, AnErrorNamesTheFileThatTheKeyCameFrom) {
  Document written = document();
  ASSERT_FALSE(written.merge(*Document::parse("[slave]\nmas_kg = 2\n", "model.toml")));
  ASSERT_FALSE(written.read<Experiment>());
  EXPECT_EQ(written.read<Experiment>().error().place, "model.toml:2:1");
  written = document();
  ASSERT_FALSE(written.merge(*Document::parse("[control]\nforce_gain = -2\n", "model.toml")));
  EXPECT_EQ(written.read<Experiment>().error().place, "model.toml:2:14");
}

TEST(Merge, ASectionDoesNotReplaceAValueNorAValueASection) {
  Document written = document();
  const Check value = written.merge(*Document::parse("control = 3\n", "model.toml"));
  ASSERT_TRUE(value);
  EXPECT_EQ(value->code, ErrorCode::wrong_type);
  EXPECT_EQ(value->place, "model.toml:1:1");
  const Check section = written.merge(*Document::parse("[control.force_gain]\nx = 1\n", "model.toml"));
  ASSERT_TRUE(section);
  EXPECT_EQ(section->parameter, "control.force_gain");
}

}  // namespace
}  // namespace tactus::configuration
