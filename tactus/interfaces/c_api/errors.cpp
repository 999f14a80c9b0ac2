// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/c_api/internal/errors.hpp>
#include <tactus/interfaces/c_api/internal/handles.hpp>
#include <tactus/interfaces/cli/printable_output.hpp>
#include <tactus/kernel/core/version.hpp>

#include <string>
#include <utility>

namespace tactus::c_api {

namespace {

/// An error with the texts that a view points at.
struct LeftError {
  Error error;
  tactus_status status;
  std::string line;
  std::string remedy;
};

Handles<LeftError, error_kind>& errors() {
  static auto* const all = new Handles<LeftError, error_kind>;  // lasts to the end, whatever ends first
  return *all;
}

}  // namespace

tactus_status status_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::out_of_bounds:
      return TACTUS_OUT_OF_BOUNDS;
    case ErrorCode::wrong_type:
      return TACTUS_WRONG_TYPE;
    case ErrorCode::unknown_key:
      return TACTUS_UNKNOWN_KEY;
    case ErrorCode::missing:
      return TACTUS_MISSING;
    case ErrorCode::syntax:
      return TACTUS_SYNTAX;
    case ErrorCode::inconsistent:
      return TACTUS_INCONSISTENT;
    case ErrorCode::unwritable:
      return TACTUS_UNWRITABLE;
    case ErrorCode::failed:
      return TACTUS_FAILED;
  }
  return TACTUS_FAILED;
}

tactus_status leave(const Error& error, tactus_status status, tactus_error* out) noexcept {
  if (out == nullptr) return status;
  *out = 0;
  try {
    Error shown = error;  // as the command prints it: names of files stand in messages
    for (std::string* text : {&shown.parameter, &shown.message, &shown.place, &shown.value, &shown.bounds}) {
      *text = cli::printable_lines(*text);
    }
    std::string line = describe(shown), what_to_do(remedy(shown));
    *out = errors().add(
        {.error = std::move(shown), .status = status, .line = std::move(line), .remedy = std::move(what_to_do)});
  } catch (const std::exception&) {
    // The status says that there is an error; for more there is no memory.
  }
  return status;
}

tactus_status leave(const Error& error, tactus_error* out) noexcept { return leave(error, status_of(error.code), out); }

tactus_status leave_text(const char* what, tactus_status status, tactus_error* out) noexcept {
  if (out == nullptr) return status;
  *out = 0;
  try {
    const ErrorCode code = status == TACTUS_FAILED ? ErrorCode::failed : ErrorCode::inconsistent;
    return leave({.code = code, .parameter = {}, .message = what, .place = {}}, status, out);
  } catch (const std::exception&) {
    return status;
  }
}

}  // namespace tactus::c_api

using namespace tactus::c_api;

const char* tactus_version(void) {
  static const std::string text(tactus::version());
  return text.c_str();
}

tactus_status tactus_check_interface(int32_t major, int32_t minor, tactus_error* error) {
  return guarded(error, [&]() -> tactus_status {
    if (major == TACTUS_INTERFACE_MAJOR && minor <= TACTUS_INTERFACE_MINOR) return TACTUS_OK;
    const auto text = [](int32_t one, int32_t other) { return std::to_string(one) + "." + std::to_string(other); };
    return leave(
        {.code = tactus::ErrorCode::inconsistent,
         .parameter = {},
         .message = "the program was made for the interface " + text(major, minor) + ", and this library of tactus " +
                    std::string(tactus::version()) + " has " + text(TACTUS_INTERFACE_MAJOR, TACTUS_INTERFACE_MINOR) +
                    ": install header and library of one version",
         .place = {}},
        error);
  });
}

tactus_status tactus_error_read(tactus_error error, tactus_error_view* view) {
  if (!has_known_size(view)) return TACTUS_BAD_ARGUMENT;
  const LeftError* const left = errors().find(error);
  if (left == nullptr) return TACTUS_BAD_HANDLE;
  return fill(view, {.struct_size = 0,
                     .status = left->status,
                     .exit_status = tactus::exit_status(left->error),
                     .line = left->line.c_str(),
                     .place = left->error.place.c_str(),
                     .parameter = left->error.parameter.c_str(),
                     .message = left->error.message.c_str(),
                     .value = left->error.value.c_str(),
                     .bounds = left->error.bounds.c_str(),
                     .remedy = left->remedy.c_str()});
}

tactus_status tactus_error_release(tactus_error error) {
  return guarded(nullptr, [&]() -> tactus_status {
    return error == 0 || errors().release(error) ? TACTUS_OK : TACTUS_BAD_HANDLE;
  });
}
