// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

using testing::Cancellation;
using testing::Experiment;

Experiment read(std::string_view text) {
  const Result<Document> document = Document::parse(text, "test.toml");
  if (!document) {
    ADD_FAILURE() << describe(document.error());
    return {};
  }
  const Result<Experiment> experiment = document->read<Experiment>();
  if (!experiment) {
    ADD_FAILURE() << describe(experiment.error());
    return {};
  }
  return *experiment;
}

/// A file in the temporary folder, removed at the end.
class File {
 public:
  explicit File(std::string_view content) : path_(scratch_path().replace_extension(".toml")) {
    std::ofstream(path_, std::ios::binary) << content;
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { std::filesystem::remove(path_); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

TEST(Document, EveryKindOfValueReachesItsMember) {
  const Experiment experiment = read(R"(
duration_s = 0.25
[slave]
mass_kg = 2
offset_m = -1e-3
velocity_filter = { cutoff_Hz = 40.5, enabled = false }
[control]
cancellation = "adaptive"
taps = 64
seed = -9007199254740993
[task]
kind = "b\u00e4r"
recording = '/data/a b.csv'
)");
  EXPECT_EQ(experiment.duration_s, 0.25);
  EXPECT_EQ(experiment.slave.mass_kg, 2.0);
  EXPECT_EQ(experiment.slave.offset_m, -1e-3);
  EXPECT_EQ(experiment.slave.velocity_filter.cutoff_Hz, 40.5);
  EXPECT_FALSE(experiment.slave.velocity_filter.enabled);
  EXPECT_EQ(experiment.control.cancellation, Cancellation::adaptive);
  EXPECT_EQ(experiment.control.taps, 64);
  EXPECT_EQ(experiment.control.seed, -9007199254740993);
  EXPECT_EQ(experiment.task.kind, "b\xc3\xa4r");
  EXPECT_EQ(experiment.task.recording, "/data/a b.csv");
}

TEST(Document, KeysThatAreNotWrittenKeepTheirDefaults) {
  EXPECT_EQ(read(""), Experiment{});
  EXPECT_EQ(read("# nothing but a comment"), Experiment{});
  Experiment expected;
  expected.control.taps = 7;
  EXPECT_EQ(read("[control]\ntaps = 7"), expected);
}

TEST(Document, AByteOrderMarkAndWindowsLineEndsAreFine) {
  EXPECT_EQ(read("\xEF\xBB\xBF[control]\r\nforce_gain = 2\r\n").control.force_gain, 2.0);
}

TEST(Document, AWholeNumberBeyondTheExactOnesOfADoubleIsRoundedToTheNearest) {
  EXPECT_EQ(read("slave.offset_m = 9007199254740993").slave.offset_m, 9007199254740992.0);
  EXPECT_EQ(read("slave.offset_m = 9223372036854775807").slave.offset_m, 9223372036854775808.0);
}

TEST(Document, AFileIsReadAndNamesItselfInErrors) {
  const File file("[control]\nforce_gain = 3\n");
  const Result<Document> document = Document::load(file.path());
  ASSERT_TRUE(document) << describe(document.error());
  EXPECT_EQ(document->read<Experiment>()->control.force_gain, 3.0);

  const File broken("[control]\nforce_gain = -3\n");
  EXPECT_EQ(Document::load(broken.path())->read<Experiment>().error().place, broken.path().string() + ":2:14");
}

TEST(Document, WhatIsNoReadableFileIsRefusedByName) {
  const auto refused = [](const std::filesystem::path& path, std::string_view part) {
    const Result<Document> document = Document::load(path);
    ASSERT_FALSE(document) << path;
    EXPECT_EQ(document.error().code, ErrorCode::missing);
    EXPECT_EQ(document.error().place, path.string());
    EXPECT_NE(document.error().message.find(part), std::string::npos) << document.error().message;
    EXPECT_EQ(exit_status(document.error()), 2);
  };
  refused("no/such/file.toml", "there is no such file");
  refused(std::filesystem::temp_directory_path(), "this is a folder");
  refused("/proc/self/mem", "cannot be read");
  refused("/dev/zero", "longer than the 1 MiB");
  refused("/dev/null", "the file is empty");
  const File blank(" \r\n\t\n");
  refused(blank.path(), "the file is empty");
  refused(blank.path() / "below", "there is no such file");
}

TEST(Document, OneTextCanBeReadBeforeTheRestIsKnown) {
  Result<Document> document = Document::parse("[task]\nkind = \"tapping\"\nrecording = 3", "test.toml");
  ASSERT_TRUE(document);
  EXPECT_EQ(*document->text_at("task.kind"), "tapping");
  EXPECT_EQ(describe(document->text_at("task.mode").error()),
            "test.toml: task.mode: this key is needed: write mode = \"...\" under [task]");
  EXPECT_EQ(document->text_at("task.mode").error().code, ErrorCode::missing);
  EXPECT_EQ(document->text_at("task.recording").error().code, ErrorCode::wrong_type);
  EXPECT_EQ(document->text_at("task.recording").error().place, "test.toml:3:13");
  EXPECT_EQ(document->text_at("task").error().code, ErrorCode::wrong_type);
  EXPECT_FALSE(document->set("task.kind=hold"));
  EXPECT_EQ(*document->text_at("task.kind"), "hold");
}

TEST(Document, OneDocumentFillsSeveralStructsEachInItsSection) {
  const auto document = Document::parse("[sites.slave]\nmass_kg = 3\n[control]\ntaps = 5", "test.toml");
  ASSERT_TRUE(document);
  testing::Slave slave;
  testing::Control control;
  std::vector<Binding> bindings = bind(slave, "sites.slave");
  for (const Binding& binding : bind(control, "control")) bindings.push_back(binding);
  const Check problem = document->read(bindings);
  EXPECT_FALSE(problem) << describe(*problem);
  EXPECT_EQ(slave.mass_kg, 3.0);
  EXPECT_EQ(control.taps, 5);
}

TEST(Document, ALaterCheckFindsThePlaceOfItsParameter) {
  Result<Document> document = Document::parse("[slave]\nmass_kg = 1\nvelocity_filter.cutoff_Hz = 600\n", "test.toml");
  ASSERT_TRUE(document);
  const auto place_of = [&](const char* parameter) {
    return document->locate({.code = ErrorCode::inconsistent, .parameter = parameter, .message = "no", .place = {}})
        .place;
  };
  EXPECT_EQ(place_of("slave.velocity_filter.cutoff_Hz"), "test.toml:3:29");
  EXPECT_EQ(place_of("slave.stiffness_N_per_m"), "test.toml:1:2") << "the section that would hold it";
  EXPECT_EQ(place_of("control.force_gain"), "test.toml");
  EXPECT_EQ(place_of(""), "test.toml");
  EXPECT_EQ(document->locate({.code = {}, .parameter = "slave", .message = "", .place = "here"}).place, "here");

  EXPECT_FALSE(document->set("slave.velocity_filter.cutoff_Hz=700"));
  EXPECT_FALSE(document->set("control.taps=3"));
  EXPECT_EQ(place_of("slave.velocity_filter.cutoff_Hz"), "--set slave.velocity_filter.cutoff_Hz=700");
  EXPECT_EQ(place_of("control.force_gain"), "test.toml") << "an override of another key is not its place";
}

}  // namespace
}  // namespace tactus::configuration
