// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/result.hpp>

namespace tactus {

std::string describe(const Error& error) {
  std::string text;
  for (const std::string* part : {&error.place, &error.parameter}) {
    if (!part->empty()) text += *part + ": ";
  }
  return text + error.message;
}

std::string_view remedy(const Error& error) {
  const std::string_view message = error.message;
  const std::size_t colon = message.find(": ");
  return colon == std::string_view::npos ? std::string_view{} : message.substr(colon + 2);
}

Error under(std::string_view prefix, Error error) {
  error.parameter = error.parameter.empty() ? std::string(prefix) : std::string(prefix) + "." + error.parameter;
  return error;
}

Error out_of(std::string_view prefix, Error error) {
  const bool within = error.parameter.starts_with(prefix) && error.parameter.substr(prefix.size()).starts_with('.');
  if (within) error.parameter.erase(0, prefix.size() + 1);
  return error;
}

int exit_status(const Error& error) {
  return error.code == ErrorCode::failed || error.code == ErrorCode::unwritable ? 1 : 2;
}

}  // namespace tactus
