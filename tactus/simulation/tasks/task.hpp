// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

/// Work as a list of independent tasks. A task has a key, which states what to run, and a value, which states what came
/// out; both are bytes. Equal keys give values with equal bits, whichever thread, process or machine runs them, and a
/// task that runs twice does no harm.
namespace tactus::tasks {

/// What all tasks of one job share.
struct Job {
  /// Everything besides the key on which a value depends: kind of job, configuration, precision. Equal in every process
  /// that takes part.
  std::string description;
  /// Runs one task: computes the value of a key. Called from several threads at once, and in any process.
  std::function<Result<std::string>(std::string_view key)> run;
};

/// Tasks of a job by their keys.
struct TaskList {
  std::size_t count = 0;
  /// The key of each task below `count`, which no other task of the list has. Called in one thread, perhaps repeatedly:
  /// a long list need not be in memory.
  std::function<std::string(std::size_t task)> key;
};

/// Receives the value of a task, one task at a time and each once, in any order. An error ends the job.
using Take = std::function<Check(std::size_t task, std::string_view value)>;

/// Receives the share of a list that is done, 0 to 1, now and then. May throw to end the job.
using Progress = std::function<void(double)>;

class Engine;

/// Where a job runs, and where its finished tasks are stored.
struct Place {
  Engine* engine = nullptr;      ///< null: a thread for each core of this machine
  std::filesystem::path folder;  ///< for the file of finished tasks, from which a killed job continues; empty: none
};

}  // namespace tactus::tasks
