// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/mcap_format.hpp>

#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::telemetry {

/// Bytes in CDR, little-endian, written after the OMG's rules and not by the library.
class CdrBytes {
 public:
  template <class Unsigned>
  CdrBytes& add(Unsigned value) {
    while (bytes_.size() % sizeof(Unsigned) != 0) bytes_ += '\0';
    mcap::append(bytes_, value);
    return *this;
  }
  CdrBytes& add_text(std::string_view text) {
    add(static_cast<std::uint32_t>(text.size() + 1));
    bytes_ += text;
    bytes_ += '\0';
    return *this;
  }
  CdrBytes& add_double(double value) { return add(std::bit_cast<std::uint64_t>(value)); }
  CdrBytes& add_doubles(const std::vector<double>& values) {
    add(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) add_double(value);
    return *this;
  }
  CdrBytes& add_header(std::int64_t time_ns) {
    add(static_cast<std::uint32_t>(time_ns / 1'000'000'000)).add(static_cast<std::uint32_t>(time_ns % 1'000'000'000));
    return add_text("base");
  }
  [[nodiscard]] std::string message() const { return std::string("\0\1\0\0", 4) + bytes_; }

 private:
  std::string bytes_;
};

inline std::string joint_state(std::int64_t time_ns, const std::vector<std::string>& names,
                               const std::vector<double>& position, const std::vector<double>& velocity,
                               const std::vector<double>& effort) {
  CdrBytes bytes;
  bytes.add_header(time_ns).add(static_cast<std::uint32_t>(names.size()));
  for (const std::string& name : names) bytes.add_text(name);
  return bytes.add_doubles(position).add_doubles(velocity).add_doubles(effort).message();
}

/// Force x, y, z and torque x, y, z.
inline std::string wrench_stamped(std::int64_t time_ns, const std::vector<double>& six) {
  CdrBytes bytes;
  bytes.add_header(time_ns);
  for (const double value : six) bytes.add_double(value);
  return bytes.message();
}

/// A ROS 2 bag in MCAP without chunks.
class SmallBag {
 public:
  SmallBag() {
    std::string header;
    mcap::append_text(header, "ros2");
    mcap::append_text(header, "test");
    mcap::append_record(bytes_, mcap::Opcode::header, header);
  }
  std::uint16_t add_topic(std::string_view topic, std::string_view type) {
    ++topics_;
    std::string schema;
    mcap::append(schema, topics_);
    mcap::append_text(schema, type);
    mcap::append_text(schema, "ros2msg");
    mcap::append_text(schema, "std_msgs/Header header\n");
    mcap::append_record(bytes_, mcap::Opcode::schema, schema);
    std::string channel;
    mcap::append(channel, topics_);
    mcap::append(channel, topics_);
    mcap::append_text(channel, topic);
    mcap::append_text(channel, "cdr");
    mcap::append_map(channel, {});
    mcap::append_record(bytes_, mcap::Opcode::channel, channel);
    return topics_;
  }
  void write(std::uint16_t topic, std::int64_t received_ns, std::string_view cdr) {
    std::string message;
    mcap::append(message, topic);
    mcap::append(message, std::uint32_t{0});
    mcap::append(message, static_cast<std::uint64_t>(received_ns));
    mcap::append(message, static_cast<std::uint64_t>(received_ns));
    message += cdr;
    mcap::append_record(bytes_, mcap::Opcode::message, message);
  }
  [[nodiscard]] std::string whole() const {
    std::string all = std::string(mcap::magic) + bytes_;
    mcap::append_record(all, mcap::Opcode::data_end, std::string(4, '\0'));
    mcap::append_record(all, mcap::Opcode::footer, std::string(20, '\0'));
    return all + std::string(mcap::magic);
  }

 private:
  std::string bytes_;
  std::uint16_t topics_ = 0;
};

}  // namespace tactus::telemetry
