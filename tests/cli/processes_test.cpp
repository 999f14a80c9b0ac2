// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/processes.hpp>

#include <array>
#include <cstdlib>

#include <gtest/gtest.h>

namespace tactus::cli {
namespace {

/// A program without the component mpi.
class Processes : public ::testing::Test {
 protected:
  ~Processes() override { unsetenv("OMPI_COMM_WORLD_SIZE"); }
};

TEST_F(Processes, AProgramWithoutMpiRefusesToBeOneOfSeveralAndNamesTheComponent) {
  constexpr std::array map{"tactus", "stability", "map", "map.toml"};
  constexpr std::array contest{"tactus", "--plugin", "a.so", "run", "contest.toml"};
  constexpr std::array diagnose{"tactus", "diagnose", "recording.csv"};
  EXPECT_FALSE(refuse_processes(map.size(), map.data()));
  setenv("OMPI_COMM_WORLD_SIZE", "1", 1);
  EXPECT_FALSE(refuse_processes(map.size(), map.data()));
  setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
  const auto error = refuse_processes(map.size(), map.data());
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place, "mpirun");
  EXPECT_NE(error->message.find("component `mpi`"), std::string::npos);
  EXPECT_TRUE(refuse_processes(contest.size(), contest.data()));
  EXPECT_FALSE(refuse_processes(diagnose.size(), diagnose.data())) << "no work that several processes could share";
  EXPECT_TRUE(presents_results());
}

}  // namespace
}  // namespace tactus::cli
