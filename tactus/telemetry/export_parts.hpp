#pragma once

#include <tactus/core/result.hpp>
#include <tactus/telemetry/log_reader.hpp>

#include <filesystem>
#include <map>
#include <string>

namespace tactus::telemetry {

/// The table with a column `time_s`.
LogTable with_time(LogTable table);

/// What the log says about the run that it comes from; empty where it says nothing.
std::map<std::string, std::string> about(const LogSummary& summary);

/// The error for a log that has nothing to export.
Check refuse_empty(const LogContent& content, const std::filesystem::path& file);

}  // namespace tactus::telemetry
