// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/c_api/tactus.h>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <exception>
#include <new>
#include <type_traits>
#include <utility>

namespace tactus::c_api {

/// Kinds of handles.
enum Kind : unsigned { error_kind = 1, cancellation_kind, outcome_kind, log_kind, teleoperator_kind };

tactus_status status_of(ErrorCode code);

/// Leaves the error as a handle in `*out`, if that is not null, and returns `status`. Where there is no memory for it,
/// the handle is 0.
tactus_status leave(const Error& error, tactus_status status, tactus_error* out) noexcept;
/// The same with the status of the error's code.
tactus_status leave(const Error& error, tactus_error* out) noexcept;
/// The same of a text alone, which needs no memory until then.
tactus_status leave_text(const char* what, tactus_status status, tactus_error* out) noexcept;
/// The same of an argument that is none: `what` states which, and what it must be.
inline tactus_status bad_argument(const char* what, tactus_error* out) noexcept {
  return leave_text(what, TACTUS_BAD_ARGUMENT, out);
}

/// Runs `body`, which returns a `tactus_status`; what it throws is an error of status `TACTUS_FAILED`.
template <class Body>
tactus_status guarded(tactus_error* out, const Body& body) noexcept {
  if (out != nullptr) *out = 0;
  try {
    return body();
  } catch (const std::bad_alloc&) {
    return leave_text("out of memory: free some, or ask for less at once", TACTUS_FAILED, out);
  } catch (const std::exception& thrown) {
    return leave_text(thrown.what(), TACTUS_FAILED, out);
  } catch (...) {
    return leave_text("an unknown failure: report it with what led to it", TACTUS_FAILED, out);
  }
}

/// Whether a view or options struct of the caller has the size that this library knows.
template <class View>
bool has_known_size(const View* view) noexcept {
  static_assert(std::is_standard_layout_v<View>);
  return view != nullptr && view->struct_size == sizeof(View);
}

/// Fills a view, its size kept.
template <class View>
tactus_status fill(View* view, View content) noexcept {
  content.struct_size = sizeof(View);
  *view = content;
  return TACTUS_OK;
}

}  // namespace tactus::c_api
