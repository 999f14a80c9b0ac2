// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/rig/bus_kinds.hpp>
#include <tactus/hardware/devices/rig/examination.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/control/protective_limits.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

/// Every joint of every rig that is shipped, behind the gates that it runs with: what a wrong encoder may do there.
namespace tactus::devices {
namespace rig_checks_test {

using control::GateFault;
using control::SafetyGate;

const std::string rigs = TACTUS_RIG_FOLDER;
constexpr double tick_s = 0.002;

int seeds() {
  const char* asked = std::getenv("TACTUS_MOTION_SEEDS");
  return asked != nullptr ? std::max(1, std::atoi(asked)) : 4;
}

struct Gates {
  SafetyGate::Params leader, follower;
};

template <class Params>
Params read(const std::string& file) {
  const auto document = configuration::Document::load(rigs + "/" + file);
  EXPECT_TRUE(document) << describe(document.error());
  const auto params = document->template read<Params>();
  EXPECT_TRUE(params) << describe(params.error());
  return *params;
}
Gates gates_of_axes(const std::string& file) {
  const auto params = read<experiments::TappingParams>(file);
  return {params.control.gate, params.control.slave_gate};
}
Gates gates_of_arms(const std::string& file) {
  const auto params = read<experiments::ArmTappingParams>(file);
  return {params.rig.leader_gate, params.rig.follower_gate};
}

/// A rig and the experiment that its page drives it by.
struct Shipped {
  std::string rig, experiment;
  Gates gates;
};
std::vector<Shipped> shipped() {
  const Gates joints = gates_of_axes("joints.toml");
  return {{"so101.toml", "joints.toml", joints},
          {"gello.toml", "joints.toml", joints},
          {"openarm.toml", "joints.toml", joints},
          {"yam.toml", "joints.toml", joints},
          {"inverse3.toml", "axes.toml", gates_of_axes("axes.toml")},
          {"openarm-arms.toml", "arms.toml", gates_of_arms("arms.toml")}};
}

/// Calls `look` with each joint of each rig, its gate within its limits, and where it is.
template <class Look>
void for_each_joint_of_all(Look look) {
  int seen = 0;
  for (const Shipped& one : shipped()) {
    const auto rig = Rig::load(rigs + "/" + one.rig);
    ASSERT_TRUE(rig) << describe(rig.error());
    for (const RigPair& pair : rig->pairs()) {
      for (const auto& [side, gate] : {std::pair{pair.leader, one.gates.leader}, {pair.follower, one.gates.follower}}) {
        for (const RigJoint& joint : side->joints) {
          look(joint, station::tightened(gate, joint.joint.limits()), one.rig + " " + joint.path);
          ++seen;
        }
      }
    }
  }
  EXPECT_GE(seen, 70) << "all of them";
}

TEST(RigChecks, OfEveryJointOfEveryShippedRigEveryCheckCanBeReachedAndJudgesTheReportedVelocity) {
  for_each_joint_of_all([](const RigJoint& joint, const SafetyGate::Params& gate, const std::string& where) {
    const Check error = control::refuse_unreachable(gate, "gate");
    EXPECT_FALSE(error) << where << ": " << describe(*error);
    EXPECT_GT(gate.motion.velocity_step_m_per_s, 0.0) << where;
    if (!joint.joint.gives_force) return;
    EXPECT_LE(gate.encoder.frozen_force_N, 1.5 * gate.force_limit_N) << where;
  });
}

/// `tactus run` refuses what this refuses, and `tactus device check` reports it.
TEST(RigChecks, EveryShippedRigCanBeDrivenAndOfAllModelsThoseWithoutForceCanOnlyLead) {
  for_each_joint_of_all([](const RigJoint& joint, const SafetyGate::Params&, const std::string& where) {
    RigSide side;
    side.path = joint.path.substr(0, joint.path.rfind('.'));
    EXPECT_FALSE(refuse_undrivable(side, joint)) << where;
  });
  int models = 0;
  for (const BusKind kind : {BusKind::damiao, BusKind::dynamixel, BusKind::feetech}) {
    for (const std::string& model : models_of(kind)) {
      const bool forceless = kind == BusKind::feetech && model.starts_with("sts");
      const std::string bus = "bus = \"" + std::string(name_of(kind)) + "\"\nport = \"/dev/";
      std::string text;
      for (const std::string side : {"arm.leader", "arm.follower"}) {
        text += "[" + side + "]\n" + bus + side + "\"\n[" + side + ".elbow]\nmotor = 1\nmodel = \"" + model +
                "\"\nlower_rad = -1.5\nupper_rad = 1.5\nvelocity_limit_rad_per_s = 3.0\ntorque_limit_Nm = 0.01\n"
                "torque_rate_limit_Nm_per_s = 50.0\n" +
                (kind == BusKind::feetech && !forceless ? "torque_Nm_per_A = 0.8\n" : "");
      }
      const auto rig = Rig::parse(text, "rig.toml");
      ASSERT_TRUE(rig) << model << ": " << describe(rig.error());
      const RigPair& pair = rig->pairs().front();
      EXPECT_FALSE(refuse_undrivable(*pair.leader, pair.leader->joints.front())) << model << " leads";
      const Check follows = refuse_undrivable(*pair.follower, pair.follower->joints.front());
      EXPECT_EQ(follows.has_value(), forceless) << model;
      if (follows) {
        EXPECT_EQ(follows->parameter, "arm.follower.elbow.model");
      }
      ++models;
    }
  }
  EXPECT_GE(models, 10);
}

enum class Fault { none, all_frozen, frozen, half, twice, reversed, late };

/// A joint under a servo that follows a target, and its drive; all in the joint's unit.
class Driven {
 public:
  Driven(const RigJoint& joint, const SafetyGate::Params& params, Fault fault, std::uint64_t seed)
      : fault_(fault),
        random_(signal::Random(seed).fork(static_cast<std::uint64_t>(fault))),
        scale_(joint.slides ? 0.2 : 1.0),
        most_N_(params.force_limit_N),
        velocity_limit_(joint.joint.velocity_limit_rad_per_s),
        velocity_step_(params.motion.velocity_step_m_per_s),
        position_step_(scale_ * (joint.slides ? 5e-4 : 1.5e-3)),
        // Full force accelerates by 80 rad/s², and half a radian of distance asks for it.
        mass_(most_N_ / (80.0 * scale_)),
        stiffness_(most_N_ / (0.5 * scale_)),
        damping_(1.4 * std::sqrt(stiffness_ * mass_)),
        begins_s_(random_.uniform(0.5, 2.5)),
        reach_(std::min(scale_ * random_.uniform(0.5, 0.9), 0.7 * params.position_limit_m)),
        late_s_(random_.uniform(0.2, 0.4)),
        pause_s_(random_.uniform(0.0, 0.6)),
        gate_(SafetyGate::make(params, Seconds{tick_s}).value()) {}

