// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/wire_end.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

namespace tactus::wire::testing {

using Bytes = std::vector<std::uint8_t>;

/// Says packets at given times, writes down what it hears and when, and can answer each piece with a packet.
class ScriptedEnd : public WireEnd {
 public:
  struct Heard {
    std::int64_t at_ns;
    Bytes bytes;
    bool operator==(const Heard&) const = default;
  };

  std::deque<std::pair<std::int64_t, Bytes>> script;
  Bytes answer;                      ///< said to each piece that is heard; none where empty
  std::int64_t answer_after_ns = 0;  ///< later than the piece
  std::vector<Heard> heard;

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    heard.push_back({now_ns, Bytes(bytes.begin(), bytes.end())});
    if (!answer.empty()) script.emplace_back(now_ns + answer_after_ns, answer);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    if (script.empty() || script.front().first > now_ns) return {};
    saying_ = script.front().second;
    script.pop_front();
    return saying_;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override {
    return script.empty() ? never_ns : script.front().first;
  }
  [[nodiscard]] Bytes all_heard() const {
    Bytes all;
    for (const Heard& piece : heard) all.insert(all.end(), piece.bytes.begin(), piece.bytes.end());
    return all;
  }

 private:
  Bytes saying_;
};

}  // namespace tactus::wire::testing
