// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <string>
#include <system_error>
#include <utility>
#include <vector>

namespace tactus::tasks {

namespace {

std::filesystem::path file_of_finished_tasks(const std::filesystem::path& folder) { return folder / "tasks.partial"; }

Engine& threads_of_this_machine() {
  static Threads threads;
  return threads;
}

}  // namespace

Result<Work> Work::begin(const Place& place, Job job) {
  Work work(place.engine != nullptr ? *place.engine : threads_of_this_machine(), std::move(job));
  if (!work.leads()) {
    if (auto error = work.engine_->serve(work.job_)) return *std::move(error);
    return work;
  }
  if (place.folder.empty()) return work;
  if (auto error = report::prepare_directory(place.folder)) return *std::move(error);
  auto store = TaskStore::open(file_of_finished_tasks(place.folder), work.job_.description);
  if (!store) return store.error();
  work.store_.emplace(*std::move(store));
  return work;
}

Work::Work(Work&& other) noexcept
    : engine_(std::exchange(other.engine_, nullptr)), job_(std::move(other.job_)), store_(std::move(other.store_)) {}

Work::~Work() {
  if (engine_ != nullptr && engine_->leads()) engine_->finish();
}

Check Work::run(const TaskList& list, const Take& take, const Progress& progress) {
  if (list.count == 0) return {};
  if (!store_) {
    return engine_->run(
        job_, list, [&](std::size_t task, std::string_view value) { return take(task, value, Origin::computed); },
        progress);
  }
  std::vector<std::size_t> left;
  for (std::size_t task = 0; task < list.count; ++task) {
    const auto value = store_->find(list.key(task));
    if (!value) return value.error();
    if (!*value) {
      left.push_back(task);
    } else if (auto error = take(task, **value, Origin::stored)) {
      return error;
    }
  }
  const double stored = static_cast<double>(list.count - left.size()), all = static_cast<double>(list.count);
  return engine_->run(
      job_, {.count = left.size(), .key = [&](std::size_t i) { return list.key(left[i]); }},
      [&](std::size_t i, std::string_view value) -> Check {
        if (auto error = store_->append(list.key(left[i]), value)) return error;
        return take(left[i], value, Origin::computed);
      },
      [&](double share) { progress((stored + share * (all - stored)) / all); });
}

void remove_finished_tasks(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::filesystem::remove(file_of_finished_tasks(folder), ignored);
}

}  // namespace tactus::tasks
