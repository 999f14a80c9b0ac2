// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/interfaces/cli/run_log.hpp>
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>

#include <sys/utsname.h>

namespace tactus::cli {

namespace {

/// A sweep may have many thousands of runs; a log of all would be larger than anyone wants.
constexpr std::size_t most_runs = 64;

std::string name_of_run(std::size_t i) { return "run_" + std::to_string(i + 1); }

}  // namespace

std::map<std::string, std::string> log_origin() {
  utsname system{};
  const std::string machine =
      uname(&system) == 0 ? std::string(system.sysname) + " " + system.release + " " + system.machine : "unknown";
  return {{"version", std::string(version())}, {"machine", machine}};
}

Check write_run_log(const std::filesystem::path& folder, const experiments::Request& request,
                    const experiments::Outcome& outcome, std::uint64_t most_bytes) {
  using Record = simulation::Teleoperator::Record;
  if (auto error = report::prepare_directory(folder)) return error;
  const std::filesystem::path file = folder / "log.mcap";
  auto log = telemetry::LogWriter::create(file, most_bytes);
  if (!log) return log.error();

  auto about = log_origin();
  about["experiment"] = request.name;
  about["configuration"] = outcome.configuration;
  log->add_metadata("tactus", about);
  const std::size_t runs = outcome.traces.size();
  const std::size_t logged = std::min(runs, most_runs);
  const bool several = runs > 1;
  const auto place_of = [&](std::size_t one) { return several ? one * (runs - 1) / (logged - 1) : 0; };
  std::map<std::string, std::string> labels;
  for (std::size_t one = 0; one < logged; ++one) {
    const experiments::Settings& settings = outcome.traces[place_of(one)].settings;
    if (settings.empty()) continue;
    const std::string name = name_of_run(place_of(one));
    log->add_metadata(name, {settings.begin(), settings.end()});
    labels[name] = experiments::settings_caption(settings);
  }
  if (!labels.empty()) log->add_metadata(telemetry::run_labels, labels);
  for (std::size_t one = 0; one < logged; ++one) {
    const experiments::Trace& trace = outcome.traces[place_of(one)];
    const std::string name = name_of_run(place_of(one));
    const auto channel = log->add_channel({.topic = several ? "/" + name + "/teleoperator" : "/teleoperator",
                                           .type_name = "tactus_msgs/msg/TeleoperatorRecord",
                                           .columns = telemetry::columns_of<Record>()});
    std::uint32_t sequence = 0;
    for (const Record& record : trace.records) {
      const auto time_ns = static_cast<std::uint64_t>(std::llround(1e9 * record.time_s));
      log->write(channel, sequence++, time_ns, telemetry::to_cdr(record));
    }
  }
  if (auto error = log->close()) return error;
  return telemetry::write_bag_metadata(file, *log);
}

}  // namespace tactus::cli
