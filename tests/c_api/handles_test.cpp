// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/c_api/files.hpp"
#include <dlfcn.h>

namespace tactus::c_api {
namespace {

using CApiHandles = CApi;

tactus_cancellation make_one() {
  tactus_cancellation_options options = TACTUS_CANCELLATION_OPTIONS_INIT;
  options.sample_time_s = 1e-3;
  tactus_cancellation made = 0;
  EXPECT_EQ(tactus_cancellation_make(&options, &made, nullptr), TACTUS_OK);
  return made;
}

tactus_outcome make_outcome() {
  const Words words({"--version"});
  tactus_outcome outcome = 0;
  EXPECT_EQ(tactus_command(words.data(), words.size(), nullptr, &outcome, nullptr), TACTUS_OK);
  return outcome;
}

tactus_error make_error() {
  tactus_error error = 0;
  EXPECT_EQ(tactus_cancellation_copy(0, nullptr, &error), TACTUS_BAD_ARGUMENT);
  return error;
}

/// The status of every function that takes a handle.
std::vector<tactus_status> statuses_of_all(std::uint64_t handle) {
  double number = 0.0;
  tactus_cancellation copy = 0;
  tactus_error_view error = TACTUS_ERROR_VIEW_INIT;
  tactus_outcome_view outcome = TACTUS_OUTCOME_VIEW_INIT;
  tactus_log_view log = TACTUS_LOG_VIEW_INIT;
  tactus_table_view table = TACTUS_TABLE_VIEW_INIT;
  tactus_column_view column = TACTUS_COLUMN_VIEW_INIT;
  tactus_teleoperator_view pair = TACTUS_TELEOPERATOR_VIEW_INIT;
  tactus_teleoperator_report report = TACTUS_TELEOPERATOR_REPORT_INIT;
  tactus_joint_sample joint{};
  const char* name = nullptr;
  std::int32_t turns = 0;
  std::int64_t time_ns = 0;
  return {tactus_error_read(handle, &error),
          tactus_cancellation_step(handle, 0.0, 0.0, &number),
          tactus_cancellation_intended(handle, 0.0, &number),
          tactus_cancellation_advance(handle, 0.0),
          tactus_cancellation_step_array(handle, 1, &number, &number, &number),
          tactus_cancellation_induced(handle, &number),
          tactus_cancellation_reset(handle),
          tactus_cancellation_copy(handle, &copy, nullptr),
          tactus_outcome_read(handle, &outcome),
          tactus_log_read(handle, &log),
          tactus_log_table(handle, 0, &table),
          tactus_log_column(handle, 0, 0, &column),
          tactus_teleoperator_press(handle, "arm", nullptr),
          tactus_teleoperator_read(handle, &pair),
          tactus_teleoperator_joint(handle, 0, &name, &turns),
          tactus_teleoperator_newest(handle, 1, &joint, &joint, &time_ns),
          tactus_teleoperator_stop(handle, nullptr),
          tactus_teleoperator_report_read(handle, &report)};
}

std::vector<tactus_status> releases_of_all(std::uint64_t handle) {
  return {tactus_error_release(handle), tactus_cancellation_release(handle), tactus_outcome_release(handle),
          tactus_log_release(handle), tactus_teleoperator_release(handle)};
}

void expect_bad(const std::vector<tactus_status>& statuses) {
  for (std::size_t i = 0; i < statuses.size(); ++i) EXPECT_EQ(statuses[i], TACTUS_BAD_HANDLE) << "function " << i;
}

TEST_F(CApiHandles, AfterItsReleaseAHandleIsRefusedByEveryFunction) {
  const std::string table = write("table.csv", "time_s,force_N\n0,1\n0.001,2\n");
  tactus_log log = 0;
  ASSERT_EQ(tactus_log_open(table.c_str(), nullptr, &log, nullptr), TACTUS_OK);
  const tactus_cancellation cancellation = make_one();
  const tactus_outcome outcome = make_outcome();
  const tactus_error error = make_error();
  EXPECT_EQ(tactus_log_release(log), TACTUS_OK);
  EXPECT_EQ(tactus_cancellation_release(cancellation), TACTUS_OK);
  EXPECT_EQ(tactus_outcome_release(outcome), TACTUS_OK);
  EXPECT_EQ(tactus_error_release(error), TACTUS_OK);
  for (const std::uint64_t handle : {log, cancellation, outcome, error}) {
    expect_bad(statuses_of_all(handle));
    expect_bad(releases_of_all(handle));
  }
}

TEST_F(CApiHandles, AHandleOfAnotherKindAndANumberThatIsNoneAreRefused) {
  const tactus_cancellation cancellation = make_one();
  const tactus_error error = make_error();
  tactus_error_view view = TACTUS_ERROR_VIEW_INIT;
  EXPECT_EQ(tactus_error_read(cancellation, &view), TACTUS_BAD_HANDLE);
  EXPECT_EQ(tactus_error_release(cancellation), TACTUS_BAD_HANDLE);
  EXPECT_EQ(tactus_cancellation_reset(error), TACTUS_BAD_HANDLE);
  expect_bad(statuses_of_all(0));
  for (const tactus_status status : releases_of_all(0)) EXPECT_EQ(status, TACTUS_OK);
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    const std::uint64_t handle = random() >> (random() % 64);
    if (handle == cancellation || handle == error || handle == 0) continue;
    expect_bad(statuses_of_all(handle));
    expect_bad(releases_of_all(handle));
  }
  EXPECT_EQ(tactus_cancellation_reset(cancellation), TACTUS_OK) << "nothing of that released it";
  EXPECT_EQ(tactus_cancellation_release(cancellation), TACTUS_OK);
  EXPECT_EQ(tactus_error_release(error), TACTUS_OK);
}

/// A million calls on handles that live, that were released and that are none, checked against what is known to live.
TEST_F(CApiHandles, AMillionRandomCallsFindEachHandleAsItIs) {
  std::mt19937_64 random(11);
  std::vector<tactus_cancellation> live{make_one()}, gone{0};
  const auto any_of = [&random](const std::vector<tactus_cancellation>& all) { return all[random() % all.size()]; };
  std::set<tactus_cancellation> given(live.begin(), live.end());
  for (int call = 0; call < 1'000'000; ++call) {
    const bool lives = random() % 3 != 0;
    const tactus_cancellation handle = lives ? any_of(live) : any_of(gone);
    const tactus_status expected = lives ? TACTUS_OK : TACTUS_BAD_HANDLE;
    double number = 0.0;
    switch (random() % 8) {
      case 0: {
        tactus_cancellation copy = 0;
        const bool room = live.size() < 1000;
        if (!room) break;
        ASSERT_EQ(tactus_cancellation_copy(handle, &copy, nullptr), expected);
        ASSERT_EQ(copy != 0, lives);
        if (!lives) break;
        ASSERT_TRUE(given.size() > 100'000 || given.insert(copy).second) << "a handle was given out twice";
        live.push_back(copy);
        break;
      }
      case 1:
        if (lives && live.size() > 1) {
          ASSERT_EQ(tactus_cancellation_release(handle), TACTUS_OK);
          std::erase(live, handle);
          if (gone.size() < 1000) gone.push_back(handle);
        } else if (!lives && handle != 0) {
          ASSERT_EQ(tactus_cancellation_release(handle), TACTUS_BAD_HANDLE);
        }
        break;
      case 2:
        ASSERT_EQ(tactus_cancellation_reset(handle), expected);
        break;
      case 3:
        ASSERT_EQ(tactus_cancellation_advance(handle, -0.1), expected);
        break;
      case 4:
        ASSERT_EQ(tactus_cancellation_induced(handle, &number), expected);
        break;
      case 5: {
        tactus_outcome_view view = TACTUS_OUTCOME_VIEW_INIT;
        ASSERT_EQ(tactus_outcome_read(handle, &view), TACTUS_BAD_HANDLE);
        break;
      }
      default:
        ASSERT_EQ(tactus_cancellation_step(handle, 0.001, -0.1, &number), expected);
    }
  }
  for (const tactus_cancellation handle : live) ASSERT_EQ(tactus_cancellation_release(handle), TACTUS_OK);
}

TEST_F(CApiHandles, ThreadsWithHandlesOfTheirOwnDoNotDisturbOneAnother) {
  std::array<double, 4> left{};
  std::vector<std::thread> threads;
  for (double& sum : left) {
    threads.emplace_back([&sum] {
      for (int round = 0; round < 50; ++round) {
        const tactus_cancellation one = make_one();
        double intended_m = 0.0;
        for (int i = 0; i < 100; ++i) {
          EXPECT_EQ(tactus_cancellation_step(one, 0.001, -0.5, &intended_m), TACTUS_OK);
        }
        sum += intended_m;
        const tactus_error error = make_error();
        EXPECT_EQ(tactus_error_release(error), TACTUS_OK);
        EXPECT_EQ(tactus_cancellation_release(one), TACTUS_OK);
        if (round % 25 == 0) {
          EXPECT_EQ(tactus_outcome_release(make_outcome()), TACTUS_OK);
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const double sum : left) EXPECT_EQ(sum, left.front());
  EXPECT_NE(left.front(), 0.0);
}

TEST_F(CApiHandles, TheLibraryShowsItsOwnFunctionsAndNoOthers) {
  void* const library = dlopen(TACTUS_C_API_FILE, RTLD_NOW | RTLD_NOLOAD);
  ASSERT_NE(library, nullptr) << dlerror();
  EXPECT_NE(dlvsym(library, "tactus_cancellation_step", "TACTUS_0"), nullptr);
  EXPECT_EQ(dlsym(library, "_ZN6tactus7versionEv"), nullptr) << "a function of C++ shows";
  EXPECT_EQ(dlsym(library, "_ZN6tactus3cli11run_commandEiPPc"), nullptr);
  dlclose(library);
}

}  // namespace
}  // namespace tactus::c_api
