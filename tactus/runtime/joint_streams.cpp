#include <tactus/runtime/joint_streams.hpp>
#include <tactus/runtime/servo_thread.hpp>

namespace tactus::runtime {

JointStreams::JointStreams(std::size_t joints, std::optional<control::SiteRole> only)
    : joints_(joints), servo_(std::make_shared<telemetry::RecordStream<ServoRecord>>()), origin_ns_(monotonic_ns()) {
  for (const auto& [role, name] : enumerators(control::SiteRole{})) {
    if (only && *only != role) continue;
    OfSite& site = sites_[static_cast<std::size_t>(role)];
    site.ticks = std::make_shared<Site>();
    for (std::size_t joint = 0; joint < joints; ++joint) {
      site.joints.push_back(std::make_shared<Joint>());
    }
  }
  if (!only) return;
  packets_ = std::make_shared<telemetry::RecordStream<PacketHeadRecord>>();
  for (std::size_t joint = 0; joint < joints; ++joint) {
    joint_packets_.push_back(std::make_shared<telemetry::RecordStream<PacketJointRecord>>());
  }
}

void JointStreams::push(const station::Tick& tick, const control::JointPacket& packet) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns_);
  packets_->push(due_ns, recorded(tick, packet));
  for (std::size_t joint = 0; joint < joints_; ++joint) {
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
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns_);
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
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns_);
  const auto& [master, slave] = sites_;
  master.ticks->push(due_ns, recorded_bare(tick, sites.master(), done.master));
  slave.ticks->push(due_ns, recorded_bare(tick, sites.slave(), done.slave));
  for (std::size_t joint = 0; joint < joints_; ++joint) {
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
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns_);
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
