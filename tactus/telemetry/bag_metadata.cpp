#include <tactus/report/files.hpp>
#include <tactus/telemetry/log_writer.hpp>

namespace tactus::telemetry {

Check write_bag_metadata(const std::filesystem::path& log, const LogWriter& writer) {
  const std::string name = log.filename().string();
  const std::string messages = std::to_string(writer.acknowledged());
  const std::string start = std::to_string(writer.first_time_ns());
  const std::string duration = std::to_string(writer.last_time_ns() - writer.first_time_ns());
  std::string text =
      "rosbag2_bagfile_information:\n"
      "  version: 5\n"
      "  storage_identifier: mcap\n"
      "  duration:\n    nanoseconds: " +
      duration +
      "\n"
      "  starting_time:\n    nanoseconds_since_epoch: " +
      start +
      "\n"
      "  message_count: " +
      messages +
      "\n"
      "  topics_with_message_count:\n";
  for (const ChannelCount& channel : writer.counts()) {
    text += "    - topic_metadata:\n        name: " + channel.topic + "\n        type: " + channel.type_name +
            "\n        serialization_format: cdr\n        offered_qos_profiles: \"\"\n      message_count: " +
            std::to_string(channel.written) + "\n";
  }
  text +=
      "  compression_format: \"\"\n"
      "  compression_mode: \"\"\n"
      "  relative_file_paths:\n    - " +
      name +
      "\n"
      "  files:\n    - path: " +
      name +
      "\n"
      "      starting_time:\n        nanoseconds_since_epoch: " +
      start +
      "\n"
      "      duration:\n        nanoseconds: " +
      duration +
      "\n"
      "      message_count: " +
      messages + "\n";
  return report::write_file(log.parent_path() / "metadata.yaml", text);
}

}  // namespace tactus::telemetry
