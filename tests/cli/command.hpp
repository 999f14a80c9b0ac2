// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::cli {

/// Where the standard output of a command goes.
enum class StandardOutput {
  kept,         ///< into `Outcome::out`
  full,         ///< to a disk without room
  closed,       ///< nowhere, as after `>&-`
  reader_gone,  ///< into a pipe whose other end is closed
};

/// What a command left behind.
struct Outcome {
  int status = -1;  ///< exit status; 128 and the signal's number for one that a signal ended, as in a shell
  std::string out;
  std::string err;
};

/// A folder of its own for each test, in which the real `tactus` is run.
class Command : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  /// Runs `tactus` with these arguments in the folder and waits for it.
  [[nodiscard]] Outcome tactus(const std::vector<std::string>& arguments,
                               StandardOutput output = StandardOutput::kept) const;

  /// Writes a file into the folder and returns its name.
  std::string write(std::string_view name, std::string_view content) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  void make_folder(const std::filesystem::path& name) const;
  [[nodiscard]] std::string content(const std::filesystem::path& name) const;
  /// Everything in the folder, paths relative to it, sorted.
  [[nodiscard]] std::vector<std::string> files() const;

  /// An experiment that takes a few milliseconds, written as `quick.toml`.
  std::string quick_experiment() const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path streams_;  ///< what the command printed, out of the way of `files`
};

}  // namespace tactus::cli