  /// Whether the joint was released within `duration_s`.
  bool run(double duration_s) {
    for (now_s_ = 0.0; now_s_ < duration_s; now_s_ += tick_s) {
      if (now_s_ >= begins_s_ && !std::exchange(begun_, true)) at_ = position_;
      read();
      gate_.believe(read_.position, 1, std::nullopt, 0.0, {.velocity_m_per_s = read_.velocity, .force_N = read_.force});
      const double given = gate_.pass(stiffness_ * (target() - read_.position) - damping_ * read_.velocity);
      // The device takes the power of a joint that reports to be too fast.
      if (gate_.fault() != GateFault::none || std::fabs(read_.velocity) > velocity_limit_) return true;
      given_ = given;
      for (int i = 0; i < 10; ++i) {
        velocity_ += 0.1 * tick_s / mass_ * (given_ - 0.3 * damping_ * velocity_);
        position_ += 0.1 * tick_s * velocity_;
      }
      if (begun_) travelled_ = std::max(travelled_, std::fabs(position_ - at_) / scale_);
    }
    return false;
  }
  /// Since the fault began, in rad; of an axis, of the lever of 0.2 m.
  [[nodiscard]] double travelled_rad() const { return travelled_; }
  [[nodiscard]] GateFault fault() const { return gate_.fault(); }
  [[nodiscard]] bool begun() const { return begun_; }

