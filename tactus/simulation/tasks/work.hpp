// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/tasks/engine.hpp>
#include <tactus/simulation/tasks/store.hpp>
#include <tactus/simulation/tasks/task.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>

namespace tactus::tasks {

/// Whether a value was computed now or comes from the file of an earlier run.
enum class Origin { computed, stored };

/// A job on its engine, with its file of finished tasks: what `run` of a map, a contest or an ensemble uses.
///
///   auto work = Work::begin(place, job);
///   if (!work) return work.error();
///   if (!work->leads()) return ...;                 // this process has run tasks for another one, and has no results
///   if (auto error = work->run(list, take, progress)) return error;
class Work {
 public:
  using Take = std::function<Check(std::size_t task, std::string_view value, Origin origin)>;

  /// In the process that leads: opens the file of finished tasks. In any other process: runs tasks until the job ends.
  /// Errors: those of `TaskStore::open` and `Engine::serve`, and `unwritable` for the folder.
  static Result<Work> begin(const Place& place, Job job);
  Work(Work&& other) noexcept;
  Work& operator=(Work&&) = delete;
  /// Ends the job in all processes.
  ~Work();

  [[nodiscard]] bool leads() const { return engine_->leads(); }
  /// Hands the value of each task to `take`, one at a time: first those that the file has, then the others as they are
  /// computed and stored. May be called again with further tasks. Errors: of a task, of `take`, of the engine and of
  /// the file.
  Check run(const TaskList& list, const Take& take, const Progress& progress);

 private:
  Work(Engine& engine, Job job) : engine_(&engine), job_(std::move(job)) {}

  Engine* engine_;
  Job job_;
  std::optional<TaskStore> store_;
};

/// Removes the file of finished tasks from a folder: what a job does once its results are written.
void remove_finished_tasks(const std::filesystem::path& folder);

}  // namespace tactus::tasks
