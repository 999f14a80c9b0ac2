// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/in_process.hpp>
#include <tactus/interfaces/cli/internal/command_words.hpp>
#include <tactus/interfaces/cli/printable_output.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <exception>
#include <iostream>
#include <mutex>
#include <new>
#include <sstream>
#include <utility>

namespace tactus::cli {

namespace {

/// A command that runs in a program of somebody else.
struct RunInProcess {
  std::ostringstream results;
  std::ostringstream messages;
  const InProcessProgress* progress;
  std::optional<Error> error;
};

/// Thrown by `report_progress`, no `std::exception`, for only `run_in_process` is to catch it.
struct EndOfCommand {};

thread_local RunInProcess* run_of_this_thread = nullptr;

Error failure(std::string message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
}

/// Runs the words; in `outcome` is what they left, the streams apart.
void run_caught(RunInProcess& run, const std::vector<const char*>& argv, InProcessOutcome& outcome) {
  // The streams are flushed into their texts where these end.
  const PrintableOutput results(run.results), messages(run.messages);
  try {
    outcome.status = run_words("tactus", static_cast<int>(argv.size()), argv.data());
  } catch (const EndOfCommand&) {
    outcome.interrupted = true;
    outcome.status = report_error("tactus", failure("interrupted: run it again"));
  } catch (const std::bad_alloc&) {
    outcome.status = report_error(
        "tactus", failure("out of memory: free some, raise the limit (ulimit -v), or ask for less at once"));
  } catch (const std::exception& error) {
    outcome.status =
        report_error("tactus", failure(std::string("the system refused what the command needs: ") + error.what()));
  }
}

}  // namespace

std::ostream& result_stream() { return run_of_this_thread != nullptr ? run_of_this_thread->results : std::cout; }

std::ostream& message_stream() { return run_of_this_thread != nullptr ? run_of_this_thread->messages : std::cerr; }

int report_error(std::string_view name, const Error& error) {
  message_stream() << name << ": " << describe(error) << "\n";
  if (run_of_this_thread != nullptr) run_of_this_thread->error = error;
  return exit_status(error);
}

bool is_in_process() { return run_of_this_thread != nullptr; }

void report_progress(double done) {
  if (run_of_this_thread == nullptr || !*run_of_this_thread->progress) return;
  if (!(*run_of_this_thread->progress)(done)) throw EndOfCommand{};
}

std::mutex& one_command_at_a_time() {
  static std::mutex mutex;
  return mutex;
}

InProcessOutcome run_in_process(const std::vector<std::string>& words, const InProcessProgress& progress) {
  InProcessOutcome outcome;
  if (run_of_this_thread != nullptr) {
    outcome.error = failure("a command runs in this thread already: start another when it has ended");
    outcome.status = exit_status(*outcome.error);
    outcome.messages = "tactus: " + describe(*outcome.error) + "\n";
    return outcome;
  }
  std::vector<const char*> argv{"tactus"};
  for (const std::string& word : words) argv.push_back(word.c_str());
  const std::lock_guard lock(one_command_at_a_time());
  RunInProcess run{.results = {}, .messages = {}, .progress = &progress, .error = {}};
  run_of_this_thread = &run;
  run_caught(run, argv, outcome);
  run_of_this_thread = nullptr;
  outcome.results = outcome.interrupted ? std::string() : std::move(run.results).str();
  outcome.messages = std::move(run.messages).str();
  outcome.error = std::move(run.error);
  return outcome;
}

}  // namespace tactus::cli
