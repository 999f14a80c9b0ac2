// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/episodes.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/log_start.hpp>
#include <tactus/runtime/servo/servo_record.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace tactus::runtime {

/// Where running sites leave every tick: a stream for each topic, for the log and all other observers. Null
/// streams take nothing.
struct SiteStreams {
  using Site = telemetry::RecordStream<SiteLogRecord>;
  using Packets = telemetry::RecordStream<PacketRecord>;
  using Servo = telemetry::RecordStream<ServoRecord>;
  using EpisodeMarks = telemetry::RecordStream<EpisodeMarkRecord>;
  using Requests = telemetry::RecordStream<SiteRequestRecord>;
  std::array<std::shared_ptr<Site>, 2> site;  ///< by role
  std::shared_ptr<Packets> packets;           ///< of a site that is alone: what came over the link
  std::shared_ptr<Servo> servo;
  std::shared_ptr<EpisodeMarks> marks;
  std::shared_ptr<Requests> requests;
  std::int64_t origin_ns = 0;      ///< of the times, on CLOCK_MONOTONIC
  std::int64_t start_unix_ns = 0;  ///< the same instant by the wall clock; 0: not stated

  /// Of one site; of both. Times count from now.
  static SiteStreams of_one(control::SiteRole role);
  static SiteStreams of_both();

  [[nodiscard]] Site* of(control::SiteRole role) const noexcept { return site[static_cast<std::size_t>(role)].get(); }
  /// A time of the servo's clock as the records carry it. Real-time safe.
  [[nodiscard]] std::uint64_t time_ns(std::int64_t monotonic_ns) const noexcept {
    return static_cast<std::uint64_t>(monotonic_ns - origin_ns);
  }
  [[nodiscard]] LogStart log_start() const noexcept { return {.monotonic_ns = origin_ns, .unix_ns = start_unix_ns}; }
  /// What was asked for at this tick, and which mark it is, if anything. Real-time safe.
  void push(const station::Tick& tick, std::optional<EpisodeMark> mark,
            const std::optional<SiteCommand>& asked) const noexcept {
    if (requests && asked) requests->push(time_ns(tick.deadline_ns), recorded(tick, *asked));
    if (marks && mark) {
      marks->push(time_ns(tick.deadline_ns), {.tick = tick.number, .mark = static_cast<std::int64_t>(*mark)});
    }
  }
  /// Calls `visit(topic, type_name, stream)` for each stream there is.
  template <class Visit>
  void for_each(const Visit& visit) const {
    const bool both = site[0] && site[1];
    for (const auto& [role, name] : enumerators(control::SiteRole{})) {
      if (of(role) == nullptr) continue;
      visit(both ? std::string("/").append(name).append("/site") : std::string("/site"), "tactus_msgs/msg/SiteRecord",
            *of(role));
    }
    if (packets) visit(std::string("/packets"), "tactus_msgs/msg/PacketRecord", *packets);
    if (servo) visit(std::string("/servo"), "tactus_msgs/msg/ServoRecord", *servo);
    if (marks) visit(std::string(telemetry::episodes_topic), "tactus_msgs/msg/EpisodeMarkRecord", *marks);
    if (requests) visit(std::string("/requests"), "tactus_msgs/msg/SiteRequestRecord", *requests);
  }
};

/// The metadata of a log: a name, and values by their keys.
using LogMetadata = std::map<std::string, std::map<std::string, std::string>>;

/// The log of running sites, written on a thread of its own: all that goes into `SiteStreams` or `JointStreams`.
class SiteLog {
 public:
  /// Opens `folder/log.mcap`, which takes all that goes into the streams from now on; the folder is made. `about`
  /// states what ran; the log also states when its times start, by the wall clock. `most_bytes` and errors as in
  /// `LogWriter::create`.
  template <class Streams>
  static Result<SiteLog> create(const std::filesystem::path& folder, const Streams& streams, const LogMetadata& about,
                                std::uint64_t most_bytes = 0) {
    auto log = open(folder, about, most_bytes);
    if (!log) return log.error();
    if (streams.log_start().unix_ns > 0) log->recorder_.start_at(streams.log_start().unix_ns);
    streams.for_each([&log](const std::string& topic, const char* type_name, const auto& stream) {
      log->recorder_.add(topic, type_name, stream);
    });
    log->recorder_.start();
    return log;
  }

  /// Writes what is waiting, ends the log and adds `metadata.yaml` for ROS 2 bag tools. After the last push. Errors:
  /// `unwritable` where anything was lost on the disk.
  Check close();
  /// Records that came faster than they were written, of all topics.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Records that went with the oldest parts of a log with a limit. After `close`.
  [[nodiscard]] std::uint64_t removed() const { return recorder_.log().removed(); }

 private:
  static Result<SiteLog> open(const std::filesystem::path& folder, const LogMetadata& about, std::uint64_t most_bytes);
  SiteLog(std::filesystem::path file, telemetry::Recorder recorder)
      : file_(std::move(file)), recorder_(std::move(recorder)) {}

  std::filesystem::path file_;
  telemetry::Recorder recorder_;
};

}  // namespace tactus::runtime
