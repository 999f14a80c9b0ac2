// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>
#include <tactus/hardware/wire/paced.hpp>
#include <tactus/hardware/wire/port.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/interfaces/cli/emulate.hpp>
#include <tactus/interfaces/cli/quiet_thread.hpp>
#include <tactus/interfaces/cli/rehearsal.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>
#include <thread>
#include <utility>

namespace tactus::cli {

namespace {

using control::SiteRole;
using devices::BusKind;
using devices::MotorJoint;
using devices::RigJoint;
using devices::RigSide;
using emulation::damiao::AdapterType;
using emulation::damiao::DamiaoPeer;
using emulation::damiao::MotorType;
using emulation::dynamixel::DynamixelPeer;
using emulation::feetech::FeetechPeer;

/// Of an adapter that a pseudo-terminal can replace.
constexpr std::int64_t adapter_bits_per_s = 921'600;

double motor_position_rad(const MotorJoint& joint, double of_joint_rad) {
  return static_cast<double>(joint.sign) * joint.gear * (of_joint_rad - joint.offset_rad);
}

/// An arm whose motors have the signs, gears and zeros of the rig file.
class WiredArm final : public emulation::damiao::Mechanism {
 public:
  WiredArm(std::unique_ptr<real_time::EmulatedArm> arm, const RigSide& side) : arm_(std::move(arm)) {
    for (std::size_t i = 0; i < motors(); ++i) joints_[i] = side.joints[i].joint;
  }
  [[nodiscard]] std::size_t motors() const noexcept override { return arm_->motors(); }
  [[nodiscard]] double position_rad(std::size_t motor) const noexcept override {
    return motor_position_rad(joints_[motor], arm_->position_rad(motor));
  }
  [[nodiscard]] double velocity_rad_per_s(std::size_t motor) const noexcept override {
    const MotorJoint& joint = joints_[motor];
    return static_cast<double>(joint.sign) * joint.gear * arm_->velocity_rad_per_s(motor);
  }
  void step(std::span<const double> torque_Nm) noexcept override {
    std::array<double, most_joints> at_joints{};
    for (std::size_t i = 0; i < motors(); ++i) at_joints[i] = joints_[i].torque_Nm(torque_Nm[i]);
    arm_->step(std::span(at_joints).first(motors()));
  }

 private:
  std::unique_ptr<real_time::EmulatedArm> arm_;
  std::array<MotorJoint, most_joints> joints_{};
};

Error not_emulated(const RigJoint& joint, const std::string& models) {
  return {.code = ErrorCode::inconsistent,
          .parameter = join(joint.path, "model"),
          .message = "tactus does not emulate a " + joint.motor.model +
                     ", so this rig cannot be rehearsed: it emulates " + models,
          .place = {}};
}

/// All words of an enum.
template <NamedEnum E>
std::string listed() {
  std::string all;
  for (const std::string& word : words_of<E>()) all += (all.empty() ? "" : ", ") + word;
  return all;
}

template <NamedEnum E>
bool knows(const std::string& word) {
  return std::ranges::any_of(enumerators(E{}), [&word](const auto& entry) { return entry.name == word; });
}

using Starts = std::vector<double>;  ///< of the joints of a side, in rad or m

Result<EmulatedPeer> damiao_peer(RigSide& side, const Starts& starts, const std::vector<std::string>& faults,
                                 std::unique_ptr<emulation::damiao::Mechanism> arm) {
  emulation::damiao::PeerSettings settings;
  // No terminal passes the frames of SocketCAN.
  if (!emulation::damiao::is_serial(value_of<AdapterType>(side.bus.framing))) side.bus.framing = "usb2can";
  settings.adapter = value_of<AdapterType>(side.bus.framing);
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    const RigJoint& joint = side.joints[i];
    if (!knows<MotorType>(joint.motor.model)) return not_emulated(joint, listed<MotorType>());
    const auto id = static_cast<std::uint32_t>(joint.motor.id);
    constexpr std::uint32_t usual_feedback = 16;
    settings.motors.push_back({.id = id,
                               .feedback_id = joint.motor.feedback_id < 0
                                                  ? id + usual_feedback
                                                  : static_cast<std::uint32_t>(joint.motor.feedback_id),
                               .type = value_of<MotorType>(joint.motor.model),
                               .joint = {.position_rad = motor_position_rad(joint.joint, starts[i])}});
  }
  for (const std::string& word : faults) {
    auto fault = emulation::damiao::parse_fault(word);
    const auto named = [&fault](const RigJoint& joint) { return fault->motor == 0 || joint.motor.id == fault->motor; };
    if (fault && !std::ranges::any_of(side.joints, named)) {
      fault = Error{ErrorCode::out_of_bounds, {}, "'" + word + "' names no motor of " + side.path, {}};
    }
    if (!fault) {
      Error error = fault.error();
      error.place = "--fault";
      return error;
    }
    settings.faults.push_back(*fault);
  }
  auto peer = DamiaoPeer::make(settings, std::move(arm));
  if (!peer) return peer.error();
  EmulatedPeer made{.motors = *std::move(peer), .line = nullptr};
  made.line =
      std::make_unique<wire::Paced>(*made.motors, wire::byte_ns(adapter_bits_per_s), wire::Paced::Line::full_duplex);
  return made;
}

template <class Peer, class Set>
Result<EmulatedPeer> servo_peer(const RigSide& side, const Starts& starts, const std::vector<std::string>& faults,
                                const Set& set_model) {
  typename Peer::Params params;
  params.servos.clear();
  params.bits_per_s = side.bus.bits_per_s;
  for (const RigJoint& joint : side.joints) {
    typename Peer::Servo servo{.id = joint.motor.id};
    if (!set_model(servo, joint)) return set_model.refuse(joint);
    params.servos.push_back(servo);
  }
  if (Check wrong = add_servo_faults(params, faults)) return *std::move(wrong);
  auto made = Peer::make(params);
  if (!made) return made.error();
  auto peer = std::make_unique<Peer>(*std::move(made));
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    peer->joint(i).position_rad = motor_position_rad(side.joints[i].joint, starts[i]);
  }
  EmulatedPeer emulated{.motors = std::move(peer), .line = nullptr};
  emulated.line = std::make_unique<wire::Paced>(*emulated.motors, wire::byte_ns(side.bus.bits_per_s),
                                                wire::Paced::Line::half_duplex);
  return emulated;
}

