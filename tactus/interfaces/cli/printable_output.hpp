// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/colour.hpp>

#include <mutex>
#include <optional>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace tactus::cli {

/// `text` as it is safe to show on a terminal: `report::printable`, but line feeds and tabs stay.
std::string printable_lines(std::string_view text);

/// While it lives, all that a stream is given reaches its place through `printable_lines`. Names from files, logs,
/// datagrams and arguments are in messages everywhere; here is the one place that all of them pass.
///
/// Whole lines are passed on at once, the rest when the stream is flushed. Any thread.
class PrintableOutput final : public std::streambuf {
 public:
  /// With a painter, what it makes of each line.
  explicit PrintableOutput(std::ostream& stream, std::optional<Painter> painter = {});
  ~PrintableOutput() override;
  PrintableOutput(const PrintableOutput&) = delete;
  PrintableOutput& operator=(const PrintableOutput&) = delete;

 protected:
  std::streamsize xsputn(const char* text, std::streamsize size) override;
  int_type overflow(int_type character) override;
  int sync() override;

 private:
  /// Passes on the first `size` bytes of what waits.
  bool pass_on(std::size_t size);
  bool take(std::string_view text);
  std::string painted(std::string_view lines);

  std::ostream& stream_;
  std::streambuf* target_;
  std::mutex mutex_;
  std::optional<Painter> painter_;
  std::string waiting_;
};

}  // namespace tactus::cli
