// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/kernel/station/step.hpp>
#include <tactus/runtime/servo/replay_rows.hpp>
#include <tactus/runtime/servo/site_parts.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

/// What the replays of sites share, of one axis and of several joints: their tables, and the steps on their rows.
namespace tactus::runtime {

/// One tick of a site of several joints: what they share, and each.
struct JointsRow : SiteTickRecord {
  Joints<JointLogRecord> joints;
};
template <class Reading>
using SiteRow = std::conditional_t<has_joints<Reading>, JointsRow, SiteLogRecord>;

station::DeviceReading reading_of(const SiteLogRecord& row);
Joints<station::DeviceReading> reading_of(const JointsRow& row);

/// What a step of a site was, as the log has such: of a site with supervision...
template <class Site>
auto row_of_step(const station::Tick& tick, const control::SiteRequests& pressed, const Site& site,
                 const station::Step<Site>& done) {
  if constexpr (has_joints<decltype(done.reading)>) {
    JointsRow row{recorded(tick, pressed, site, done), Joints<JointLogRecord>(done.reading.size())};
    for (std::size_t joint = 0; joint < row.joints.size(); ++joint) {
      row.joints[joint] = recorded(tick, joint, site, done);
    }
    return row;
  } else {
    return recorded(tick, pressed, site, done);
  }
}
/// ... and of one without, which received this.
template <class Site>
JointsRow row_of_step(const station::Tick& tick, const Site& site, const station::Step<Site>& done,
                      const Joints<control::Message>& heard) {
  JointsRow row{recorded_bare(tick, site, done), Joints<JointLogRecord>(done.reading.size())};
  for (std::size_t joint = 0; joint < row.joints.size(); ++joint) {
    row.joints[joint] = recorded_bare(tick, joint, site, done, heard[joint]);
  }
  return row;
}

/// Whether the log is of devices of several joints.
bool is_of_joints(const telemetry::LogContent& content);
/// How many joints the topics of a site are of, which begin with `place`: `/master`; 0 of one axis. Errors:
/// `inconsistent` for more than there can be, `missing` where one between them is.
Result<std::size_t> joints_in(const telemetry::LogContent& content, const std::string& place);

/// Their names, where the log has them.
std::vector<std::string> names_of_joints(const telemetry::LogContent& content);

/// Which site the log is of, where it is of one that was alone.
std::optional<control::SiteRole> only_site(const telemetry::LogContent& content);

/// What that site has in common with the other. Errors: `missing` if the log does not state it.
Result<control::Agreement> agreement_in(const telemetry::LogContent& content);

/// The limits of a site's device, as the log states them. Errors: `missing` if it does not, for several joints.
Result<station::DeviceLimits> limits_of(const telemetry::LogContent& content, control::SiteRole role,
                                        const station::DeviceLimits& like);
Result<Joints<station::DeviceLimits>> limits_of(const telemetry::LogContent& content, control::SiteRole role,
                                                const Joints<station::DeviceLimits>& like);

/// The topics of a site: of one axis one, of several joints one for what they share and one for each.
template <class Reading>
class SiteTables {
 public:
  using Shared = std::conditional_t<has_joints<Reading>, SiteTickRecord, SiteLogRecord>;

  /// Those that begin with `place`; `joints` as `joints_in` returns it. Errors: those of `check_table`.
  static Result<SiteTables> find(const telemetry::LogContent& content, const std::string& place, std::size_t joints) {
    SiteTables found;
    const auto add = [&]<class Record>(const std::string& topic, const Record&) -> Check {
      const telemetry::LogTable* const table = find_table(content, place + topic);
      if (table == nullptr) return refuse_replay(ErrorCode::missing, "the log has no topic " + place + topic);
      found.tables_.push_back(table);
      return check_table<Record>(*table);
    };
    if (Check error = add("/site", Shared())) return *std::move(error);
    for (std::size_t joint = 1; joint <= joints; ++joint) {
      if (Check error = add("/joint_" + std::to_string(joint), JointLogRecord())) return *std::move(error);
    }
    found.names_ = names_of_joints(content);
    return found;
  }

