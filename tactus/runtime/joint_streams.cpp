#include <tactus/runtime/joint_streams.hpp>
#include <tactus/runtime/servo_thread.hpp>

namespace tactus::runtime {

JointStreams::JointStreams(std::size_t joints)
    : servo_(std::make_shared<telemetry::RecordStream<ServoRecord>>()), origin_ns_(monotonic_ns()) {
  for (OfSite& site : sites_) {
    site.ticks = std::make_shared<Site>();
    for (std::size_t joint = 0; joint < joints; ++joint) {
      site.joints.push_back(std::make_shared<Joint>());
    }
  }
}

template <class Supervised>
void JointStreams::OfSite::push(std::uint64_t due_ns, const station::Tick& tick, const control::SiteRequests& pressed,
                                const Supervised& site, const station::Step<Supervised>& done) noexcept {
  ticks->push(due_ns, recorded(tick, pressed, site, done));
  for (std::size_t joint = 0; joint < joints.size(); ++joint) {
    joints[joint]->push(due_ns, recorded(tick, joint, site, done));
  }
}

void JointStreams::push(const station::Tick& tick, const control::SiteRequests& pressed,
                        const station::JointLocalTeleoperator& sites,
                        const station::JointLocalTeleoperator::Output& done) noexcept {
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - origin_ns_);
  sites_[0].push(due_ns, tick, pressed, sites.sites().master(), done.master);
  sites_[1].push(due_ns, tick, pressed, sites.sites().slave(), done.slave);
  servo_->push(due_ns, recorded(tick));
}

}  // namespace tactus::runtime
