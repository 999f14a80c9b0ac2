// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <memory>
#include <string_view>
#include <thread>

namespace tactus::cli {

/// Lines on their way to a terminal, a pipe or a file. A thread of its own writes them and waits for whoever does not
/// read; those who print them never wait. They are shown as `printable_lines` states. At most `most_waiting` lines
/// wait; those that come then are dropped and counted.
class LineWriter {
 public:
  static constexpr std::size_t most_waiting = 256;

  explicit LineWriter(int descriptor);
  LineWriter(const LineWriter&) = delete;
  LineWriter& operator=(const LineWriter&) = delete;
  /// As `finish`, without a last text.
  ~LineWriter();

  /// Any thread.
  void say(std::string_view line);
  /// Lines that were dropped so far. Any thread.
  [[nodiscard]] std::uint64_t dropped() const;
  /// After all that waits a text of any length, and nothing more. Waits until all is written, or nothing more was for
  /// 0.2 s. Errors: `unwritable` where not all of it came through.
  Check finish(std::string_view last);

 private:
  struct State;
  std::shared_ptr<State> state_;  ///< the thread's too: where it must be left waiting, it stays
  std::thread thread_;
};

}  // namespace tactus::cli
