// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <array>
#include <cstring>
#include <regex>

#include "tests/telemetry/sample.hpp"
#include <gtest/gtest.h>

namespace tactus::telemetry {
namespace {

TEST(Description, ARecordIsPlainCdrWithEveryMemberAlignedToItsSize) {
  // Written by hand from OMG DDSI-RTPS 2.3 §10: 1.0 is 0x3ff0000000000000, -2.0 is 0xc000000000000000.
  const std::array<unsigned char, 36> expected{0x00, 0x01, 0x00, 0x00,                           //
                                               0,    0,    0,    0,    0,    0,    0xf0, 0x3f,   // time_s = 1
                                               1,    0,    0,    0,    0,    0,    0,    0,      // touched, padding
                                               0,    0,    0,    0,    0,    0,    0,    0xc0,   // force_N = -2
                                               0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};  // count = -2
  static_assert(cdr_size<Sample>() == 36);
  EXPECT_EQ(to_cdr(Sample{.time_s = 1.0, .touched = true, .force_N = -2.0, .count = -2}), expected);
}

TEST(Description, TheDefinitionIsWhatRos2Writes) {
  EXPECT_EQ(ros2msg(columns_of<Sample>()),
            "# When. Unit: s.\n"
            "float64 time_s\n"
            "# Whether the wall was met. Site: environment.\n"
            "bool touched\n"
            "# Shown force. Unit: N. Site: master. Frame: hand. Positive: pushes the hand back.\n"
            "float64 force_n\n"
            "# Counts down. Site: slave.\n"
            "int64 count\n");
}

TEST(Description, DefinitionAndMetadataTogetherGiveTheColumnsBack) {
  const auto columns = columns_of<Sample>();
  const auto back = columns_of(ros2msg(columns), column_metadata(columns));
  ASSERT_TRUE(back) << describe(back.error());
  EXPECT_EQ(*back, columns);
}

TEST(Description, AMessageCutAtAnyByteIsAnErrorAndAWholeOneGivesItsNumbers) {
  const auto bytes = to_cdr(sample(7));
  const auto columns = columns_of<Sample>();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(from_cdr(std::span(bytes).first(size), columns)) << size;
  }
  const auto values = from_cdr(bytes, columns);
  ASSERT_TRUE(values);
  EXPECT_EQ(*values, (std::vector<double>{0.007, 0.0, -96.5, -7.0}));
}

TEST(Description, ADefinitionThatIsNotPlainNumbersIsRefused) {
  for (const char* text : {"string name", "float64[3] x", "float64", "float64 x = 3", "geometry_msgs/Vector3 v"}) {
    EXPECT_FALSE(columns_of(text, {})) << text;
  }
  std::string many;
  for (int i = 0; i < 5000; ++i) many += "bool a\n";
  EXPECT_FALSE(columns_of(many, {}));
}

TEST(Description, EverySignalOfTheTeleoperatorEndsWithItsUnitAndHasANameThatRos2Takes) {
  using Record = simulation::Teleoperator::Record;
  const std::regex rule("[a-z](_?[a-z0-9])*");  // https://docs.ros.org: names of fields
  std::size_t bytes = 0;
  for (const Column& column : columns_of<Record>()) {
    EXPECT_EQ(unit_at_end_of(column.name).symbol, column.unit) << column.name;
    EXPECT_TRUE(std::regex_match(ros_name(column.name), rule)) << column.name;
    EXPECT_FALSE(column.doc.empty()) << column.name;
    bytes = aligned(bytes, column.type == SignalType::boolean ? alignof(bool) : alignof(double)) +
            (column.type == SignalType::boolean ? sizeof(bool) : sizeof(double));
  }
  // A member without a description would make the record larger than what is described.
  EXPECT_EQ(aligned(bytes, alignof(Record)), sizeof(Record));
}

}  // namespace
}  // namespace tactus::telemetry
