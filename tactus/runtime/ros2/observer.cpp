// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/observer.hpp>

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>
#include <vector>

namespace tactus::ros2 {

namespace {

using control::SiteRole;
using control::SiteState;
using runtime::AxisRecord;
using runtime::JointStreams;
using runtime::SiteLogRecord;
using runtime::SiteStreams;
using TeleoperatorStream = runtime::RealTimeStreams::Teleoperator;

OperatingState state_of(const control::SiteRecord& record) {
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

/// A stream of which each tick has a record.
template <class Stream>
struct Followed {
  explicit Followed(const Stream& stream) : reader(stream.watch()) {}

  /// Goes to the record of this number, or the first behind it that was not lost; false where there is none yet.
  bool reach(std::uint64_t number) {
    while (!stands || entry.number < number) {
      if (!reader.next(entry)) return false;
      stands = true;
    }
    return true;
  }

  typename Stream::Reader reader;
  typename Stream::Entry entry;
  bool stands = false;  ///< at `entry`
};

/// Streams that take a record each at every tick, read in step: where one lost some the others skip theirs.
class InStep {
 public:
  /// Goes to the next tick that all of them have; false where that is still to come. `visit` calls what it is given
  /// with each `Followed`.
  template <class Visit>
  bool next(const Visit& visit) {
    while (true) {
      std::uint64_t newest = number_;
      bool all = true;
      visit([&](auto& stream) {
        all = all && stream.reach(number_);
        if (all) newest = std::max(newest, stream.entry.number);
      });
      if (!all) return false;
      if (newest == number_) break;
      number_ = newest;
    }
    ++number_;
    return true;
  }

 private:
  std::uint64_t number_ = 0;
};

/// Both sites of one axis.
struct PairReader {
  Followed<SiteStreams::Site> master, slave;
  std::int64_t to_time_of_day_ns;
  InStep step = {};

  bool tell(Bridge& bridge, std::uint64_t& lost) {
    const bool told = step.next([this](const auto& reach) { reach(master), reach(slave); });
    lost = master.reader.lost();
    if (!told) return false;
    bridge.publish(snapshot_of(master.entry.record, slave.entry.record,
                               static_cast<std::int64_t>(master.entry.time_ns) + to_time_of_day_ns));
    return true;
  }
};

/// What a record of a joint or an axis tells of it; `of` keeps what the other site does.
template <class Record>
void tell_of(JointSnapshot& of, const Record& record, SiteRole role) {
  const AxisRecord& axis = record;
  if (role == SiteRole::master) {
    of.master_position_m = axis.position_m;
    of.master_force_N = axis.motor_force_N;
    of.hand_force_N = axis.read_force_N;
    of.estimated_grip = axis.estimated_grip;
    of.estimated_grip_deviation = axis.estimated_grip_deviation;
    of.slave_command_m = record.Record::Sent::position_m;
  } else {
    of.slave_position_m = axis.position_m;
    of.environment_force_N = axis.read_force_N;
  }
}

/// The sites of several joints that are here.
class JointsReader {
 public:
  explicit JointsReader(const JointStreams& streams, std::int64_t to_time_of_day_ns)
      : count_(streams.joints()), to_time_of_day_ns_(to_time_of_day_ns) {
    for (const auto& [role, name] : enumerators(SiteRole{})) {
      if (!streams.has(role)) continue;
      roles_.push_back(role);
      sites_.emplace_back(streams.site(role));
      for (std::size_t joint = 0; joint < count_; ++joint) joints_.emplace_back(streams.joint(role, joint));
    }
  }

  bool tell(Bridge& bridge, std::uint64_t& lost) {
    const bool told = step_.next([this](const auto& reach) {
      for (auto& site : sites_) reach(site);
      for (auto& joint : joints_) reach(joint);
    });
    lost = sites_.front().reader.lost();
    if (!told) return false;
    Snapshot snapshot{.stamp_ns = static_cast<std::int64_t>(sites_.front().entry.time_ns) + to_time_of_day_ns_,
                      .joints = Joints<JointSnapshot>(count_),
                      .state = together(state_of(sites_.front().entry.record), state_of(sites_.back().entry.record))};
    for (std::size_t site = 0; site < roles_.size(); ++site) {
      for (std::size_t joint = 0; joint < count_; ++joint) {
        const auto& record = joints_[site * count_ + joint].entry.record;
        tell_of(snapshot.joints[joint], record, roles_[site]);
        if (roles_.front() == SiteRole::slave) snapshot.joints[joint].slave_command_m = record.Received::position_m;
      }
    }
    bridge.publish(snapshot);
    return true;
  }

 private:
  std::size_t count_;
  std::vector<SiteRole> roles_;
  std::vector<Followed<JointStreams::Site>> sites_;    ///< of `roles_`
  std::vector<Followed<JointStreams::Joint>> joints_;  ///< of the first role, then of the other
  std::int64_t to_time_of_day_ns_;
  InStep step_;
};

}  // namespace

Snapshot snapshot_of(const station::TeleoperatorRecord& record, std::int64_t stamp_ns, OperatingState state) {
  Snapshot snapshot{.stamp_ns = stamp_ns, .state = state};
  snapshot.joints[0] = {.master_position_m = record.master_position_m,
                        .master_force_N = -record.displayed_force_N,
                        .hand_force_N = record.hand_force_N,
                        .slave_position_m = record.slave_position_m,
                        .slave_command_m = record.command_m,
                        .environment_force_N = record.sent_force_N,
                        .estimated_grip = record.estimated_grip,
                        .estimated_grip_deviation = record.estimated_grip_deviation};
  return snapshot;
}

Snapshot snapshot_of(const SiteLogRecord& record, SiteRole role, std::int64_t stamp_ns) {
  Snapshot snapshot{.stamp_ns = stamp_ns, .state = state_of(record)};
  tell_of(snapshot.joints[0], record, role);
  snapshot.joints[0].slave_command_m = role == SiteRole::slave ? record.Received::position_m : 0.0;
  return snapshot;
}

Snapshot snapshot_of(const SiteLogRecord& master, const SiteLogRecord& slave, std::int64_t stamp_ns) {
  Snapshot snapshot{.stamp_ns = stamp_ns, .state = together(state_of(master), state_of(slave))};
  tell_of(snapshot.joints[0], master, SiteRole::master);
  tell_of(snapshot.joints[0], slave, SiteRole::slave);
  return snapshot;
}

std::int64_t to_time_of_day_ns() {
  const std::int64_t now_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  return now_ns - runtime::monotonic_ns();
}

Result<std::unique_ptr<Observer>> Observer::create(Bridge::Params params) {
  params.takes_requests = false;
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
    sources_.push_back([both = PairReader{Followed(*master), Followed(*slave), offset_ns}](
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

void Observer::watch(const JointStreams& streams) {
  sources_.push_back([both = JointsReader(streams, to_time_of_day_ns() + streams.origin_ns())](
                         Bridge& bridge, std::uint64_t& lost) mutable { return both.tell(bridge, lost); });
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
