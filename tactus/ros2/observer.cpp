#include <tactus/ros2/observer.hpp>

#include <chrono>
#include <optional>
#include <system_error>
#include <utility>

namespace tactus::ros2 {

namespace {

using control::SiteRole;
using control::SiteState;
using runtime::SiteLogRecord;
using runtime::SiteStreams;
using TeleoperatorStream = runtime::RealTimeStreams::Teleoperator;

OperatingState state_of(const SiteLogRecord& record) {
  switch (static_cast<SiteState>(record.state)) {
    case SiteState::configure:
      return OperatingState::disabled;
    case SiteState::active:
      return OperatingState::enabled;
    case SiteState::fault:
      return OperatingState::fault;
    case SiteState::align:
    case SiteState::armed:
    case SiteState::hold:
      break;
  }
  return OperatingState::paused;
}

/// What two sites do together: a fault of either counts, and they move where both do.
OperatingState together(OperatingState a, OperatingState b) {
  for (const OperatingState state : {OperatingState::fault, OperatingState::disabled, OperatingState::paused}) {
    if (a == state || b == state) return state;
  }
  return OperatingState::enabled;
}

/// Both streams of a pair, read in step.
struct PairReader {
  SiteStreams::Site::Reader master, slave;
  std::optional<SiteStreams::Site::Entry> told_by_master;
  std::int64_t to_time_of_day_ns;

  bool tell(Bridge& bridge, std::uint64_t& lost) {
    SiteStreams::Site::Entry entry;
    if (!told_by_master) {
      if (!master.next(entry)) return false;
      told_by_master = entry;
    }
    if (!slave.next(entry)) return false;
    // Where one stream lost records, the other catches up.
    while (told_by_master->number < entry.number) {
      if (!master.next(*told_by_master)) return told_by_master.reset(), false;
    }
    lost = master.lost();
    if (told_by_master->number > entry.number) return true;
    bridge.publish(snapshot_of(told_by_master->record, entry.record,
                               static_cast<std::int64_t>(entry.time_ns) + to_time_of_day_ns));
    told_by_master.reset();
    return true;
  }
};

}  // namespace

Snapshot snapshot_of(const simulation::Teleoperator::Record& record, std::int64_t stamp_ns, OperatingState state) {
  return {.stamp_ns = stamp_ns,
          .master_position_m = record.master_position_m,
          .master_force_N = -record.displayed_force_N,
          .hand_force_N = record.hand_force_N,
          .slave_position_m = record.slave_position_m,
          .slave_command_m = record.command_m,
          .environment_force_N = record.told_force_N,
          .estimated_grip = record.estimated_grip,
          .estimated_grip_deviation = record.estimated_grip_deviation,
          .state = state};
}

Snapshot snapshot_of(const SiteLogRecord& record, SiteRole role, std::int64_t stamp_ns) {
  Snapshot snapshot{.stamp_ns = stamp_ns, .state = state_of(record)};
  if (role == SiteRole::master) {
    snapshot.master_position_m = record.position_m;
    snapshot.master_force_N = record.motor_force_N;
    snapshot.hand_force_N = record.read_force_N;
    snapshot.estimated_grip = record.estimated_grip;
    snapshot.estimated_grip_deviation = record.estimated_grip_deviation;
  } else {
    snapshot.slave_position_m = record.position_m;
    snapshot.slave_command_m = record.Heard::position_m;
    snapshot.environment_force_N = record.read_force_N;
  }
  return snapshot;
}

Snapshot snapshot_of(const SiteLogRecord& master, const SiteLogRecord& slave, std::int64_t stamp_ns) {
  Snapshot snapshot = snapshot_of(master, SiteRole::master, stamp_ns);
  const Snapshot of_slave = snapshot_of(slave, SiteRole::slave, stamp_ns);
  snapshot.slave_position_m = of_slave.slave_position_m;
  snapshot.slave_command_m = master.Told::position_m;
  snapshot.environment_force_N = of_slave.environment_force_N;
  snapshot.state = together(snapshot.state, of_slave.state);
  return snapshot;
}

std::int64_t to_time_of_day_ns() {
  const std::int64_t now_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  return now_ns - runtime::monotonic_ns();
}

Result<std::unique_ptr<Observer>> Observer::create(Bridge::Params params) {
  params.takes_wishes = false;
  auto bridge = Bridge::create(params);
  if (!bridge) return bridge.error();
  return std::unique_ptr<Observer>(new Observer(*std::move(bridge)));
}

Observer::~Observer() { static_cast<void>(finish()); }

void Observer::watch(const runtime::RealTimeStreams& streams) {
  if (streams.teleoperator == nullptr) return;
  sources_.push_back([reader = streams.teleoperator->watch(), offset_ns = to_time_of_day_ns() + streams.origin_ns](
                         Bridge& bridge, std::uint64_t& lost) mutable {
    TeleoperatorStream::Entry entry;
    if (!reader.next(entry)) return false;
    lost = reader.lost();
    // A tap ends with the tick at which a gate closes.
    bridge.publish(
        snapshot_of(entry.record, static_cast<std::int64_t>(entry.time_ns) + offset_ns, OperatingState::enabled));
    return true;
  });
}

void Observer::watch(const SiteStreams& streams) {
  const std::int64_t offset_ns = to_time_of_day_ns() + streams.origin_ns;
  const SiteStreams::Site* const master = streams.of(SiteRole::master);
  const SiteStreams::Site* const slave = streams.of(SiteRole::slave);
  if (master != nullptr && slave != nullptr) {
    sources_.push_back([both = PairReader{master->watch(), slave->watch(), std::nullopt, offset_ns}](
                           Bridge& bridge, std::uint64_t& lost) mutable { return both.tell(bridge, lost); });
    return;
  }
  for (const auto& [role, name] : enumerators(SiteRole{})) {
    if (streams.of(role) == nullptr) continue;
    sources_.push_back(
        [reader = streams.of(role)->watch(), role = role, offset_ns](Bridge& bridge, std::uint64_t& lost) mutable {
          SiteStreams::Site::Entry entry;
          if (!reader.next(entry)) return false;
          lost = reader.lost();
          bridge.publish(snapshot_of(entry.record, role, static_cast<std::int64_t>(entry.time_ns) + offset_ns));
          return true;
        });
  }
}

Check Observer::start() {
  lost_.assign(sources_.size(), 0);
  try {
    thread_ = std::thread([this] { run(); });
  } catch (const std::system_error&) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "no thread could be started: raise the limit on processes (ulimit -u)",
                 .place = {}};
  }
  return std::nullopt;
}

void Observer::tell_all() {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    while (sources_[i](bridge_, lost_[i])) {
    }
  }
}

void Observer::run() noexcept {
  while (!stop_.load(std::memory_order_acquire)) {
    tell_all();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  tell_all();
}

Bridge::Counts Observer::finish() {
  if (thread_.joinable()) {
    stop_.store(true, std::memory_order_release);
    thread_.join();
    bridge_.close();
  }
  Bridge::Counts counts = bridge_.counts();
  for (const std::uint64_t lost : lost_) counts.dropped += lost;
  return counts;
}

}  // namespace tactus::ros2
