#include <tactus/simulation/parallel.hpp>

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace parallel_test {

TEST(ForEachInParallel, DoesEveryPieceOfWorkOnce) {
  for (const std::size_t count : {0U, 1U, 2U, 1000U}) {
    std::vector<int> calls(count, 0);
    for_each_in_parallel(
        count, [&](std::size_t i) { ++calls[i]; }, [](double) {});
    EXPECT_EQ(calls, std::vector<int>(count, 1));
  }
}

TEST(ForEachInParallel, ReportsProgressOnTheCallingThreadAndNoMoreThanTheWhole) {
  const auto caller = std::this_thread::get_id();
  double last = 0.0;
  for_each_in_parallel(
      200, [](std::size_t) {},
      [&](double done) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_GE(done, last);
        EXPECT_LE(done, 1.0);
        last = done;
      });
}

}  // namespace parallel_test
}  // namespace tactus::simulation
