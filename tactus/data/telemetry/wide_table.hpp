// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/episodes.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tactus::telemetry {

/// A rig's log as one wide table for each episode: a row for each instant at equal steps, and a column for each signal
/// of each joint. What a data frame takes in one line.
///
/// Columns, in this order: `time_s` since the start of the episode; `wall_time_s`, Unix time, where the log states its
/// start; of the leader and then of the follower `SIDE.JOINT.position_rad`, `.velocity_rad_per_s`, `.torque_Nm` (as the
/// motor reports it), `.commanded_torque_Nm`, each of all joints in the order of the rig, and of a follower that
/// estimates or measures it `.external_torque_Nm` of the environment on the arm; of a
/// follower that receives positions `.commanded_position_rad`. A joint that slides has m, m/s and
/// `force_N`; positive is toward the joint's own positive direction. At the end `SIDE.state` and `SIDE.cause` in words.
/// A log of an earlier version does not state which joints turn: its columns have no units.
///
/// A value is that of its instant, on a straight line between those before and after it. What a motor reported counts
/// from when it measured it. Not real-time safe.
class WideLog {
 public:
  /// Reads the topics and signals that the tables need. Errors: those of `read_log`; `missing` for a log without sites.
  static Result<WideLog> read(const std::filesystem::path& file_or_folder);

  [[nodiscard]] const LogContent& content() const { return content_; }
  [[nodiscard]] const std::vector<Episode>& episodes() const { return episodes_; }
  /// Whether the log states which joints turn.
  [[nodiscard]] bool states_units() const { return states_units_; }
  /// Heads of the columns.
  [[nodiscard]] std::vector<std::string> heads() const;
  /// A column of numbers of an episode, at this rate in Hz; empty if no column has this head.
  [[nodiscard]] std::vector<double> column(const std::string& head, const Episode& episode, double rate_Hz) const;
  /// Rows of an episode at this rate, in Hz.
  [[nodiscard]] static std::size_t rows(const Episode& episode, double rate_Hz);
  /// One episode as CSV. Errors: `unwritable`; `out_of_bounds` for more than 2^24 rows.
  [[nodiscard]] Check export_csv(const Episode& episode, double rate_Hz, const std::filesystem::path& file) const;

 private:
  /// A column of numbers: `factor` times a signal of a topic.
  struct WideColumn {
    std::string head;
    std::size_t table, signal;
    double factor = 1.0;
    bool measured = false;  ///< at the time of its row less `position_age_s`
  };
  /// A column of codes in words.
  struct WordColumn {
    std::string head;
    std::size_t table, signal;
  };
  explicit WideLog(LogContent content) : content_(std::move(content)), episodes_(episodes_of(content_)) {}
  void add_side(const std::string& role, const std::string& side);
  [[nodiscard]] std::vector<double> values_of(const WideColumn& column, const Episode& episode,
                                              const std::vector<double>& at_s) const;

  LogContent content_;
  std::vector<Episode> episodes_;
  std::vector<WideColumn> columns_;
  std::vector<WordColumn> words_;
  bool states_units_ = true;
};

}  // namespace tactus::telemetry
