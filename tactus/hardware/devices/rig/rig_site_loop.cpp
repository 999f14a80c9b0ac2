// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig_site_loop.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>
#include <tactus/kernel/station/step.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tactus::devices {

using control::SiteRole;
using control::SiteState;
using station::DeviceReading;

bool tells_its_place(const Joints<control::ControlParams>& control, Seconds tick) {
  auto sites = control::make_sites(control, tick);
  if (!sites) return false;
  // So near one another that no gate disbelieves them.
  for (const double place : {1e-6, 3e-6, 2e-6}) {
    Joints<control::SlaveInput> input(control.size());
    for (auto& joint : input) joint.motor_position_m = place;
    for (const auto& joint : sites->slave.step(input, 0.0, 1)) {
      if (joint.message.position_m != place) return false;
    }
  }
  return true;
}

Result<RigSiteLoop> RigSiteLoop::make(JointSite site, link::JointEndpoint endpoint, Seconds tick, const Params& params,
                                      runtime::SiteExchange& exchange, MotorBusDevice& device,
                                      const std::optional<Joints<control::ControlParams>>& control,
                                      const std::optional<arm_control::MotorWatch>& motors) {
  const SiteRole role = site.index() == 0 ? SiteRole::master : SiteRole::slave;
  const std::size_t joints = std::visit([](const auto& each) { return each.site().gates().size(); }, site);
  if (params.scales.size() != joints) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "scales",
                 .message = "are of " + std::to_string(params.scales.size()) + " joints, and the site has " +
                            std::to_string(joints),
                 .place = {}};
  }
  std::unique_ptr<station::WatchedArm> watched;
  if (motors) watched = std::make_unique<station::WatchedArm>(device, *motors);
  station::JointDevice& driven = watched ? static_cast<station::JointDevice&>(*watched) : device;
  auto guard = control ? station::make_device_guard<Joints<DeviceReading>>(driven, *control, role)
                       : station::make_device_guard<Joints<DeviceReading>>(driven, joints, role);
  if (!guard) return guard.error();
  return RigSiteLoop(std::move(site), std::move(endpoint), tick, params, exchange, device, std::move(watched),
                     *std::move(guard));
}

RigSiteLoop::RigSiteLoop(JointSite site, link::JointEndpoint endpoint, Seconds tick, const Params& params,
                         runtime::SiteExchange& exchange, MotorBusDevice& device,
                         std::unique_ptr<station::WatchedArm> watched,
                         std::unique_ptr<station::GuardedJointDevice> guard)
    : console_({.duration_s = params.pair.duration_s,
                .arm_at_once = params.pair.arm_at_once,
                .listen_before_arming_s = params.pair.listen_before_arming_s,
                .tick_s = tick.value},
               exchange),
      params_(params),
      site_(std::move(site)),
      link_(std::move(endpoint), params.longest_age_s),
      device_(&device),
      watched_(std::move(watched)),
      guard_(std::move(guard)),
      driven_(guard_     ? static_cast<station::JointDevice*>(guard_.get())
              : watched_ ? static_cast<station::JointDevice*>(watched_.get())
                         : device_),
      read_(params.scales.size()),
      told_(params.scales.size()) {}

/// The joint that is farthest from where the other side's is; 0 where that is not heard.
void RigSiteLoop::judge_distance() noexcept {
  second_.farthest = 0.0;
  const bool hears = link_.heard() && link_.condition().silence_s < params_.timeout_s;
  for (std::size_t joint = 0; hears && joint < told_.size(); ++joint) {
    const double apart = std::fabs(told_[joint] - params_.scales[joint] * read_[joint].position_m);
    if (apart <= second_.farthest) continue;
    second_.farthest = apart;
    second_.joint = joint;
  }
  second_.too_far = own_ != SiteState::active && (!seen_ || !hears || !(second_.farthest <= params_.pair.farthest));
}

/// Whether motors may get power: the other side is heard, is near and works by the same parameters.
bool RigSiteLoop::may_align() const noexcept { return !second_.too_far && !disagrees_; }

