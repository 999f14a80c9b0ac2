// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/tasks/task.hpp>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace tactus::ranks {

/// A thread that runs tasks of one job, in the order in which they are added.
class ComputingThread {
 public:
  struct Done {
    std::uint64_t task;
    Result<std::string> value;
    double took_s;
  };

  explicit ComputingThread(const tasks::Job& job);
  ComputingThread(const ComputingThread&) = delete;
  ComputingThread& operator=(const ComputingThread&) = delete;
  /// Drops the tasks that have not started, and waits for the one that has.
  ~ComputingThread();

  void add(std::uint64_t task, std::string key);
  /// The tasks that are done since the last call; waits so long for the first one.
  std::vector<Done> done(std::chrono::milliseconds wait);

 private:
  void work();

  const tasks::Job& job_;
  std::mutex mutex_;
  std::condition_variable added_, finished_;
  struct Task {
    std::uint64_t number;
    std::string key;
  };
  std::deque<Task> waiting_;
  std::vector<Done> done_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace tactus::ranks
