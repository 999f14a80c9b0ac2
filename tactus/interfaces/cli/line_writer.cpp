// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/printable_output.hpp>
#include <tactus/interfaces/cli/quiet_thread.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string_view>
#include <utility>

#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

constexpr std::chrono::milliseconds timeout{200};
/// At once, so that it shows when somebody reads slowly.
constexpr std::size_t piece = 4096;

}  // namespace

struct LineWriter::State {
  explicit State(int to) : descriptor(to) {}

  const int descriptor;
  mutable std::mutex mutex;  // of all below; never held while something is written
  std::condition_variable changed;
  std::deque<std::string> waiting;
  std::uint64_t dropped = 0;
  std::uint64_t written = 0;  ///< pieces
  bool busy = false;          ///< with one that waits no more
  bool failed = false;
  bool closed = false;

  void write_all() {
    std::unique_lock lock(mutex);
    while (true) {
      changed.wait(lock, [this] { return closed || !waiting.empty(); });
      if (waiting.empty()) return;
      const std::string text = std::move(waiting.front());
      waiting.pop_front();
      if (failed) continue;
      busy = true;
      lock.unlock();
      const bool done = write(text);
      lock.lock();
      busy = false;
      failed = !done;
      changed.notify_all();
    }
  }

 private:
  bool write(std::string_view text) {
    while (!text.empty()) {
      const ssize_t size = ::write(descriptor, text.data(), std::min(text.size(), piece));
      if (size < 0 && errno == EAGAIN) {  // somebody who has it too does not want to wait
        pollfd room{.fd = descriptor, .events = POLLOUT, .revents = 0};
        (void)poll(&room, 1, -1);
      } else if (size < 0 && errno != EINTR) {
        return false;
      } else if (size > 0) {
        text.remove_prefix(static_cast<std::size_t>(size));
        const std::lock_guard lock(mutex);
        ++written;
        changed.notify_all();
      }
    }
    return true;
  }
};

LineWriter::LineWriter(int descriptor) : state_(std::make_shared<State>(descriptor)) {
  auto thread = start_quiet_thread([state = state_] { state->write_all(); });
  if (thread) {
    thread_ = *std::move(thread);
  } else {
    state_->failed = true;
  }
}

LineWriter::~LineWriter() {
  if (thread_.joinable()) (void)finish({});
}

void LineWriter::say(std::string_view line) {
  const std::lock_guard lock(state_->mutex);
  if (state_->failed || state_->waiting.size() >= most_waiting) {
    ++state_->dropped;
    return;
  }
  state_->waiting.push_back(printable_lines(line));
  state_->changed.notify_all();
}

std::uint64_t LineWriter::dropped() const {
  const std::lock_guard lock(state_->mutex);
  return state_->dropped;
}

Check LineWriter::finish(std::string_view last) {
  std::unique_lock lock(state_->mutex);
  State& state = *state_;
  state.waiting.push_back(printable_lines(last));
  state.closed = true;
  state.changed.notify_all();
  const auto all_done = [&state] { return state.failed || (state.waiting.empty() && !state.busy); };
  bool done = all_done();
  while (!done) {
    const auto moved = [&, seen = state.written] { return all_done() || state.written > seen; };
    if (!state.changed.wait_for(lock, timeout, moved)) break;
    done = all_done();
  }
  const bool failed = state.failed;
  lock.unlock();
  // One that waits for a reader who may never come is left to the end of the program.
  if (thread_.joinable()) done ? thread_.join() : thread_.detach();
  if (done && (!failed || reader_is_gone(state_->descriptor))) return std::nullopt;
  return Error{.code = ErrorCode::unwritable,
               .parameter = {},
               .message = done ? "the output could not be written: give it a place with room"
                               : "the output could not be written, for nobody reads it",
               .place = state_->descriptor == STDOUT_FILENO ? "standard output" : "standard error"};
}

}  // namespace tactus::cli