struct SetDynamixel {
  bool operator()(DynamixelPeer::Servo& servo, const RigJoint& joint) const {
    const auto same = [&joint](const auto& each) { return each.first == joint.motor.model; };
    const auto found = std::ranges::find_if(dynamixel_models, same);
    if (found == dynamixel_models.end()) return false;
    servo.model_number = found->second;
    return true;
  }
  [[nodiscard]] static Error refuse(const RigJoint& joint) {
    std::string all;
    for (const auto& [name, number] : dynamixel_models) all += (all.empty() ? "" : ", ") + std::string(name);
    return not_emulated(joint, all);
  }
};

struct SetFeetech {
  bool operator()(FeetechPeer::Servo& servo, const RigJoint& joint) const {
    servo.make = value_of<emulation::feetech::Make>(joint.motor.model);
    return knows<emulation::feetech::Make>(joint.motor.model);
  }
  [[nodiscard]] static Error refuse(const RigJoint& joint) {
    return not_emulated(joint, listed<emulation::feetech::Make>());
  }
};

/// Where each joint starts: at 0, or in the middle of the range that both sides share where 0 is not well inside.
Starts starts_of(const devices::RigPair& pair) {
  Starts starts;
  const auto& joints = (pair.leader ? pair.leader : pair.follower)->joints;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    double lower = joints[i].joint.lower_rad, upper = joints[i].joint.upper_rad;
    if (pair.leader && pair.follower) {
      lower = std::max(lower, pair.follower->joints[i].joint.lower_rad);
      upper = std::min(upper, pair.follower->joints[i].joint.upper_rad);
    }
    constexpr double margin_share = 0.1;
    const double margin = margin_share * (upper - lower);
    starts.push_back(lower + margin < 0.0 && upper - margin > 0.0 ? 0.0 : 0.5 * (lower + upper));
  }
  return starts;
}

Result<std::unique_ptr<emulation::damiao::Mechanism>> wired_arm(const station::DescribedArm& arm, const RigSide& side,
                                                                bool leads, const Rehearsal& rehearsal) {
  real_time::EmulatedArm::Settings settings{.chain = arm.arm.chain, .held_at = arm.start, .tool_m = arm.arm.tool_m};
  if (leads && rehearsal.tapping) {
    settings.tapping = rehearsal.tapping;
  } else if (leads) {
    settings.led = {.reach_rad = rehearsal.led_reach_rad, .after_s = rehearsal.led_after_s};
  } else {
    settings.surface = rehearsal.surface;
  }
  auto made = real_time::EmulatedArm::make(settings);
  if (!made) return made.error();
  return std::unique_ptr<emulation::damiao::Mechanism>(std::make_unique<WiredArm>(*std::move(made), side));
}

/// The faults of each side, without the words that name it.
Result<std::array<std::vector<std::string>, 2>> faults_by_side(const std::vector<std::string>& words) {
  std::array<std::vector<std::string>, 2> faults;
  for (const std::string& word : words) {
    const auto colon = word.find(':');
    const std::string side = word.substr(0, colon);
    if (colon == std::string::npos || (side != "leader" && side != "follower")) {
      return Error{.code = ErrorCode::syntax,
                   .parameter = {},
                   .message = "'" + report::printable(word) +
                              "' names no side: write leader:FAULT or follower:FAULT, such as follower:silence:2@5",
                   .place = "--fault"};
    }
    faults[side == "leader" ? 0 : 1].push_back(word.substr(colon + 1));
  }
  return faults;
}

}  // namespace

