#pragma once

#include <tactus/control/supervision.hpp>
#include <tactus/experiments/experiment.hpp>
#include <tactus/runtime/servo_record.hpp>
#include <tactus/telemetry/recorder.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <tuple>

namespace tactus::cli {

/// One tick of a site: what supervision shows, what the link knows, and what the site read, heard and gave. Positions
/// and forces are positive toward the environment unless said otherwise.
struct SiteLogRecord : control::SiteRecord {
  std::int64_t tick = 0;
  std::int64_t missed = 0;
  double age_s = 0.0;
  double round_trip_s = 0.0;
  double link_silence_s = 0.0;
  double position_m = 0.0;
  double read_force_N = 0.0;
  double grip = 0.0;
  double motor_force_N = 0.0;
  double handle_force_N = 0.0;
  double induced_position_m = 0.0;
  double intended_position_m = 0.0;
  double heard_position_m = 0.0;
  double heard_velocity_m_per_s = 0.0;
  double heard_force_N = 0.0;
  double heard_wave = 0.0;
  double heard_energy_J = 0.0;
  std::int64_t told_sequence = 0;
  double told_position_m = 0.0;
  double told_velocity_m_per_s = 0.0;
  double told_force_N = 0.0;
  double told_wave = 0.0;
  double told_energy_J = 0.0;

  /// The other site's message that was applied last.
  void hear(const control::Message& message) noexcept;
  /// What was sent at this tick.
  void tell(const control::Packet& packet) noexcept;
  [[nodiscard]] control::Message told() const noexcept;

  static constexpr auto signals() {
    using R = SiteLogRecord;
    return std::tuple_cat(
        control::SiteRecord::signals(),
        std::tuple{
            observed("tick", &R::tick, units::none, "", "", "", "Number of the deadline, missed ones counted."),
            observed("missed", &R::missed, units::none, "", "", "", "Deadlines missed right before this one."),
            observed("age_s", &R::age_s, units::second, "", "", "", "Of the packet that was applied last, on arrival."),
            observed("round_trip_s", &R::round_trip_s, units::second, "", "", "", "Of the latest echo."),
            observed("link_silence_s", &R::link_silence_s, units::second, "", "", "",
                     "Since any packet of the other site arrived, applied or not; 0 before the first."),
            observed("position_m", &R::position_m, units::metre, "", "", "toward the environment",
                     "Read at the motor."),
            observed(
                "read_force_N", &R::read_force_N, units::newton, "", "", "",
                "Master: read on the handle, toward the environment. Slave: read at the tip, which is pushed back."),
            observed("grip", &R::grip, units::none, "master", "", "",
                     "Read: how firmly the person holds, over nominal."),
            observed("motor_force_N", &R::motor_force_N, units::newton, "", "", "toward the environment",
                     "Commanded to the motor."),
            observed("handle_force_N", &R::handle_force_N, units::newton, "master", "hand", "toward the environment",
                     "Commanded to the actuator on the handle."),
            observed("induced_position_m", &R::induced_position_m, units::metre, "master", "hand",
                     "toward the environment", "Estimated effect of the displayed force."),
            observed("intended_position_m", &R::intended_position_m, units::metre, "master", "hand",
                     "toward the environment", "Measured less induced."),
            observed("heard_position_m", &R::heard_position_m, units::metre, "", "slave", "",
                     "Of the message that was applied last."),
            observed("heard_velocity_m_per_s", &R::heard_velocity_m_per_s, units::metre_per_second, "", "slave", "",
                     "Of the message that was applied last."),
            observed("heard_force_N", &R::heard_force_N, units::newton, "", "slave", "",
                     "Of the message that was applied last."),
            observed("heard_wave", &R::heard_wave, units::none, "", "slave", "",
                     "Of the message that was applied last."),
            observed("heard_energy_J", &R::heard_energy_J, units::joule, "", "slave", "",
                     "Of the message that was applied last."),
            observed("told_sequence", &R::told_sequence, units::none, "", "", "", "Of the packet that was sent."),
            observed("told_position_m", &R::told_position_m, units::metre, "", "slave", "", "Told to the other site."),
            observed("told_velocity_m_per_s", &R::told_velocity_m_per_s, units::metre_per_second, "", "slave", "",
                     "Told to the other site."),
            observed("told_force_N", &R::told_force_N, units::newton, "", "slave", "", "Told to the other site."),
            observed("told_wave", &R::told_wave, units::none, "", "slave", "", "Told to the other site."),
            observed("told_energy_J", &R::told_energy_J, units::joule, "", "slave", "", "Told to the other site.")});
  }
};

/// Where a running site leaves every tick. Null streams take nothing.
struct SiteStreams {
  telemetry::RecordStream<SiteLogRecord>* site = nullptr;
  telemetry::RecordStream<runtime::ServoRecord>* servo = nullptr;
  std::int64_t origin_ns = 0;  ///< of the times in the log, on CLOCK_MONOTONIC
};

/// The log of one site: the topics `/site` and `/servo`, written beside the servo thread.
class SiteLog {
 public:
  /// Opens `folder/log.mcap`; the folder is made. The log says what ran: experiment, configuration with its seeds,
  /// version, machine and which site. `most_bytes` and errors as in `LogWriter::create`.
  static Result<SiteLog> create(const std::filesystem::path& folder, const experiments::Request& request,
                                std::string_view configuration, control::SiteRole role, std::uint64_t most_bytes = 0);

  [[nodiscard]] const SiteStreams& streams() const { return streams_; }
  /// Writes what is waiting, ends the log and adds `metadata.yaml` for ROS 2 bag tools. After the last push. Errors:
  /// `unwritable` where anything was lost on the disk.
  Check close();
  /// Records that found their ring full, of both topics.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Records that went with the oldest parts of a log with a limit. After `close`.
  [[nodiscard]] std::uint64_t removed() const { return recorder_.log().removed(); }

 private:
  SiteLog(std::filesystem::path file, telemetry::Recorder recorder)
      : file_(std::move(file)), recorder_(std::move(recorder)) {}

  std::filesystem::path file_;
  telemetry::Recorder recorder_;
  SiteStreams streams_;
};

}  // namespace tactus::cli
