// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <csignal>

#include <sys/resource.h>

namespace tactus {

/// While it lives, no file of this process grows beyond so many bytes: a write tears as it does on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ok_ = getrlimit(RLIMIT_FSIZE, &before_) == 0;
    rlimit small = before_;
    small.rlim_cur = bytes;
    ok_ = ok_ && setrlimit(RLIMIT_FSIZE, &small) == 0;
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

  [[nodiscard]] bool ok() const { return ok_; }

 private:
  void (*handler_)(int);
  rlimit before_{};
  bool ok_ = false;
};

}  // namespace tactus
