// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>

namespace tactus::runtime {

/// The same log of sites, changed.
inline std::filesystem::path changed_log(const std::filesystem::path& folder,
                                         const std::function<void(telemetry::LogContent&)>& change) {
  auto content = telemetry::read_log(folder).value();
  change(content);
  const auto file = folder.parent_path() / "changed.mcap";
  auto writer = telemetry::LogWriter::create(file).value();
  for (const auto& [name, metadata] : content.summary.metadata) writer.add_metadata(name, metadata);
  const auto write = [&](const telemetry::LogTable& table, auto record) {
    using Record = decltype(record);
    const auto channel =
        writer.add_channel({.topic = table.topic, .type_name = table.type_name, .columns = table.columns});
    for (std::size_t k = 0; k < table.times_ns.size(); ++k) {
      std::size_t column = 0;
      for_each_signal<Record>([&](const auto& one) {
        auto& member = record.*one.member;
        member = static_cast<std::remove_reference_t<decltype(member)>>(table.values[column++][k]);
      });
      writer.write(channel, static_cast<std::uint32_t>(k), table.times_ns[k], telemetry::to_cdr(record));
    }
  };
  for (const telemetry::LogTable& table : content.tables) {
    const bool of_packets = table.topic.starts_with("/packets");
    if (table.topic.find("/joint_") != std::string::npos) {
      of_packets ? write(table, PacketJointRecord()) : write(table, JointLogRecord());
    } else if (of_packets) {
      table.type_name.ends_with("PacketRecord") ? write(table, PacketRecord()) : write(table, PacketHeadRecord());
    } else if (table.topic.ends_with("/site")) {
      table.type_name.ends_with("/SiteRecord") ? write(table, SiteLogRecord()) : write(table, SiteTickRecord());
    }
  }
  EXPECT_FALSE(writer.close());
  return file;
}

/// The same log with one number of a topic changed by its last digit, a whole one by 1.
inline std::filesystem::path tampered(const std::filesystem::path& folder, const std::string& topic,
                                      const std::string& signal, std::size_t row) {
  return changed_log(folder, [&](telemetry::LogContent& content) {
    for (telemetry::LogTable& table : content.tables) {
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        if (table.topic != topic || table.columns[i].name != signal) continue;
        double& value = table.values[i].at(row);
        const bool whole = table.columns[i].type == telemetry::SignalType::int64;
        value = whole ? value + 1.0 : std::nextafter(value, std::numeric_limits<double>::infinity());
      }
    }
  });
}

}  // namespace tactus::runtime
