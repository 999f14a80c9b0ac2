// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/episodes.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/runtime/link/endpoint.hpp>
#include <tactus/runtime/servo/log_start.hpp>
#include <tactus/runtime/servo/servo_record.hpp>
#include <tactus/runtime/servo/site_record.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::runtime {

/// A joint as its records call it.
struct StreamedJoint {
  std::string name = {};  ///< empty: not stated
  bool turns = false;     ///< in rad and N m; else it slides, in m and N
};

/// Where the sites of a teleoperator of several joints leave every tick, both or the one that runs here: a stream for
/// what the joints of a site share, and one for each joint.
class JointStreams {
 public:
  /// 1 to `most_joints` at each site; `only` where the other one runs elsewhere. Times count from now.
  explicit JointStreams(const std::vector<StreamedJoint>& joints, std::optional<control::SiteRole> only = {});
  /// The same of joints that are in m and N whatever they are, and have no name.
  explicit JointStreams(std::size_t joints, std::optional<control::SiteRole> only = {})
      : JointStreams(std::vector<StreamedJoint>(joints), only) {}

  /// A tick of both sites. One thread only. Real-time safe.
  void push(const station::Tick& tick, const control::SiteRequests& pressed,
            const station::JointLocalTeleoperator& sites, const station::JointLocalTeleoperator::Output& done) noexcept;

  /// The same of sites without supervision; `master_heard` is what the master received. The channel has no
  /// delay, so the slave receives what the master sends.
  void push(const station::Tick& tick, const station::JointBarePair& sites, const station::JointBarePair::Output& done,
            const Joints<control::Message>& master_heard) noexcept;

  /// A tick of the one site, with what the link knew of the other and how many packets came. The same.
  template <class Supervised>
  void push(const station::Tick& tick, const control::SiteRequests& pressed, const Supervised& site,
            const station::Step<Supervised>& done, const link::LinkCondition& condition,
            std::int64_t arrivals) noexcept;
  /// What was asked for at this tick, and which mark it is, if anything. The same.
  void push(const station::Tick& tick, std::optional<EpisodeMark> mark,
            const std::optional<SiteCommand>& asked = {}) noexcept;
  /// What a tare found, for each joint of the arm of this site. The same.
  void push(const station::Tick& tick, control::SiteRole site, const Joints<double>& tared_Nm) noexcept;
  /// A packet that came to it at this tick, before that. The same.
  void push(const station::Tick& tick, const control::JointPacket& packet) noexcept;

  using Site = telemetry::RecordStream<SiteTickRecord>;
  using Joint = telemetry::RecordStream<JointLogRecord>;
  [[nodiscard]] bool has(control::SiteRole role) const noexcept { return of(role).ticks != nullptr; }
  /// Of a site that is here, as the next.
  [[nodiscard]] const Site& site(control::SiteRole role) const noexcept { return *of(role).ticks; }
  /// From 0.
  [[nodiscard]] const Joint& joint(control::SiteRole role, std::size_t number) const noexcept {
    return *of(role).joints[number];
  }
  [[nodiscard]] std::size_t joints() const noexcept { return joints_.size(); }
  /// From which the times of the records count, on CLOCK_MONOTONIC.
  [[nodiscard]] std::int64_t origin_ns() const noexcept { return start_.monotonic_ns; }
  [[nodiscard]] const LogStart& log_start() const noexcept { return start_; }

  /// Calls `visit(topic, type_name, stream)` for each stream there is: `/master/site`, `/master/joint_1` and on, the
  /// slave's; of a site that is alone `/packets`, `/packets/joint_1` and on, what came over the link; `/servo`;
  /// `/episodes`; `/requests`; `/tares`. The columns of a joint that turns are in rad and N m, and its types are called
  /// `Turning...`.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for (const auto& [role, name] : enumerators(control::SiteRole{})) {
      const OfSite& site = of(role);
      if (!site.ticks) continue;
      const std::string place = std::string("/").append(name);
      visit(std::string(place).append("/site"), "tactus_msgs/msg/SiteTickRecord", *site.ticks);
      for (std::size_t joint = 0; joint < site.joints.size(); ++joint) {
        visit(std::string(place).append("/joint_").append(std::to_string(joint + 1)),
              joints_[joint].turns ? "tactus_msgs/msg/TurningJointRecord" : "tactus_msgs/msg/JointRecord",
              *site.joints[joint]);
      }
    }
    if (packets_) visit(std::string("/packets"), "tactus_msgs/msg/PacketHeadRecord", *packets_);
    for (std::size_t joint = 0; joint < joint_packets_.size(); ++joint) {
      visit(std::string("/packets/joint_").append(std::to_string(joint + 1)),
            joints_[joint].turns ? "tactus_msgs/msg/TurningPacketJointRecord" : "tactus_msgs/msg/PacketJointRecord",
            *joint_packets_[joint]);
    }
    visit(std::string("/servo"), "tactus_msgs/msg/ServoRecord", *servo_);
    visit(std::string(telemetry::episodes_topic), "tactus_msgs/msg/EpisodeMarkRecord", *marks_);
    visit(std::string("/requests"), "tactus_msgs/msg/SiteRequestRecord", *requests_);
    visit(std::string("/tares"), "tactus_msgs/msg/TareRecord", *tares_);
  }

 private:
  struct OfSite {
    std::shared_ptr<Site> ticks;
    std::vector<std::shared_ptr<Joint>> joints;

    template <class Supervised>
    void push(std::uint64_t due_ns, const station::Tick& tick, const SiteTickRecord& record, const Supervised& site,
              const station::Step<Supervised>& done) const noexcept;
  };

  [[nodiscard]] const OfSite& of(control::SiteRole role) const noexcept {
    return sites_[static_cast<std::size_t>(role)];
  }

  std::vector<StreamedJoint> joints_;
  std::array<OfSite, 2> sites_;  ///< by role; without streams where it is elsewhere
  std::shared_ptr<telemetry::RecordStream<PacketHeadRecord>> packets_;  ///< of a site that is alone
  std::vector<std::shared_ptr<telemetry::RecordStream<PacketJointRecord>>> joint_packets_;
  std::shared_ptr<telemetry::RecordStream<ServoRecord>> servo_;
  std::shared_ptr<telemetry::RecordStream<EpisodeMarkRecord>> marks_;
  std::shared_ptr<telemetry::RecordStream<SiteRequestRecord>> requests_;
  std::shared_ptr<telemetry::RecordStream<TareRecord>> tares_;
  LogStart start_;
};

}  // namespace tactus::runtime