/// Sites align when somebody arms and not before. The leader's asks for both: the follower does what it sees.
control::SiteRequests RigSiteLoop::asked(const control::SiteRequests& pressed) noexcept {
  control::SiteRequests request = pressed;
  request.align = false;
  if (!leads()) {
    const bool wanted = other_ == SiteState::align || other_ == SiteState::armed;
    request.align = own_ == SiteState::configure && wanted && may_align();
    return request;
  }
  request.arm = request.arm && may_align();
  if (own_ == SiteState::configure) {
    arming_ = request.arm || (arming_ && may_align());
    request.align = arming_;
    request.arm = false;
  } else if (arming_) {
    arming_ = false;
    request.arm = true;
  }
  return request;
}

template <class Site>
void RigSiteLoop::step(Site& site, const station::Tick& tick, const control::SiteRequests& pressed) noexcept {
  runtime::SeenLink way{link_, [this](const station::Tick& now, const control::JointPacket& packet) noexcept {
                          if (streams_ != nullptr) streams_->push(now, packet);
                        }};
  const auto done = station::step(site, *driven_, way, tick, pressed);
  seen_ = std::all_of(done.reading.begin(), done.reading.end(),
                      [](const DeviceReading& joint) { return std::isfinite(joint.position_m); });
  if (seen_) read_ = done.reading;
  const auto& heard = site.heard();
  told_ = member_of_each(heard.message, &control::Message::position_m);
  disagrees_ = site.agreement().disagrees();
  gives_force_ = site.site().passes_a_force();
  const auto now = static_cast<SiteState>(done.output.record.state);
  (leads() ? second_.leader : second_.follower) = now;
  (leads() ? second_.follower : second_.leader) = heard.state;
  second_.cause = static_cast<control::SiteCause>(done.output.record.cause);
  second_.support = {};
  second_.probe = {};
  note_support(second_, site, leads());
  note_probe(second_, site, leads());
  second_.fault = control::GateFault::none;
  for (std::size_t joint = 0; joint < read_.size(); ++joint) {
    second_.most_torque = std::max(second_.most_torque, std::fabs(done.output.site[joint].motor_force_N));
    const control::GateFault fault = site.site().gates()[joint].motor().fault();
    if (second_.fault != control::GateFault::none || fault == control::GateFault::none) continue;
    second_.fault = fault;
    second_.fault_joint = joint;
    second_.fault_evidence = site.site().gates()[joint].motor().evidence();
    second_.fault_of_leader = leads();
  }
  if (streams_ != nullptr) {
    streams_->push(tick, pressed, site, done, link_.condition(), link_.arrivals());
    streams_->push(tick, console_.mark(), console_.taken());
  }
  second_.force_gain = done.output.record.force_gain;
  RigSecond::Tare& tare = leads() ? second_.leader_tare : second_.follower_tare;
  if (note_tare(tare, site) && streams_ != nullptr) {
    streams_->push(tick, leads() ? SiteRole::master : SiteRole::slave, tare.found_Nm);
  }
  count(totals_, own_, now);
  own_ = now;
  other_ = heard.state;
}

bool RigSiteLoop::operator()(const station::Tick& tick) noexcept {
  if (console_.insisted()) {
    driven_->write(Joints<station::DeviceCommand>(read_.size(), {.enabled = false}));
    return false;
  }
  const control::SiteRequests by_person = console_.step(tick, own_, link_.heard());
  if (console_.leaving() && !at_end_) at_end_ = second_;
  judge_distance();
  const control::SiteRequests pressed = asked(by_person);
  std::visit([&](auto& site) noexcept { step(site, tick, pressed); }, site_);
  auto& health = leads() ? second_.leader_health : second_.follower_health;
  health = watched_ ? watched_->health() : device_->health();
  if (watched_) note_motor(second_, watched_->found(), leads());
  note(leads() ? second_.leader_trouble : second_.follower_trouble, device_->trouble());
  count(totals_, health);
  ++totals_.ticks;
  if (own_ == SiteState::active) ++totals_.active_ticks;
  totals_.duration_s = second_.time_s = console_.time_s();
  if (console_.ends_second()) end_second();
  return !console_.over(tick, own_ != SiteState::configure && own_ != SiteState::fault, gives_force_);
}

void RigSiteLoop::end_second() noexcept {
  second_.link = link_.end_second();
  shared_->try_push(second_);
  begin_anew(second_, stands(own_));
  std::visit([this](const auto& site) noexcept { link_.report_mismatch(site.agreement(), console_.exchange()); },
             site_);
}

}  // namespace tactus::devices
