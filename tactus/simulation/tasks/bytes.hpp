// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tactus::tasks {

template <class T>
concept Number = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Keys and values as bytes: numbers with all their bits, in the byte order of the machine.
class ByteWriter {
 public:
  template <Number T>
  ByteWriter& put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  template <Number T>
  ByteWriter& put(const std::optional<T>& value) {
    put(value.has_value());
    return put(value.value_or(T{}));
  }
  /// The length, then the text.
  ByteWriter& put(std::string_view text) {
    put(static_cast<std::uint64_t>(text.size()));
    bytes_ += text;
    return *this;
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads what `ByteWriter` wrote, in the same order. Beyond the end it reads zeros.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : bytes_(bytes) {}

  template <Number T>
  void get(T& value) {
    value = T{};
    if (bytes_.size() < sizeof value) {
      short_ = true;
      bytes_ = {};
      return;
    }
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
  }
  template <Number T>
  void get(std::optional<T>& value) {
    bool there = false;
    T content{};
    get(there);
    get(content);
    value = there ? std::optional(content) : std::nullopt;
  }
  void get(std::string& text) {
    std::uint64_t length = 0;
    get(length);
    if (bytes_.size() < length) {
      short_ = true;
      length = bytes_.size();
    }
    text = bytes_.substr(0, length);
    bytes_.remove_prefix(length);
  }
  template <Number T>
  [[nodiscard]] T get() {
    T value{};
    get(value);
    return value;
  }
  /// Whether exactly what there was has been read.
  [[nodiscard]] bool complete() const { return !short_ && bytes_.empty(); }
  /// What has not been read yet.
  [[nodiscard]] std::string_view rest() const { return bytes_; }

 private:
  std::string_view bytes_;
  bool short_ = false;
};

}  // namespace tactus::tasks
