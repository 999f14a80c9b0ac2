// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/columns.hpp>

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace columns_test {

TEST(Columns, AVelocityIsFoundByNameAndUnitAndNotWhereSeveralAreAlike) {
  const auto column = [](const std::string& name, const std::string& unit) {
    return recording::Entry{.name = name, .unit = unit, .kind = "column", .rows = 10, .columns = 1, .readable = true};
  };
  const std::vector<recording::Entry> entries{column("leader_velocity", "rad/s"), column("leader_position", "rad"),
                                              column("Slave speed", ""), column("slave speed command", "")};
  EXPECT_EQ(find_velocity(Role::master_position, entries), "leader_velocity");
  EXPECT_EQ(find_velocity(Role::slave_position, entries), "Slave speed");
  EXPECT_EQ(find_velocity(Role::master_position, {column("master_vel", "deg/s")}), "") << "not in that unit";
  EXPECT_EQ(find_velocity(Role::master_position, {column("master_vel", "m/s"), column("master_vel_2", "m/s")}), "");
}

}  // namespace columns_test
}  // namespace tactus::diagnosis
