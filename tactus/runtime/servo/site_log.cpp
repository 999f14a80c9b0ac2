// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/runtime/servo/site_log.hpp>

#include <numeric>
#include <utility>

namespace tactus::runtime {

SiteStreams SiteStreams::of_one(control::SiteRole role) {
  const LogStart start = LogStart::now();
  SiteStreams streams{.site = {},
                      .packets = std::make_shared<Packets>(),
                      .servo = std::make_shared<Servo>(),
                      .marks = std::make_shared<EpisodeMarks>(),
                      .requests = std::make_shared<Requests>(),
                      .origin_ns = start.monotonic_ns,
                      .start_unix_ns = start.unix_ns};
  streams.site[static_cast<std::size_t>(role)] = std::make_shared<Site>();
  return streams;
}

SiteStreams SiteStreams::of_both() {
  const LogStart start = LogStart::now();
  return {.site = {std::make_shared<Site>(), std::make_shared<Site>()},
          .packets = nullptr,
          .servo = std::make_shared<Servo>(),
          .marks = std::make_shared<EpisodeMarks>(),
          .requests = std::make_shared<Requests>(),
          .origin_ns = start.monotonic_ns,
          .start_unix_ns = start.unix_ns};
}

Result<SiteLog> SiteLog::open(const std::filesystem::path& folder, const LogMetadata& about, std::uint64_t most_bytes) {
  if (auto error = report::prepare_directory(folder)) return *std::move(error);
  std::filesystem::path file = folder / "log.mcap";
  auto recorder = telemetry::Recorder::create(file, most_bytes);
  if (!recorder) return recorder.error();
  for (const auto& [name, content] : about) recorder->add_metadata(name, content);
  return SiteLog(std::move(file), *std::move(recorder));
}

Check SiteLog::close() {
  if (auto error = recorder_.stop()) return error;
  return telemetry::write_bag_metadata(file_, recorder_.log());
}

std::uint64_t SiteLog::dropped() const {
  const auto counts = recorder_.dropped();
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

}  // namespace tactus::runtime
