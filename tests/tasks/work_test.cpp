// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/tasks/work.hpp>

#include <atomic>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tests/scratch_path.hpp>

namespace tactus::tasks {
namespace {

Error failure(std::string message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
}

/// Squares numbers, and counts how often.
struct Squares {
  std::atomic<std::size_t> runs = 0;
  std::size_t refused = 1000;  ///< a number that cannot be squared

  Job job() {
    return {.description = "squares", .run = [this](std::string_view key) -> Result<std::string> {
              ++runs;
              const std::size_t number = std::stoul(std::string(key));
              if (number == refused) return failure("no square of " + std::string(key));
              return std::to_string(number * number);
            }};
  }
};

TaskList numbers(std::size_t count) {
  return {.count = count, .key = [](std::size_t i) { return std::to_string(i); }};
}

struct Taken {
  std::vector<std::string> values;
  std::size_t stored = 0;
  Work::Take take(std::size_t count) {
    values.assign(count, "");
    stored = 0;
    return [this](std::size_t task, std::string_view value, Origin origin) -> Check {
      EXPECT_EQ(values[task], "") << "each task is taken once";
      values[task] = value;
      stored += origin == Origin::stored ? 1U : 0U;
      return {};
    };
  }
};

const Progress silent = [](double) {};

TEST(Work, AnyNumberOfThreadsGivesEachValueToItsTask) {
  for (const std::size_t count : {0U, 1U, 2U, 7U, 100U}) {
    for (const std::size_t threads : {1U, 3U}) {
      Squares squares;
      Threads engine(threads);
      auto work = Work::begin({.engine = &engine, .folder = {}}, squares.job());
      Taken taken;
      EXPECT_FALSE(work->run(numbers(count), taken.take(count), silent));
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(taken.values[i], std::to_string(i * i));
      EXPECT_EQ(squares.runs, count);
    }
  }
}

TEST(Work, AJobThatFailedContinuesWithoutRunningAFinishedTaskAgain) {
  const auto folder = scratch_path();
  Squares squares;
  squares.refused = 6;
  Threads engine(1);
  const Place place{.engine = &engine, .folder = folder};
  Taken taken;
  {
    auto work = Work::begin(place, squares.job());
    ASSERT_TRUE(work) << describe(work.error());
    const auto error = work->run(numbers(10), taken.take(10), silent);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->message, "no square of 6");
  }
  EXPECT_EQ(squares.runs, 7U);
  squares.refused = 1000;
  {
    auto work = Work::begin(place, squares.job());
    ASSERT_TRUE(work) << describe(work.error());
    double last = 0.0;
    EXPECT_FALSE(work->run(numbers(10), taken.take(10), [&last](double done) {
      EXPECT_GE(done, 0.6);
      last = done;
    }));
    EXPECT_EQ(last, 1.0);
    EXPECT_EQ(taken.stored, 6U);
    for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(taken.values[i], std::to_string(i * i));
    EXPECT_EQ(squares.runs, 11U);
    // A further list of the same job has tasks of the first one.
    EXPECT_FALSE(work->run(numbers(12), taken.take(12), silent));
    EXPECT_EQ(taken.stored, 10U);
    EXPECT_EQ(squares.runs, 13U);
  }
  remove_finished_tasks(folder);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  std::filesystem::remove(folder);
}

TEST(Work, AnErrorOfTheReceiverEndsTheJob) {
  Squares squares;
  Threads engine(1);
  auto work = Work::begin({.engine = &engine, .folder = {}}, squares.job());
  const auto error = work->run(
      numbers(5),
      [](std::size_t task, std::string_view, Origin) -> Check {
        if (task == 2) return failure("no room");
        return {};
      },
      silent);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->message, "no room");
  EXPECT_EQ(squares.runs, 3U);
}

/// A process that does not lead.
class Helping final : public Engine {
 public:
  [[nodiscard]] bool leads() const override { return false; }
  Check run(const Job&, const TaskList&, const Take&, const Progress&) override { return failure("does not lead"); }
  Check serve(const Job& job) override {
    served = job.description;
    return {};
  }
  void finish() override { finished = true; }
  std::string served;
  bool finished = false;
};

TEST(Work, AProcessThatDoesNotLeadServesAndOpensNoFile) {
  const auto folder = scratch_path();
  Helping engine;
  Squares squares;
  {
    const auto work = Work::begin({.engine = &engine, .folder = folder}, squares.job());
    ASSERT_TRUE(work);
    EXPECT_FALSE(work->leads());
  }
  EXPECT_EQ(engine.served, "squares");
  EXPECT_FALSE(engine.finished);
  EXPECT_FALSE(std::filesystem::exists(folder));
}

}  // namespace
}  // namespace tactus::tasks