  [[nodiscard]] const std::vector<const telemetry::LogTable*>& all() const { return tables_; }
  [[nodiscard]] SiteRow<Reading> row(std::size_t row) const {
    if constexpr (has_joints<Reading>) {
      SiteRow<Reading> found{row_of<Shared>(*tables_[0], row), Joints<JointLogRecord>(tables_.size() - 1)};
      for (std::size_t joint = 0; joint < found.joints.size(); ++joint) {
        found.joints[joint] = row_of<JointLogRecord>(*tables_[joint + 1], row);
      }
      return found;
    } else {
      return row_of<Shared>(*tables_[0], row);
    }
  }
  /// The first topic whose row is of another tick.
  [[nodiscard]] const telemetry::LogTable* without(std::int64_t tick, const SiteRow<Reading>& row) const {
    if (row.tick != tick) return tables_[0];
    if constexpr (has_joints<Reading>) {
      for (std::size_t joint = 0; joint < row.joints.size(); ++joint) {
        if (row.joints[joint].tick != tick) return tables_[joint + 1];
      }
    }
    return nullptr;
  }
  /// The first signal that differs, those of joints first. What only the link knows is not compared.
  [[nodiscard]] std::optional<ReplayDifference> difference(std::int64_t tap, const SiteRow<Reading>& logged,
                                                           SiteRow<Reading> replayed) const {
    if constexpr (has_joints<Reading>) {
      for (std::size_t joint = 0; joint < logged.joints.size(); ++joint) {
        auto found = compare(*tables_[joint + 1], tap, logged.joints[joint], replayed.joints[joint]);
        if (!found) continue;
        if (joint < names_.size()) found->joint = names_[joint];
        return found;
      }
    }
    replayed.arrivals = logged.arrivals;
    replayed.round_trip_s = logged.round_trip_s;
    replayed.link_silence_s = logged.link_silence_s;
    return compare(*tables_[0], tap, static_cast<const Shared&>(logged), static_cast<const Shared&>(replayed));
  }

 private:
  std::vector<const telemetry::LogTable*> tables_;
  std::vector<std::string> names_;
};

/// The link of a site that ran alone: the packets of its log, tick by tick. The log of a site that never received one
/// has no topic for them.
template <class Reading>
class RecordedPackets {
  using Payload = Each<Reading, control::Message>;
  using Head = std::conditional_t<has_joints<Reading>, PacketHeadRecord, PacketRecord>;

 public:
  /// Of `joints`, 0 of one axis. Errors: those of `check_table`; `missing` for a topic of a joint.
  static Result<RecordedPackets> find(const telemetry::LogContent& content, std::size_t joints) {
    RecordedPackets found;
    const auto add = [&]<class Record>(const std::string& topic, const Record&) -> Check {
      const telemetry::LogTable* const table = find_table(content, topic);
      if (table == nullptr) return refuse_replay(ErrorCode::missing, "the log has no topic " + topic);
      found.tables_.push_back(table);
      return check_table<Record>(*table);
    };
    if (find_table(content, "/packets") == nullptr) return found;
    if (Check error = add("/packets", Head())) return *std::move(error);
    for (std::size_t joint = 1; joint <= joints; ++joint) {
      if (Check error = add("/packets/joint_" + std::to_string(joint), PacketJointRecord())) return *std::move(error);
    }
    return found;
  }

  /// False where the log has not so many at this tick.
  bool go_to(std::int64_t tick, std::int64_t arrivals) {
    packets_.clear();
    for (; arrivals > 0; --arrivals, ++next_) {
      const auto ends = [this](const telemetry::LogTable* table) { return next_ >= table->times_ns.size(); };
      if (tables_.empty() || std::ranges::any_of(tables_, ends)) return false;
      const Head head = row_of<Head>(*tables_[0], next_);
      if (head.tick != tick) return false;
      if constexpr (has_joints<Reading>) {
        Joints<control::Message> message(tables_.size() - 1);
        for (std::size_t joint = 0; joint < message.size(); ++joint) {
          const auto said = row_of<PacketJointRecord>(*tables_[joint + 1], next_);
          if (said.tick != tick) return false;
          message[joint] = said;
        }
        packets_.push_back(packet_of(head, message));
      } else {
        packets_.push_back(packet_of<control::Message>(head, head));
      }
    }
    return true;
  }
  // The way of the site.
  template <class Take>
  void receive(const station::Tick&, Take&& take) const {
    for (const auto& packet : packets_) take(packet);
  }
  void send(const control::PacketOf<Payload>&, const station::Tick&) const noexcept {}

