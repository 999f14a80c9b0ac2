// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/cdr.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

/// The input is a definition, a zero, and a message of it: as many values as columns, or an error that says something.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto* end = std::find(data, data + size, std::uint8_t{0});
  const std::string definition(data, end);
  const auto columns = tactus::telemetry::columns_of(definition, {});
  if (!columns) {
    demand(!columns.error().message.empty());
    return 0;
  }
  const std::span<const unsigned char> message(end == data + size ? end : end + 1, data + size);
  const auto values = tactus::telemetry::from_cdr(message, *columns);
  demand(values ? values->size() == columns->size() : !values.error().message.empty());
  return 0;
}
