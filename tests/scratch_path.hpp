// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace tactus {

/// A place in the temporary folder that belongs to the running test of this process alone, so that two test runs at
/// once do not disturb each other.
inline std::filesystem::path scratch_path() {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  std::string name = "tactus_";
  name.append(test->test_suite_name()).append("_").append(test->name()).append("_").append(std::to_string(getpid()));
  std::replace(name.begin(), name.end(), '/', '_');  // of a parametrised test
  return std::filesystem::temp_directory_path() / name;
}

}  // namespace tactus