 private:
  struct Read {
    double position = 0.0, velocity = 0.0, force = 0.0;
  };
  /// There and back, with a rest at each end.
  [[nodiscard]] double target() const {
    const double period_s = 2.4 + 2.0 * pause_s_, at_s = std::fmod(now_s_, period_s);
    const auto smooth = [](double share) { return share * share * share * (10.0 + share * (6.0 * share - 15.0)); };
    if (at_s < 1.2) return reach_ * smooth(at_s / 1.2);
    if (at_s < 1.2 + pause_s_) return reach_;
    if (at_s < 2.4 + pause_s_) return reach_ * (1.0 - smooth((at_s - 1.2 - pause_s_) / 1.2));
    return 0.0;
  }
  void read() {
    history_.push_back(position_);
    const double noise = random_.uniform() < 0.2 ? (random_.uniform() < 0.5 ? 1.0 : -1.0) : 0.0;
    const Read now{
        .position = position_step_ * (std::round(position_ / position_step_) + noise),
        .velocity = velocity_step_ * std::round((velocity_ + 0.01 * scale_ * random_.normal()) / velocity_step_),
        .force = 0.01 * most_N_ * std::round(given_ / (0.01 * most_N_) + 0.5 * random_.normal())};
    if (begun_ && fault_ == Fault::all_frozen) return;
    const double before = read_.position;
    read_ = now;
    if (!begun_) return;
    const double moved = position_ - at_;
    if (fault_ == Fault::frozen) read_.position = before;
    if (fault_ == Fault::half) read_.position = at_ + 0.5 * moved;
    if (fault_ == Fault::twice) read_.position = at_ + 2.0 * moved;
    if (fault_ == Fault::reversed) read_.position = at_ - moved;
    if (fault_ == Fault::late) {
      const auto lag = static_cast<std::size_t>(std::min(late_s_, now_s_ - begins_s_) / tick_s);
      read_.position = history_[history_.size() - 1 - std::min(lag, history_.size() - 1)];
    }
  }

  Fault fault_;
  signal::Random random_;
  double scale_, most_N_, velocity_limit_, velocity_step_, position_step_, mass_, stiffness_, damping_;
  double begins_s_, reach_, late_s_, pause_s_;
  SafetyGate gate_;
  double now_s_ = 0.0, position_ = 0.0, velocity_ = 0.0, given_ = 0.0, at_ = 0.0, travelled_ = 0.0;
  bool begun_ = false;
  Read read_;
  std::vector<double> history_;
};

TEST(RigChecks, OfEveryDrivenJointOfEveryShippedRigAWrongPositionIsReleasedWithinAFifthOfARadian) {
  for_each_joint_of_all([](const RigJoint& joint, const SafetyGate::Params& gate, const std::string& where) {
    if (!joint.joint.gives_force) return;
    for (const Fault fault :
         {Fault::all_frozen, Fault::frozen, Fault::half, Fault::twice, Fault::reversed, Fault::late}) {
      for (int seed = 1; seed <= seeds(); ++seed) {
        Driven driven(joint, gate, fault, static_cast<std::uint64_t>(seed));
        const bool released = driven.run(12.0);
        EXPECT_TRUE(driven.begun()) << where << ": " << name_of(driven.fault()) << " before the fault";
        EXPECT_TRUE(released) << where << ", fault " << static_cast<int>(fault) << ", seed " << seed;
        EXPECT_LT(driven.travelled_rad(), 0.2)
            << where << ", fault " << static_cast<int>(fault) << ", seed " << seed << ": " << name_of(driven.fault());
      }
    }
  });
}

TEST(RigChecks, OfEveryJointOfEveryShippedRigATrueEncoderTripsNothing) {
  double hours = 0.0;
  for_each_joint_of_all([&hours](const RigJoint& joint, const SafetyGate::Params& gate, const std::string& where) {
    if (!joint.joint.gives_force) return;
    Driven driven(joint, gate, Fault::none, 1);
    EXPECT_FALSE(driven.run(50.0)) << where << ": " << name_of(driven.fault());
    hours += 50.0 / 3600.0;
  });
  EXPECT_GT(hours, 0.9);
}

TEST(RigChecks, AThresholdAboveTheLimitOfAJointIsRefusedWithBothKeysAndValues) {
  const auto rig = Rig::load(rigs + "/so101.toml");
  ASSERT_TRUE(rig);
  SafetyGate::Params gate = gates_of_axes("joints.toml").follower;
  gate.encoder.frozen_force_N = 5.0;
  const RigJoint& joint = rig->pairs()[0].follower->joints[0];
  const Check error = control::refuse_unreachable(station::tightened(gate, joint.joint.limits()), "slave_gate");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->parameter, "slave_gate.encoder.frozen_force_N");
  EXPECT_EQ(error->message,
            "5 N can never be reached: the motor gives at most 1.5 N by slave_gate.force_limit_N or the limit of its "
            "device, whichever is lower; write at most 3 N");
}

}  // namespace rig_checks_test
}  // namespace tactus::devices
