#include <tactus/runtime/internal/replay_rows.hpp>
#include <tactus/runtime/site_parts.hpp>
#include <tactus/runtime/site_record.hpp>
#include <tactus/station/local_teleoperator.hpp>
#include <tactus/station/step.hpp>

#include <array>
#include <utility>
#include <variant>

namespace tactus::runtime {

namespace {

using control::SiteRole;
using telemetry::LogContent;
using telemetry::LogTable;

station::DeviceLimits limits_of(const LogContent& content, SiteRole role) {
  const auto found = content.summary.metadata.find(std::string("device_of_") + name_of(role));
  return found == content.summary.metadata.end() ? station::DeviceLimits{} : limits_in(found->second);
}

station::DeviceReading reading_of(const SiteLogRecord& record, SiteRole role) {
  return {.position_m = record.position_m,
          .force_N = record.read_force_N,
          .grip = role == SiteRole::master ? record.grip : 1.0};
}

Error tick_is_missing(const LogTable& table, std::int64_t tick) {
  return refuse_replay(ErrorCode::inconsistent,
                       "topic " + table.topic + ": tick " + std::to_string(tick) + " is missing");
}

/// The packets of a log, tick by tick. A site that never heard the other has no topic of them.
class RecordedPackets {
 public:
  explicit RecordedPackets(const LogTable* table) : table_(table) {}

  /// False where the log has not so many at this tick.
  bool go_to(std::int64_t tick, std::int64_t arrivals) {
    begin_ = end_;
    end_ += static_cast<std::size_t>(arrivals);
    const std::size_t rows = table_ == nullptr ? 0 : table_->times_ns.size();
    if (end_ > rows) return false;
    for (std::size_t row = begin_; row < end_; ++row) {
      if (row_of<PacketRecord>(*table_, row).tick != tick) return false;
    }
    return true;
  }
  // The way of the site.
  template <class Take>
  void receive(const station::Tick&, Take&& take) const {
    for (std::size_t row = begin_; row < end_; ++row) take(row_of<PacketRecord>(*table_, row).packet());
  }
  void send(const control::Packet&, const station::Tick&) const noexcept {}

 private:
  const LogTable* table_;
  std::size_t begin_ = 0, end_ = 0;
};

Check replay_one(const LogContent& content, const LogTable& table, const experiments::TappingParams& params,
                 SiteRole role, Replay& replay) {
  if (auto error = check_table<SiteLogRecord>(table)) return error;
  const LogTable* const packets = find_table(content, "/packets");
  if (packets != nullptr) {
    if (auto error = check_table<PacketRecord>(*packets)) return error;
  }
  RecordedDevice device(limits_of(content, role));
  // Its number is told to the other site only.
  auto site = make_supervised_site(params, role, device.limits(), 1);
  if (!site) return site.error();
  RecordedPackets way(packets);
  std::int64_t next = 0;
  for (std::size_t row = 0; row < table.times_ns.size(); ++row) {
    const auto logged = row_of<SiteLogRecord>(table, row);
    if (logged.tick != next + logged.missed) return tick_is_missing(table, next);
    next = logged.tick + 1;
    if (!way.go_to(logged.tick, logged.arrivals)) {
      return refuse_replay(ErrorCode::inconsistent, "topic /packets lacks what came at tick " +
                                                        std::to_string(logged.tick) +
                                                        ": there is nothing to replay it from");
    }
    device.reading = reading_of(logged, role);
    device.state = static_cast<station::DeviceHealth>(logged.health);
    const station::Tick tick{.number = logged.tick, .missed = logged.missed};
    const control::SiteRequests pressed = requests_of(logged.pressed);
    SiteLogRecord replayed = std::visit(
        [&](auto& each) { return recorded(tick, pressed, each, station::step(each, device, way, tick, pressed)); },
        *site);
    // What only the link knows.
    replayed.arrivals = logged.arrivals;
    replayed.round_trip_s = logged.round_trip_s;
    replayed.link_silence_s = logged.link_silence_s;
    ++replay.ticks;
    replay.difference = compare(table, 0, logged, replayed);
    if (replay.difference) return std::nullopt;
  }
  return std::nullopt;
}

Check replay_both(const LogContent& content, const std::array<const LogTable*, 2>& tables,
                  const experiments::TappingParams& params, Replay& replay) {
  for (const LogTable* table : tables) {
    if (auto error = check_table<SiteLogRecord>(*table)) return error;
  }
  RecordedDevice master(limits_of(content, SiteRole::master)), slave(limits_of(content, SiteRole::slave));
  auto pair = station::LocalTeleoperator::make(control_of(params), params.channel, Seconds{1.0 / params.servo.rate_Hz},
                                               0.0, master, slave);
  if (!pair) return pair.error();
  std::int64_t next = 0;
  for (std::size_t row = 0; row < tables[0]->times_ns.size(); ++row) {
    const auto at_master = row_of<SiteLogRecord>(*tables[0], row);
    if (at_master.tick != next + at_master.missed) return tick_is_missing(*tables[0], next);
    if (row >= tables[1]->times_ns.size()) return tick_is_missing(*tables[1], at_master.tick);
    const auto at_slave = row_of<SiteLogRecord>(*tables[1], row);
    if (at_slave.tick != at_master.tick) return tick_is_missing(*tables[1], at_master.tick);
    next = at_master.tick + 1;
    master.reading = reading_of(at_master, SiteRole::master);
    slave.reading = reading_of(at_slave, SiteRole::slave);
    master.state = static_cast<station::DeviceHealth>(at_master.health);
    slave.state = static_cast<station::DeviceHealth>(at_slave.health);
    const station::Tick tick{.number = at_master.tick, .missed = at_master.missed};
    const control::SiteRequests pressed = requests_of(at_master.pressed);
    const auto done = pair->step(tick, pressed);
    ++replay.ticks;
    replay.difference = compare(*tables[0], 0, at_master, recorded(tick, pressed, pair->sites().master(), done.master));
    if (!replay.difference) {
      replay.difference = compare(*tables[1], 0, at_slave, recorded(tick, pressed, pair->sites().slave(), done.slave));
    }
    if (replay.difference) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

Result<bool> replay_sites(const LogContent& content, const experiments::TappingParams& params, Replay& replay) {
  const LogTable* const one = find_table(content, "/site");
  const std::array both{find_table(content, "/master/site"), find_table(content, "/slave/site")};
  if (one == nullptr && (both[0] == nullptr || both[1] == nullptr)) return false;
  Check failed;
  if (one != nullptr) {
    const auto about = content.summary.metadata.find("tactus");
    const bool is_slave = about->second.contains("site") && about->second.at("site") == name_of(SiteRole::slave);
    replay.of = is_slave ? "the slave" : "the master";
    failed = replay_one(content, *one, params, is_slave ? SiteRole::slave : SiteRole::master, replay);
  } else {
    replay.of = "both sites";
    failed = replay_both(content, both, params, replay);
  }
  if (failed) return *std::move(failed);
  return true;
}

}  // namespace tactus::runtime