 private:
  std::vector<const telemetry::LogTable*> tables_;
  std::vector<control::PacketOf<Payload>> packets_;
  std::size_t next_ = 0;
};

/// In which all topics have a record. Errors: `inconsistent` where one has fewer than another in a log that is whole.
Result<std::size_t> common_rows(const std::vector<const telemetry::LogTable*>& tables, bool whole);

Error tick_is_missing(const telemetry::LogTable& table, std::int64_t tick);

/// Hands what was read to the device in its place.
template <class Reading>
void feed(RecordedDeviceOf<Reading>& device, const SiteRow<Reading>& row) {
  device.reading = reading_of(row);
  device.state = static_cast<station::DeviceHealth>(row.health);
}

/// Steps sites once more, row by row, and compares. `step(tap, tick, logged)` gives the rows that they leave now; of
/// several taps, each of which begins at tick 0, it makes new sites there.
template <class Reading, std::size_t N, class Step>
Check replay_rows(const std::array<SiteTables<Reading>, N>& sites, bool whole, bool taps, Replay& replay, Step&& step) {
  std::vector<const telemetry::LogTable*> tables;
  for (const auto& site : sites) tables.insert(tables.end(), site.all().begin(), site.all().end());
  const auto rows = common_rows(tables, whole);
  if (!rows) return rows.error();
  std::int64_t next = 0;
  for (std::size_t row = 0; row < *rows; ++row) {
    std::array<SiteRow<Reading>, N> logged;
    for (std::size_t site = 0; site < N; ++site) logged[site] = sites[site].row(row);
    const station::Tick tick{.number = logged[0].tick, .missed = logged[0].missed};
    if (taps && tick.number == 0) {
      ++replay.taps;
      next = 0;
    }
    const bool follows = tick.missed >= 0 && tick.missed <= tick.number && tick.number - tick.missed == next;
    if (!follows || (taps && replay.taps == 0)) return tick_is_missing(*tables[0], next);
    for (std::size_t site = 0; site < N; ++site) {
      if (const auto* without = sites[site].without(tick.number, logged[site])) {
        return tick_is_missing(*without, tick.number);
      }
    }
    next = tick.number + 1;
    ++replay.ticks;
    const std::int64_t tap = taps ? replay.taps - 1 : 0;
    const Result<std::array<SiteRow<Reading>, N>> replayed = step(tap, tick, std::as_const(logged));
    if (!replayed) return replayed.error();
    for (std::size_t site = 0; site < N && !replay.difference; ++site) {
      replay.difference = sites[site].difference(tap, logged[site], (*replayed)[site]);
    }
    if (replay.difference) return std::nullopt;
  }
  return std::nullopt;
}

/// As many limits as the log has joints.
template <class Reading>
Each<Reading, station::DeviceLimits> limits_like([[maybe_unused]] std::size_t joints) {
  if constexpr (has_joints<Reading>) {
    return Joints<station::DeviceLimits>(joints);
  } else {
    return {};
  }
}

/// One site under supervision, which was alone; `make(limits)` gives the site, of either role, before such a device.
template <class Reading, class Make>
Check replay_one(const telemetry::LogContent& content, control::SiteRole role, const std::string& place,
                 std::size_t joints, Replay& replay, Make&& make) {
  using Rows = std::array<SiteRow<Reading>, 1>;
  const auto tables = SiteTables<Reading>::find(content, place, joints);
  if (!tables) return tables.error();
  auto way = RecordedPackets<Reading>::find(content, joints);
  if (!way) return way.error();
  const auto limits = limits_of(content, role, limits_like<Reading>(joints));
  if (!limits) return limits.error();
  auto site = make(*limits);
  if (!site) return site.error();
  RecordedDeviceOf<Reading> device(*limits);
  return replay_rows<Reading, 1>(
      {*tables}, content.summary.complete, false, replay,
      [&](std::int64_t, const station::Tick& tick, const Rows& logged) -> Result<Rows> {
        if (!way->go_to(tick.number, logged[0].arrivals)) {
          return refuse_replay(ErrorCode::inconsistent, "topic /packets lacks what arrived in control cycle " +
                                                            std::to_string(tick.number) +
                                                            ": there is nothing to replay it from");
        }
        feed(device, logged[0]);
        const control::SiteRequests pressed = requests_of(logged[0]);
        return std::visit(
            [&](auto& each) {
              return Rows{row_of_step(tick, pressed, each, station::step(each, device, *way, tick, pressed))};
            },
            *site);
      });
}

/// Both sites under supervision; `make(master, slave)` gives the `DevicePair` between these devices.
template <class Reading, class Make>
Check replay_both(const telemetry::LogContent& content, std::size_t joints, Replay& replay, Make&& make) {
  using Rows = std::array<SiteRow<Reading>, 2>;
  const auto at_master = SiteTables<Reading>::find(content, "/master", joints);
  if (!at_master) return at_master.error();
  const auto at_slave = SiteTables<Reading>::find(content, "/slave", joints);
  if (!at_slave) return at_slave.error();
  const auto like = limits_like<Reading>(joints);
  const auto of_master = limits_of(content, control::SiteRole::master, like);
  if (!of_master) return of_master.error();
  const auto of_slave = limits_of(content, control::SiteRole::slave, like);
  if (!of_slave) return of_slave.error();
  RecordedDeviceOf<Reading> master(*of_master), slave(*of_slave);
  auto pair = make(master, slave);
  if (!pair) return pair.error();
  return replay_rows<Reading, 2>({*at_master, *at_slave}, content.summary.complete, false, replay,
                                 [&](std::int64_t, const station::Tick& tick, const Rows& logged) -> Result<Rows> {
                                   feed(master, logged[0]);
                                   feed(slave, logged[1]);
                                   const control::SiteRequests pressed = requests_of(logged[0]);
                                   const auto done = pair->step(tick, pressed);
                                   return Rows{row_of_step(tick, pressed, pair->sites().master(), done.master),
                                               row_of_step(tick, pressed, pair->sites().slave(), done.slave)};
                                 });
}

/// Who makes the sites of several joints that a log is of.
struct JointMakers {
  std::function<Check(std::size_t joints)> both;  ///< replays them, too
  std::function<Result<JointSupervisedSite>(control::SiteRole, const Joints<station::DeviceLimits>&,
                                            std::int64_t session, const control::Agreement&)>
      one;
};
/// Both sites of several joints under supervision, or the one that was alone.
Check replay_joints(const telemetry::LogContent& content, Replay& replay, const JointMakers& makers);

}  // namespace tactus::runtime
