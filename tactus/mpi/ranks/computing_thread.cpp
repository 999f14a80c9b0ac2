// SPDX-License-Identifier: Apache-2.0
#include <tactus/mpi/ranks/internal/computing_thread.hpp>

#include <exception>
#include <new>
#include <utility>

namespace tactus::ranks {

namespace {

Error thrown(std::string message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
}

/// The value of a key. What a task throws, as for a lack of memory, ends the job as an error.
Result<std::string> value_of(const tasks::Job& job, const std::string& key) {
  try {
    return job.run(key);
  } catch (const std::bad_alloc&) {
    return thrown("out of memory: start fewer ranks on a machine, or ask for less at once");
  } catch (const std::exception& error) {
    return thrown(std::string("the system refused what a task needs: ") + error.what());
  }
}

}  // namespace

ComputingThread::ComputingThread(const tasks::Job& job) : job_(job), thread_([this] { work(); }) {}

ComputingThread::~ComputingThread() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  added_.notify_one();
  thread_.join();
}

void ComputingThread::add(std::uint64_t task, std::string key) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back({task, std::move(key)});
  }
  added_.notify_one();
}

std::vector<ComputingThread::Done> ComputingThread::done(std::chrono::milliseconds wait) {
  std::unique_lock lock(mutex_);
  finished_.wait_for(lock, wait, [this] { return !done_.empty(); });
  return std::exchange(done_, {});
}

void ComputingThread::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    added_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (stop_) return;
    const Task task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    const auto start = std::chrono::steady_clock::now();
    auto value = value_of(job_, task.key);
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    lock.lock();
    done_.push_back({task.number, std::move(value), took_s});
    finished_.notify_one();
  }
}

}  // namespace tactus::ranks
