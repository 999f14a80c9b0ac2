// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/c_api/internal/errors.hpp>
#include <tactus/interfaces/c_api/internal/handles.hpp>
#include <tactus/interfaces/cli/in_process.hpp>

#include <string>
#include <utility>
#include <vector>

namespace tactus::c_api {

namespace {

Handles<cli::InProcessOutcome, outcome_kind>& outcomes() {
  static auto* const all = new Handles<cli::InProcessOutcome, outcome_kind>;
  return *all;
}

/// Why a command that ended with a status other than 0 left no results; nothing for one that reported no error, whose
/// results say what its status means.
Check error_of(const cli::InProcessOutcome& outcome) {
  if (outcome.status == 0 || !outcome.error) return std::nullopt;
  return outcome.error;
}

}  // namespace

}  // namespace tactus::c_api

using namespace tactus::c_api;

tactus_status tactus_command(const char* const* words, size_t count, const tactus_command_options* options,
                             tactus_outcome* outcome, tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (outcome == nullptr) return bad_argument("`outcome` is NULL: pass where the handle is to be left", error);
    *outcome = 0;
    if (options != nullptr && !has_known_size(options)) {
      return bad_argument("`options` is of another size: begin with TACTUS_COMMAND_OPTIONS_INIT", error);
    }
    std::vector<std::string> all;
    for (std::size_t i = 0; i < count; ++i) {
      if (words == nullptr || words[i] == nullptr) {
        return bad_argument("`words` has fewer texts than `count`: pass as many", error);
      }
      all.emplace_back(words[i]);
    }
    tactus::cli::InProcessProgress progress;
    if (options != nullptr && options->progress != nullptr) {
      progress = [options](double done) { return options->progress(done, options->user) == 0; };
    }
    tactus::cli::InProcessOutcome done = tactus::cli::run_in_process(all, progress);
    if (const auto failure = error_of(done)) {
      return done.interrupted ? leave(*failure, TACTUS_INTERRUPTED, error) : leave(*failure, error);
    }
    *outcome = outcomes().add(std::move(done));
    if (*outcome != 0) return TACTUS_OK;
    return leave({.code = tactus::ErrorCode::failed,
                  .parameter = {},
                  .message = "there are 65536 outcomes already: release those that are not used any more",
                  .place = {}},
                 error);
  });
}

tactus_status tactus_outcome_read(tactus_outcome outcome, tactus_outcome_view* view) {
  if (!has_known_size(view)) return TACTUS_BAD_ARGUMENT;
  const auto* const found = outcomes().find(outcome);
  if (found == nullptr) return TACTUS_BAD_HANDLE;
  return fill(view, {.struct_size = 0,
                     .exit_status = found->status,
                     .results = found->results.c_str(),
                     .results_size = found->results.size(),
                     .messages = found->messages.c_str(),
                     .messages_size = found->messages.size()});
}

tactus_status tactus_outcome_release(tactus_outcome outcome) {
  return guarded(nullptr, [&]() -> tactus_status {
    return outcome == 0 || outcomes().release(outcome) ? TACTUS_OK : TACTUS_BAD_HANDLE;
  });
}
