// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <atomic>
#include <new>
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

TEST(ForEachInParallel, PassesOnWhatAnyThreadThrowsAndBeginsNothingMore) {
  for (const std::size_t threads : {1U, 4U}) {
    std::atomic<int> begun = 0;
    const auto fail_at_ten = [&](std::size_t i) {
      ++begun;
      if (i == 10) throw std::bad_alloc();
    };
    EXPECT_THROW(for_each_in_parallel(
                     1'000'000, fail_at_ten, [](double) {}, threads),
                 std::bad_alloc);
    EXPECT_LT(begun, 1'000'000);
  }
}

}  // namespace parallel_test
}  // namespace tactus::simulation
