// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/column.hpp>
#include <tactus/data/recording/times.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// Measured signals from files, for playing them to a simulated hand and for identification.
namespace tactus::recording {

/// Where a signal is in a file.
///
/// The ending of the file's name determines the format: `.csv`, `.tsv` or `.txt` for a table, `.mat` for a MATLAB file.
///
/// A table is UTF-8 text, its fields separated by commas, semicolons, tabs or blanks (found from header and first
/// sample) and quoted where needed. Numbers have a decimal point in any locale, or throughout a decimal comma where
/// commas do not separate. The first line that is neither empty nor begins with `#` or `%` is the header: a name and a
/// unit for each column, as `force [N]`, `force (Newton)` or `force_N` (`split_unit` has the rules). Where that line
/// holds numbers, the last comment before it with as many words is the header. Every line after it is a sample.
///
/// A MATLAB file is of version 5 (what `save` writes with `-v7` or `-v6`), compressed or not. The signal is a real,
/// full vector or matrix of numbers of any class. Signals are its columns; its rows where there are ten times as many
/// columns as rows, and at most 64 rows.
struct Source {
  std::filesystem::path file = {};

  /// Table: the column as its header names it, with or without the unit (`force`, `force_N`, `force [N]`). MATLAB file:
  /// a dotted path with 1-based indices of struct arrays (`scope.signals(2).values`); a 1 x 1 struct needs no index,
  /// and a unit at the end of a name may be left out (`log.force` for `log.force_N`).
  std::string variable = {};

  /// MATLAB file: 1-based column of the variable, or its row where its signals are rows. A row vector counts as one
  /// column. Table: 1, for the name is enough.
  std::int64_t column = 1;

  /// The time of each sample, named like `variable` (its first column). In a table in the unit of its header (s, ms, us
  /// or ns), as ISO 8601 dates and times, or as two columns of seconds and parts of them (`sec,nanosec`). Without a
  /// unit and in a MATLAB file: seconds, but times since 1970 in s, ms, us or ns, which are distinguished by their
  /// size. Empty: the column `time`, `t`, `timestamp` or the like, or such a pair, or the variable `time` that is
  /// nearest (for `scope.signals(2).values`: `scope.signals(2).time`, `scope.time`, `time`) and has as many samples,
  /// `time_s` where there is no `time`; no time if both are missing.
  std::string time = {};

  /// The unit of the times (s, ms, us or ns) instead of what the file states of it; empty: as the file states.
  std::string time_unit = {};

  /// What the sample time is known to be, in seconds, greater than 0. Where the file has times too, they must agree
  /// with it within one part in a thousand.
  std::optional<double> sample_time_s = {};
};

/// A uniformly sampled signal of at least two finite samples.
struct Signal {
  std::vector<double> values = {};
  /// As in the file, without unit; for a matrix of a MATLAB file with the column (`scope.signals(2).values(:,2)`).
  std::string name = {};
  /// As in the header (`N`, `N/m`); empty where the file states none, as in every MATLAB file.
  std::string unit = {};
  /// Time between samples in seconds; none where neither the source nor the file states it.
  std::optional<double> sample_time_s = {};
  /// Where the times of the file jitter by more than a tenth of a step without a lost sample, the values are
  /// interpolated to equal steps, and this is the rms distance of the times from equal steps in seconds.
  std::optional<double> jitter_s = {};
  /// Whether the file or the source states the unit of the times.
  bool time_unit_stated = false;
};

/// What jitter of the times means for a signal, in a sentence; empty without jitter.
std::string jitter_note(std::optional<double> jitter_s, double sample_time_s);

/// Reads one signal.
///
/// Errors: the file is missing, of unknown format, damaged or empty; there is no such variable (the message lists what
/// there is and the nearest name); the variable is not a vector or matrix of real numbers; the column is out of range;
/// a value is not a finite number; there are fewer than two samples; the times are not strictly increasing, a sample is
/// lost or doubled (or the times leave a uniform grid by more than 0.45 of a step), or they contradict the stated
/// sample time. Parameters in errors are the members of `Source`; a place in a table is `file:line:column`.
///
/// Not real-time safe. Independent calls may run in several threads.
Result<Signal> read(const Source& source);

/// Reads the columns of several choices, those of each choice in a list of their own, without looking for times.
///
/// A choice is one or more of these, with commas between them: in a table the name of a column, its number from 1 where
/// no column is called so, or a range as `2:7` or `q1:q6`, both ends included; in a MATLAB file a variable, of which
/// all columns are meant, `NAME:2` or `NAME:2:7`. Unlike for `read`, a table may lack a header; then blanks may be
/// between its numbers, and columns have their numbers for names.
///
/// Errors: as for `read`, without those of times. A sample that is not finite is refused with its place. Not real-time
/// safe.
Result<std::vector<std::vector<Column>>> read_columns(const std::filesystem::path& file,
                                                      std::span<const std::string> choices);

/// Reads the times that `Source::time` and `Source::time_unit` name, as `Source` states. Errors: as for `read`, without
/// those of steps. Not real-time safe.
Result<Times> read_times(const std::filesystem::path& file, const std::string& choice, std::string_view unit = {});

/// One variable or column of a file.
struct Entry {
  std::string name = {};  ///< the value for `Source::variable`
  std::string unit = {};  ///< as in the header, or empty
  std::string kind =
      {};  ///< `column` in a table; in a MATLAB file the class, as `double`, `complex single`, `char`, `cell`
  std::int64_t rows = 0;
  std::int64_t columns = 0;
  bool readable = false;  ///< a full matrix of real numbers with two samples or more, which `read` takes
};

/// What a file contains, structs unfolded, in the order of the file. Errors as for `read`. Not real-time safe.
Result<std::vector<Entry>> contents(const std::filesystem::path& file);

}  // namespace tactus::recording
