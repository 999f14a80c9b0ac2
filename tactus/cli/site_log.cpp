#include <tactus/cli/run_log.hpp>
#include <tactus/cli/site_log.hpp>
#include <tactus/report/files.hpp>

#include <numeric>
#include <utility>

namespace tactus::cli {

void SiteLogRecord::hear(const control::Message& message) noexcept {
  heard_position_m = message.position_m;
  heard_velocity_m_per_s = message.velocity_m_per_s;
  heard_force_N = message.force_N;
  heard_wave = message.wave;
  heard_energy_J = message.energy_J;
}

void SiteLogRecord::tell(const control::Packet& packet) noexcept {
  told_sequence = packet.sequence;
  told_position_m = packet.message.position_m;
  told_velocity_m_per_s = packet.message.velocity_m_per_s;
  told_force_N = packet.message.force_N;
  told_wave = packet.message.wave;
  told_energy_J = packet.message.energy_J;
}

control::Message SiteLogRecord::told() const noexcept {
  return {.position_m = told_position_m,
          .velocity_m_per_s = told_velocity_m_per_s,
          .force_N = told_force_N,
          .wave = told_wave,
          .energy_J = told_energy_J};
}

Result<SiteLog> SiteLog::create(const std::filesystem::path& folder, const experiments::Request& request,
                                std::string_view configuration, control::SiteRole role, std::uint64_t most_bytes) {
  if (auto error = report::prepare_directory(folder)) return *std::move(error);
  std::filesystem::path file = folder / "log.mcap";
  auto recorder = telemetry::Recorder::create(file, most_bytes);
  if (!recorder) return recorder.error();
  auto about = log_origin();
  about["experiment"] = request.name;
  about["configuration"] = configuration;
  about["clock"] = "real";
  about["site"] = name_of(role);
  recorder->add_metadata("tactus", about);
  SiteLog log(std::move(file), *std::move(recorder));
  log.streams_ = {.site = &log.recorder_.add<SiteLogRecord>("/site", "tactus_msgs/msg/SiteRecord"),
                  .servo = &log.recorder_.add<runtime::ServoRecord>("/servo", "tactus_msgs/msg/ServoRecord"),
                  .origin_ns = runtime::monotonic_ns()};
  log.recorder_.start();
  return log;
}

Check SiteLog::close() {
  if (auto error = recorder_.stop()) return error;
  return telemetry::write_bag_metadata(file_, recorder_.log());
}

std::uint64_t SiteLog::dropped() const {
  const auto counts = recorder_.dropped();
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

}  // namespace tactus::cli
