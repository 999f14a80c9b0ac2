// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tactus.h>
#include <unistd.h>

namespace tactus::c_api {

/// A folder of its own for each test.
class CApi : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              ("tactus-c-api-" + std::to_string(getpid()) + "-" + std::string(test->name()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = folder_ / name;
    std::ofstream(file) << content;
    return file.string();
  }
  /// An experiment that takes a few milliseconds.
  [[nodiscard]] std::string quick_experiment() const {
    return write("quick.toml",
                 "[task]\nkind = \"tapping\"\nsupervised = false\ntaps = 1\nobservation_s = 0.15\n"
                 "\n[control]\nforce_gain = 2.0\n");
  }
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// What an error holds; it is released.
struct ErrorTexts {
  tactus_status status = TACTUS_OK;
  int exit_status = 0;
  std::string line, place, parameter, message, value, bounds, remedy;
};

inline ErrorTexts take(tactus_error error) {
  tactus_error_view view = TACTUS_ERROR_VIEW_INIT;
  EXPECT_EQ(tactus_error_read(error, &view), TACTUS_OK);
  ErrorTexts texts{.status = view.status,
                   .exit_status = view.exit_status,
                   .line = view.line,
                   .place = view.place,
                   .parameter = view.parameter,
                   .message = view.message,
                   .value = view.value,
                   .bounds = view.bounds,
                   .remedy = view.remedy};
  EXPECT_EQ(tactus_error_release(error), TACTUS_OK);
  return texts;
}

/// A command's words as C has them.
class Words {
 public:
  explicit Words(std::vector<std::string> words) : words_(std::move(words)) {
    for (const std::string& word : words_) pointers_.push_back(word.c_str());
  }
  [[nodiscard]] const char* const* data() const { return pointers_.data(); }
  [[nodiscard]] std::size_t size() const { return pointers_.size(); }

 private:
  std::vector<std::string> words_;
  std::vector<const char*> pointers_;
};

}  // namespace tactus::c_api
