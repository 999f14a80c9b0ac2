// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/telemetry/log_writer.hpp>

#include <algorithm>
#include <numeric>

namespace tactus::telemetry {

namespace {

std::uint64_t messages_of(const LogPartSummary& part) {
  return std::accumulate(part.messages.begin(), part.messages.end(), std::uint64_t{0});
}

/// When it began, how long it was and how many messages it has, each line after `indent`.
std::string extent(const std::string& indent, const LogPartSummary& part) {
  return indent + "starting_time:\n" + indent + "  nanoseconds_since_epoch: " + std::to_string(part.first_time_ns) +
         "\n" + indent + "duration:\n" + indent +
         "  nanoseconds: " + std::to_string(part.last_time_ns - part.first_time_ns) + "\n" + indent +
         "message_count: " + std::to_string(messages_of(part)) + "\n";
}

/// All parts as one.
LogPartSummary sum(const std::vector<LogPartSummary>& parts, std::size_t channels) {
  LogPartSummary all{.file = {}, .messages = std::vector<std::uint64_t>(channels)};
  bool any = false;
  for (const LogPartSummary& part : parts) {
    for (std::size_t i = 0; i < part.messages.size(); ++i) all.messages[i] += part.messages[i];
    if (messages_of(part) == 0) continue;
    all.first_time_ns = any ? std::min(all.first_time_ns, part.first_time_ns) : part.first_time_ns;
    all.last_time_ns = std::max(all.last_time_ns, part.last_time_ns);
    any = true;
  }
  return all;
}

}  // namespace

Check write_bag_metadata(const std::filesystem::path& log, const LogWriter& writer) {
  const std::vector<LogPartSummary> parts = writer.parts();
  const LogPartSummary all = sum(parts, writer.counts().size());
  std::string text =
      "rosbag2_bagfile_information:\n"
      "  version: 5\n"
      "  storage_identifier: mcap\n"
      "  duration:\n    nanoseconds: " +
      std::to_string(all.last_time_ns - all.first_time_ns) +
      "\n"
      "  starting_time:\n    nanoseconds_since_epoch: " +
      std::to_string(all.first_time_ns) +
      "\n"
      "  message_count: " +
      std::to_string(messages_of(all)) +
      "\n"
      "  topics_with_message_count:\n";
  for (std::size_t i = 0; i < writer.counts().size(); ++i) {
    const ChannelCount& channel = writer.counts()[i];
    text += "    - topic_metadata:\n        name: " + channel.topic + "\n        type: " + channel.type_name +
            "\n        serialization_format: cdr\n        offered_qos_profiles: \"\"\n      message_count: " +
            std::to_string(all.messages[i]) + "\n";
  }
  text +=
      "  compression_format: \"\"\n"
      "  compression_mode: \"\"\n"
      "  relative_file_paths:\n";
  for (const LogPartSummary& part : parts) text += "    - " + part.file.filename().string() + "\n";
  text += "  files:\n";
  for (const LogPartSummary& part : parts) {
    text += "    - path: " + part.file.filename().string() + "\n" + extent("      ", part);
  }
  return report::write_file(log.parent_path() / "metadata.yaml", text);
}

}  // namespace tactus::telemetry