/// The motors of a side, and the thread that drives their end of the line.
class EmulatedRig::Side {
 public:
  static Result<std::unique_ptr<Side>> start(EmulatedPeer peer) {
    auto port = wire::Port::pseudo_terminal();
    if (!port) return port.error();
    std::unique_ptr<Side> made(new Side(std::move(peer), *std::move(port)));
    auto thread = start_quiet_thread([self = made.get()] {
      // A pseudo-terminal of this program stays open until this thread has ended.
      static_cast<void>(wire::talk(*self->peer_->line, *self->port_, [self] { return self->ending_.load(); }));
    });
    if (!thread) return thread.error();
    made->thread_ = *std::move(thread);
    made->path_ = made->port_->path();
    return made;
  }
  static Result<std::unique_ptr<Side>> start_service() {
    auto server = emulation::inverse3::Inverse3Server::start({}, 0);
    if (!server) return server.error();
    std::unique_ptr<Side> made(new Side(*std::move(server)));
    made->path_ = "127.0.0.1:" + std::to_string(made->server_->port());
    return made;
  }
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;
  ~Side() {
    ending_.store(true);
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  Side(EmulatedPeer peer, wire::Port port) : peer_(std::move(peer)), port_(std::move(port)) {}
  explicit Side(emulation::inverse3::Inverse3Server server) { server_.emplace(std::move(server)); }

  std::optional<EmulatedPeer> peer_;
  std::optional<wire::Port> port_;
  std::optional<emulation::inverse3::Inverse3Server> server_;
  std::string path_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

EmulatedRig::EmulatedRig() = default;
EmulatedRig::EmulatedRig(EmulatedRig&&) noexcept = default;
EmulatedRig::~EmulatedRig() = default;

Result<EmulatedRig> EmulatedRig::start(const devices::Rig& rig, devices::RigPair& pair, std::optional<SiteRole> only,
                                       const station::DescribedArms* arms, const Rehearsal& rehearsal) {
  const auto faults = faults_by_side(rehearsal.faults);
  if (!faults) return faults.error();
  const Starts starts = starts_of(pair);
  EmulatedRig made;
  for (const bool leads : {true, false}) {
    auto& stated = leads ? pair.leader : pair.follower;
    if (!stated || (only && (*only == SiteRole::master) != leads)) continue;
    RigSide& side = *stated;
    const auto& wrong = (*faults)[leads ? 0 : 1];
    std::unique_ptr<emulation::damiao::Mechanism> arm;
    if (arms != nullptr) {
      auto wired = wired_arm(leads ? arms->leader : arms->follower, side, leads, rehearsal);
      if (!wired) return wired.error();
      arm = *std::move(wired);
    }
    Result<std::unique_ptr<Side>> started = std::unique_ptr<Side>();
    const auto begin = [&started](Result<EmulatedPeer> peer) {
      started = peer ? Side::start(*std::move(peer)) : Result<std::unique_ptr<Side>>(peer.error());
    };
    switch (side.bus.kind) {
      case BusKind::damiao:
        begin(damiao_peer(side, starts, wrong, std::move(arm)));
        break;
      case BusKind::dynamixel:
        begin(servo_peer<DynamixelPeer>(side, starts, wrong, SetDynamixel{}));
        break;
      case BusKind::feetech:
        begin(servo_peer<FeetechPeer>(side, starts, wrong, SetFeetech{}));
        break;
      case BusKind::inverse3:
        started = wrong.empty() ? Side::start_service()
                                : Error{.code = ErrorCode::inconsistent,
                                        .parameter = {},
                                        .message = "an emulated Inverse3 has no faults to inject: leave out '" +
                                                   report::printable(wrong.front()) + "' of " + side.path,
                                        .place = "--fault"};
        break;
      case BusKind::plugged:
        started = Error{.code = ErrorCode::inconsistent,
                        .parameter = join(side.path, "bus"),
                        .message = "'" + report::printable(side.bus.driver) +
                                   "' is a driver of your own, and tactus has no emulated motors for it: rehearse with "
                                   "a rig file that states damiao, dynamixel, feetech or inverse3",
                        .place = {}};
        break;
    }
    if (!started) return started.error().parameter.empty() ? started.error() : rig.locate(started.error());
    made.description_ += side.path + ": " + std::to_string(side.joints.size()) + " emulated " +
                         std::string(bus_name(side.bus)) + (side.joints.size() == 1 ? " motor" : " motors") + " at " +
                         (*started)->path() + ", in place of " + report::printable(side.bus.port) + "\n";
    side.bus.port = (*started)->path();
    made.sides_.push_back(*std::move(started));
  }
  return made;
}

}  // namespace tactus::cli
