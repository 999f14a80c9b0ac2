// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/tasks/task.hpp>

#include <cstddef>

namespace tactus::tasks {

/// What runs tasks: threads of this process, or several processes of which one hands the tasks out.
///
/// With several processes each of them makes the same `Job`. The one that leads calls `run` as often as it has lists of
/// tasks, then `finish`; all others call `serve`.
class Engine {
 public:
  Engine() = default;
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;
  virtual ~Engine() = default;

  /// Number of processes that take part.
  [[nodiscard]] virtual std::size_t processes() const { return 1; }
  /// Whether this process hands out the tasks and receives the values. Exactly one process leads.
  [[nodiscard]] virtual bool leads() const { return true; }
  /// Runs every task of the list and hands each value to `take`, in this thread or another one. Returns when all values
  /// are taken, or with the first error: of a task, of `take`, or of a process that does not respond.
  virtual Check run(const Job& job, const TaskList& list, const Take& take, const Progress& progress) = 0;
  /// In a process that does not lead: runs tasks of the job until the leading process ends it.
  virtual Check serve(const Job& /*job*/) { return {}; }
  /// In the process that leads: ends the job. The other processes return from `serve`.
  virtual void finish() {}
};

/// Threads of this process.
class Threads final : public Engine {
 public:
  /// 0: a thread for each core of this machine.
  explicit Threads(std::size_t threads = 0) : threads_(threads) {}
  Check run(const Job& job, const TaskList& list, const Take& take, const Progress& progress) override;

 private:
  std::size_t threads_;
};

}  // namespace tactus::tasks
