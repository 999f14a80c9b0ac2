// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace tactus {

/// What kind of thing went wrong. The kind decides the exit status of the command line.
enum class ErrorCode {
  out_of_bounds,  ///< a value outside the bounds of its description, or not finite
  wrong_type,     ///< a value of another type than the description asks for
  unknown_key,    ///< a key that nothing reads
  missing,        ///< a key, file, variable or column that is needed and not there
  syntax,         ///< text that cannot be parsed
  inconsistent,   ///< values that are each fine but contradict one another
  unwritable,     ///< a place that results cannot be written to
  failed,         ///< the job itself went wrong
};

/// One failure, as a user needs it. Made off the servo path only: it owns strings.
struct Error {
  ErrorCode code = ErrorCode::failed;
  /// The parameter concerned as a dotted path (`slave.friction.force_N`), or empty.
  std::string parameter;
  /// One sentence: value, bounds, unit and remedy. It does not repeat the place.
  std::string message;
  /// Where the value was written (`tapping.toml:12:5`, `--set control.force_gain=-1`), or empty.
  std::string place;
  /// The value that was refused, with its unit, as in the message; empty where it is no single value.
  std::string value = {};
  /// What that value may be, as in the message (`must be at least 0 and at most 1000`), or empty.
  std::string bounds = {};
};

/// `place: parameter: message`, leaving out what is empty.
std::string describe(const Error& error);

/// The remedy: the part of the message after the first colon and blank, as every message is written; empty for a
/// message without that. Valid as long as `error`.
std::string_view remedy(const Error& error);

/// The same error, its parameter path put under `prefix` (`friction` under `slave` becomes `slave.friction`).
Error under(std::string_view prefix, Error error);
/// The other way round, where it is under `prefix`: `slave.friction` becomes `friction`. Else as it is.
Error out_of(std::string_view prefix, Error error);

/// 2 when the request was wrong, 1 when the job failed.
int exit_status(const Error& error);

/// Nothing when all is well. Shape of every check that yields no value.
using Check = std::optional<Error>;

/// A value, or the error that explains its absence.
///
/// A valid object is made by a function that returns a `Result`, so an invalid one cannot exist. Reading the value of
/// a failed result is a programming error and ends the program through `std::get`.
template <class T>
class [[nodiscard]] Result {
 public:
  // Implicit on purpose: `return value;` and `return error;` both read well in a `make` function.
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

  [[nodiscard]] bool ok() const noexcept { return content_.index() == 0; }
  explicit operator bool() const noexcept { return ok(); }

  [[nodiscard]] T& value() & { return std::get<0>(content_); }
  [[nodiscard]] const T& value() const& { return std::get<0>(content_); }
  [[nodiscard]] T&& value() && { return std::get<0>(std::move(content_)); }
  [[nodiscard]] const Error& error() const { return std::get<1>(content_); }

  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

 private:
  std::variant<T, Error> content_;
};

}  // namespace tactus
