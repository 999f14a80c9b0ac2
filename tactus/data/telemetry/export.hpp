// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <string>
#include <string_view>

namespace tactus::telemetry {

/// Columns of a log for other programs. Each function writes a temporary file next to the target and renames it, so a
/// reader sees all or nothing. After the run only. Errors: `unwritable`, `missing` for a log without messages.
///
/// A table whose record has no `time_s` gets one, from the times of its messages, and of a log that states its start
/// `wall_time_s`, the same in seconds of Unix time. Columns of codes (states, causes, faults) come with their words.
/// Names of topics, signals and keys are letters, digits and `_`, a letter first, at most 63 characters, each given
/// once: what a log of others has otherwise is changed, cut or numbered (`_2`), in the order of the log.

/// The first table as text: `name [unit]` heads, numbers that read back equal. What `recording::read` reads. Of a run
/// of several, lines that begin with `#` state before the heads which run it is: in words, then `key=value` for each
/// varied key; for a joint's topic also `joint=elbow`. The words of codes are columns at the end (`state_text`).
Check export_csv(const LogContent& content, const std::filesystem::path& file);

/// MATLAB file of version 5: a struct for each topic with a column vector for each signal, named with its unit, and a
/// struct `units` of texts; with codes a struct `codes` of texts (`0 configure, 1 align`); of a joint's topic a struct
/// `channel` with its name (`joint`); the metadata of the run as the struct `about`. The topic of a run of several has
/// a struct `condition`: `label` in words, and the value of each varied key (`control_force_gain`).
Check export_mat(const LogContent& content, const std::filesystem::path& file);

/// HDF5: a group for each topic with a data set for each signal, whose attributes are `unit`, `site`, `frame` and
/// `sign`, of codes also `codes`; the group of a joint's topic has an attribute `joint`; the metadata of the run as
/// texts in the group `about`. The group of a run of several has an attribute `condition` in words, and one for each
/// varied key (`control.force_gain`).
Check export_hdf5(const LogContent& content, const std::filesystem::path& file);

/// What a topic is called in a file whose names have no slash: `/run_1/teleoperator` is `run_1_teleoperator`.
std::string identifier_of(std::string_view topic);

}  // namespace tactus::telemetry
