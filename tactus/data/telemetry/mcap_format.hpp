// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

/// What writer and reader of MCAP files share. The format: https://mcap.dev/spec (version 0), all numbers
/// little-endian.
namespace tactus::telemetry::mcap {

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};

enum class Opcode : unsigned char {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  data_end = 0x0f,
};

/// Opcode and length before the content of every record.
inline constexpr std::size_t record_head_bytes = 9;

using TextMap = std::map<std::string, std::string>;

/// CRC-32 of zlib, of `bytes` after bytes whose checksum is `before`.
std::uint32_t crc32_of(std::string_view bytes, std::uint32_t before = 0);

template <class Number>
void append(std::string& bytes, Number value) {
  static_assert(std::is_unsigned_v<Number>);
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    bytes += static_cast<char>(static_cast<unsigned char>(static_cast<std::uint64_t>(value) >> (8 * i)));
  }
}

inline void append_text(std::string& bytes, std::string_view text) {
  append(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

inline void append_map(std::string& bytes, const TextMap& map) {
  std::string content;
  for (const auto& [key, value] : map) {
    append_text(content, key);
    append_text(content, value);
  }
  append_text(bytes, content);
}

inline void append_record(std::string& bytes, Opcode opcode, std::string_view content) {
  bytes += static_cast<char>(opcode);
  append(bytes, static_cast<std::uint64_t>(content.size()));
  bytes += content;
}

/// Takes values off the front of bytes that may be anything. Once something does not fit, `ok` is false and every
/// further value is zero or empty.
class Cursor {
 public:
  explicit Cursor(std::string_view bytes) : rest_(bytes) {}

  template <class Number>
  Number take() {
    const std::string_view bytes = take_bytes(sizeof(Number));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    }
    return static_cast<Number>(value);
  }

  std::string_view take_bytes(std::uint64_t count) {
    if (count > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view bytes = rest_.substr(0, static_cast<std::size_t>(count));
    rest_.remove_prefix(bytes.size());
    return bytes;
  }

  std::string_view take_text() { return take_bytes(take<std::uint32_t>()); }

  TextMap take_map() {
    Cursor content(take_text());
    TextMap map;
    while (content.ok() && !content.rest().empty()) {
      const std::string_view key = content.take_text();
      const std::string_view value = content.take_text();
      if (content.ok()) map.emplace(key, value);
    }
    ok_ = ok_ && content.ok();
    return map;
  }

  [[nodiscard]] std::string_view rest() const { return rest_; }
  [[nodiscard]] bool ok() const { return ok_; }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace tactus::telemetry::mcap
