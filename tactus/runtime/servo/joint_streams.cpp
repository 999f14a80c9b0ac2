// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/joint_streams.hpp>

#include <map>
#include <string>
#include <utility>

namespace tactus::runtime {

namespace {

/// A stream of a joint's records, in its units and with its name.
template <Recordable Record>
std::shared_ptr<telemetry::RecordStream<Record>> stream_of(const StreamedJoint& joint) {
  std::vector<telemetry::Column> columns = telemetry::columns_of<Record>();
  if (joint.turns) {
    for (telemetry::Column& column : columns) column = telemetry::of_turning_joint(std::move(column));
  }
  std::map<std::string, std::string> about;
  if (!joint.name.empty()) about["joint"] = joint.name;
  return std::make_shared<telemetry::RecordStream<Record>>(std::move(columns), std::move(about));
}

}  // namespace

JointStreams::JointStreams(const std::vector<StreamedJoint>& joints, std::optional<control::SiteRole> only)
    : joints_(joints),
      servo_(std::make_shared<telemetry::RecordStream<ServoRecord>>()),
      marks_(std::make_shared<telemetry::RecordStream<EpisodeMarkRecord>>()),
      requests_(std::make_shared<telemetry::RecordStream<SiteRequestRecord>>()),
      tares_(std::make_shared<telemetry::RecordStream<TareRecord>>()),
      start_(LogStart::now()) {
  for (const auto& [role, name] : enumerators(control::SiteRole{})) {
    if (only && *only != role) continue;
    OfSite& site = sites_[static_cast<std::size_t>(role)];
    site.ticks = std::make_shared<Site>();
    for (const StreamedJoint& joint : joints_) site.joints.push_back(stream_of<JointLogRecord>(joint));
  }
  if (!only) return;
  packets_ = std::make_shared<telemetry::RecordStream<PacketHeadRecord>>();
  for (const StreamedJoint& joint : joints_) joint_packets_.push_back(stream_of<PacketJointRecord>(joint));
}

void JointStreams::push(const station::Tick& tick, std::optional<EpisodeMark> mark,
                        const std::optional<SiteCommand>& asked) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns());
  if (mark) marks_->push(due_ns, {.tick = tick.number, .mark = static_cast<std::int64_t>(*mark)});
  if (asked) requests_->push(due_ns, recorded(tick, *asked));
}

void JointStreams::push(const station::Tick& tick, control::SiteRole site, const Joints<double>& tared_Nm) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns());
  for (std::size_t joint = 0; joint < tared_Nm.size(); ++joint) {
    tares_->push(due_ns, {.tick = tick.number,
                          .site = static_cast<std::int64_t>(site),
                          .joint = static_cast<std::int64_t>(joint + 1),
                          .lacking_Nm = tared_Nm[joint]});
  }
}

void JointStreams::push(const station::Tick& tick, const control::JointPacket& packet) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns());
  packets_->push(due_ns, recorded(tick, packet));
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    joint_packets_[joint]->push(due_ns, {packet.message[joint], tick.number});
  }
}

template <class Supervised>
void JointStreams::OfSite::push(std::uint64_t due_ns, const station::Tick& tick, const SiteTickRecord& record,
                                const Supervised& site, const station::Step<Supervised>& done) const noexcept {
  ticks->push(due_ns, record);
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    joints[joint]->push(due_ns, recorded(tick, joint, site, done));
  }
}

void JointStreams::push(const station::Tick& tick, const control::SiteRequests& pressed,
                        const station::JointLocalTeleoperator& sites,
                        const station::JointLocalTeleoperator::Output& done) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns());
  const auto& [master, slave] = sites_;
  const auto push_of = [&](const OfSite& to, const auto& site, const auto& step) noexcept {
    to.push(due_ns, tick, recorded(tick, pressed, site, step), site, step);
  };
  push_of(master, sites.sites().master(), done.master);
  push_of(slave, sites.sites().slave(), done.slave);
  servo_->push(due_ns, recorded(tick));
}

void JointStreams::push(const station::Tick& tick, const station::JointBarePair& sites,
                        const station::JointBarePair::Output& done,
                        const Joints<control::Message>& master_heard) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns());
  const auto& [master, slave] = sites_;
  master.ticks->push(due_ns, recorded_bare(tick, sites.master(), done.master));
  slave.ticks->push(due_ns, recorded_bare(tick, sites.slave(), done.slave));
  for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
    master.joints[joint]->push(due_ns, recorded_bare(tick, joint, sites.master(), done.master, master_heard[joint]));
    slave.joints[joint]->push(due_ns,
                              recorded_bare(tick, joint, sites.slave(), done.slave, done.master.output[joint].message));
  }
  servo_->push(due_ns, recorded(tick));
}

template <class Supervised>
void JointStreams::push(const station::Tick& tick, const control::SiteRequests& pressed, const Supervised& site,
                        const station::Step<Supervised>& done, const link::LinkCondition& condition,
                        std::int64_t arrivals) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns());
  SiteTickRecord record = recorded(tick, pressed, site, done);
  record.arrivals = arrivals;
  record.round_trip_s = condition.round_trip_s;
  record.link_silence_s = condition.silence_s;
  for (const OfSite& here : sites_) {
    if (here.ticks) here.push(due_ns, tick, record, site, done);
  }
  servo_->push(due_ns, recorded(tick));
}
template void JointStreams::push(const station::Tick&, const control::SiteRequests&,
                                 const control::JointSupervisedMaster&,
                                 const station::Step<control::JointSupervisedMaster>&, const link::LinkCondition&,
                                 std::int64_t) noexcept;
template void JointStreams::push(const station::Tick&, const control::SiteRequests&,
                                 const control::JointSupervisedSlave&,
                                 const station::Step<control::JointSupervisedSlave>&, const link::LinkCondition&,
                                 std::int64_t) noexcept;

}  // namespace tactus::runtime
