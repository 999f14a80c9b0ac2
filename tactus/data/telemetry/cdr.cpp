// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/cdr.hpp>

#include <algorithm>

namespace tactus::telemetry {

Result<std::vector<double>> from_cdr(std::span<const unsigned char> message, const std::vector<Column>& columns) {
  const auto broken = [](std::string why) {
    return Error{.code = ErrorCode::syntax, .parameter = {}, .message = std::move(why), .place = {}};
  };
  if (message.size() < cdr_header.size() || !std::equal(cdr_header.begin(), cdr_header.end() - 2, message.begin())) {
    return broken("a message is not little-endian plain CDR");
  }
  const auto body = message.subspan(cdr_header.size());
  std::vector<double> values;
  values.reserve(columns.size());
  std::size_t offset = 0;
  for (const Column& column : columns) {
    const std::size_t size = column.type == SignalType::boolean ? 1 : 8;
    offset = aligned(offset, size);
    if (offset > body.size() || body.size() - offset < size) {
      return broken("a message ends before its member '" + column.name + "'");
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) bits |= std::uint64_t{body[offset + i]} << (8 * i);
    offset += size;
    switch (column.type) {
      case SignalType::float64:
        values.push_back(std::bit_cast<double>(bits));
        break;
      case SignalType::int64:
        values.push_back(static_cast<double>(std::bit_cast<std::int64_t>(bits)));
        break;
      case SignalType::boolean:
        values.push_back(bits == 0 ? 0.0 : 1.0);
        break;
    }
  }
  return values;
}

}  // namespace tactus::telemetry
