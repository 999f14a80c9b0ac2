// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace tactus::cli {

/// One line on standard error that shows how far a long job is and how long it will still take. Shows nothing if
/// standard error is not a terminal. The destructor removes the line.
class ProgressLine {
 public:
  explicit ProgressLine(std::string_view title);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// `done` is the share of the work, from 0 to 1. Cheap to call often: the line changes five times a second at most.
  /// In a program that runs commands itself it is reported to that program, which may end the command here
  /// (`report_progress`).
  void update(double done);

 private:
  using Clock = std::chrono::steady_clock;

  std::string title_;
  bool shown_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point next_ = start_;
};

}  // namespace tactus::cli
