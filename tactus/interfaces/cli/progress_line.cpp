// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <cmath>
#include <cstdio>

#include <unistd.h>

namespace tactus::cli {

namespace {
constexpr const char* erase_line = "\r\033[K";
}

ProgressLine::ProgressLine(std::string_view title)
    : title_(report::printable(title)), shown_(!is_in_process() && isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() {
  if (shown_) std::fputs(erase_line, stderr);
}

void ProgressLine::update(double done) {
  const auto now = Clock::now();
  if (now < next_) return;
  if (is_in_process()) {
    next_ = now + std::chrono::milliseconds(20);
    report_progress(done);
    return;
  }
  if (!shown_) return;
  next_ = now + std::chrono::milliseconds(200);
  const double elapsed_s = std::chrono::duration<double>(now - start_).count();
  const double left_s = done > 0.0 ? elapsed_s * (1.0 - done) / done : 0.0;
  std::fprintf(stderr, "%s%s  %3.0f %%  %.0f s left", erase_line, title_.c_str(), 100.0 * done, std::ceil(left_s));
  std::fflush(stderr);
}

}  // namespace tactus::cli
