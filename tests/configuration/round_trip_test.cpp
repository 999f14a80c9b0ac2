// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

using testing::Cancellation;
using testing::Experiment;

Experiment write_and_read(const Experiment& experiment) {
  const std::string text = to_toml(experiment);
  const Result<Document> document = Document::parse(text, "written.toml");
  if (!document) throw std::runtime_error(describe(document.error()) + "\n" + text);
  const Result<Experiment> read = document->read<Experiment>();
  if (!read) throw std::runtime_error(describe(read.error()) + "\n" + text);
  return *read;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

std::string utf8(const std::vector<char32_t>& characters) {
  std::string text;
  const auto tail = [&](char32_t c, unsigned shift) {
    text += static_cast<char>(0x80U | ((static_cast<std::uint32_t>(c) >> shift) & 0x3fU));
  };
  for (const char32_t c : characters) {
    if (c < 0x80) {
      text += static_cast<char>(c);
    } else if (c < 0x800) {
      text += static_cast<char>(0xc0U | (c >> 6U));
      tail(c, 0);
    } else if (c < 0x10000) {
      text += static_cast<char>(0xe0U | (c >> 12U));
      tail(c, 6);
      tail(c, 0);
    } else {
      text += static_cast<char>(0xf0U | (c >> 18U));
      tail(c, 12);
      tail(c, 6);
      tail(c, 0);
    }
  }
  return text;
}

/// Any finite bit pattern, subnormals and both zeros included, that the bounds admit.
rc::Gen<double> any_double(const Bounds& bounds) {
  return rc::gen::suchThat(rc::gen::map(rc::gen::resize(100, rc::gen::arbitrary<std::uint64_t>()),
                                        [](std::uint64_t pattern) { return std::bit_cast<double>(pattern); }),
                           [bounds](double value) { return bounds.contain(value); });
}

rc::Gen<std::string> any_text() {
  const auto scalar = rc::gen::suchThat(
      rc::gen::oneOf(rc::gen::inRange<std::uint32_t>(0, 0x80), rc::gen::inRange<std::uint32_t>(0x80, 0x110000)),
      [](std::uint32_t c) { return c < 0xd800 || c > 0xdfff; });
  return rc::gen::map(rc::gen::container<std::vector<char32_t>>(
                          rc::gen::map(scalar, [](std::uint32_t c) { return static_cast<char32_t>(c); })),
                      utf8);
}

TEST(RoundTrip, WhatIsWrittenReadsBackEqualBitForBit) {
  EXPECT_TRUE(rc::check([] {
    Experiment experiment;
    experiment.duration_s = *any_double(positive_up_to(3600));
    experiment.slave.mass_kg = *any_double(positive);
    experiment.slave.offset_m = *any_double(any_finite);
    experiment.slave.stiffness_N_per_m = *any_double(non_negative);
    experiment.slave.velocity_filter.enabled = *rc::gen::arbitrary<bool>();
    experiment.control.cancellation = *rc::gen::element(Cancellation::off, Cancellation::model, Cancellation::adaptive);
    experiment.control.taps = *rc::gen::inRange<std::int64_t>(1, 4097);
    experiment.control.seed = *rc::gen::resize(100, rc::gen::arbitrary<std::int64_t>());
    experiment.task.kind = *any_text();
    experiment.task.recording = *any_text();
    const Experiment read = write_and_read(experiment);
    RC_ASSERT(read == experiment);
    RC_ASSERT(bits(read.slave.offset_m) == bits(experiment.slave.offset_m));
  }));
}

TEST(RoundTrip, TheEdgesOfTheNumbersSurvive) {
  using Limits = std::numeric_limits<double>;
  for (const double value : {0.0,
                             -0.0,
                             1.0,
                             -1.0,
                             0.1,
                             1e15,
                             1e16,
                             1e17,
                             1e21,
                             1e22,
                             1e23,
                             123456789012345680.0,
                             Limits::min(),
                             -Limits::min(),
                             Limits::denorm_min(),
                             Limits::max(),
                             Limits::lowest(),
                             std::nextafter(1.0, 2.0),
                             5e-324,
                             2.2250738585072011e-308,
                             9007199254740993.0}) {
    Experiment experiment;
    experiment.slave.offset_m = value;
    EXPECT_EQ(bits(write_and_read(experiment).slave.offset_m), bits(value)) << value;
  }
  for (const std::int64_t value :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(), std::int64_t{0}}) {
    Experiment experiment;
    experiment.control.seed = value;
    EXPECT_EQ(write_and_read(experiment).control.seed, value);
  }
}

TEST(RoundTrip, StructsThatShareASectionAreWrittenUnderOneHeading) {
  testing::Filter filter{.cutoff_Hz = 33.0, .enabled = false};
  testing::Task task{.kind = "hold", .recording = ""};
  std::vector<Binding> bindings = bind(filter, "site");
  for (const Binding& binding : bind(task, "site")) bindings.push_back(binding);
  const std::string text = to_toml(bindings);
  EXPECT_EQ(text, "[site]\ncutoff_Hz = 33.0\nenabled = false\nkind = \"hold\"\nrecording = \"\"\n");

  const auto document = Document::parse(text, "written.toml");
  filter = {};
  task = {};
  ASSERT_FALSE(document->read(bindings));
  EXPECT_EQ(filter, (testing::Filter{.cutoff_Hz = 33.0, .enabled = false}));
  EXPECT_EQ(task, (testing::Task{.kind = "hold", .recording = ""}));
}

TEST(RoundTrip, TheTextIsPlainToml) {
  EXPECT_EQ(to_toml(Experiment{}), R"(duration_s = 2.0

[slave]
mass_kg = 0.5
offset_m = 0.0
stiffness_N_per_m = 3950.0

[slave.velocity_filter]
cutoff_Hz = 80.0
enabled = true

[control]
force_gain = 1.0
cancellation = "model"
taps = 32
seed = 1

[task]
kind = "tapping"
recording = ""
)");
}

}  // namespace
}  // namespace tactus::configuration
