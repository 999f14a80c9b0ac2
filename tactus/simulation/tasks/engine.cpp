// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/tasks/engine.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <atomic>
#include <mutex>
#include <string>
#include <utility>

namespace tactus::tasks {

Check Threads::run(const Job& job, const TaskList& list, const Take& take, const Progress& progress) {
  std::mutex guard;
  Check failure;
  std::atomic<bool> failed = false;
  const auto fail = [&](Error error) {
    if (!failed.exchange(true)) failure = std::move(error);
  };
  simulation::for_each_in_parallel(
      list.count,
      [&](std::size_t task) {
        if (failed) return;
        const std::string key = [&] {
          const std::lock_guard lock(guard);
          return list.key(task);
        }();
        const auto value = job.run(key);
        const std::lock_guard lock(guard);
        if (!value) {
          fail(value.error());
        } else if (auto error = take(task, *value)) {
          fail(*std::move(error));
        }
      },
      progress, threads_);
  return failure;
}

}  // namespace tactus::tasks
