// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/polled_arm.hpp>

#include <algorithm>
#include <string>

namespace tactus::arm_plants {
namespace {

constexpr int most_ticks = 1000;

Error refused(ErrorCode code, const char* key, std::string why) {
  return {.code = code, .parameter = key, .message = std::move(why), .place = {}};
}

/// Chance that a joint which is heard is not heard at the next tick.
double falls_silent(double lost_share, double outage_ticks) noexcept {
  return lost_share / ((1.0 - lost_share) * outage_ticks);
}

Check check(const PolledArm::Params& params, std::size_t joints) {
  if (params.answer_ticks < 1 || params.answer_ticks > most_ticks) {
    return refused(ErrorCode::out_of_bounds, "answer_ticks",
                   std::to_string(params.answer_ticks) + ": must be 1 to " + std::to_string(most_ticks));
  }
  if (!(params.outage_ticks >= 1.0)) {
    return refused(ErrorCode::out_of_bounds, "outage_ticks",
                   "must be 1 or more: an outage lasts at least one control cycle");
  }
  if (params.lost_share.size() == 0) return {};
  if (params.lost_share.size() != joints) {
    return refused(ErrorCode::inconsistent, "lost_share", "write one for each joint, or none");
  }
  for (const double share : params.lost_share) {
    if (!(share >= 0.0 && share < 1.0)) {
      return refused(ErrorCode::out_of_bounds, "lost_share", "must be 0 to below 1 for each joint");
    }
    if (falls_silent(share, params.outage_ticks) > 1.0) {
      return refused(ErrorCode::out_of_bounds, "outage_ticks",
                     "so short outages cannot make up so large a share: make them longer");
    }
  }
  return {};
}

}  // namespace

PolledArm::PolledArm(const Params& params, ArmPlant plant, double now_s, int joints)
    : plant_(std::move(plant)),
      lost_share_(params.lost_share),
      outage_ticks_(params.outage_ticks),
      random_(params.seed),
      silent_(static_cast<std::size_t>(joints), false),
      acting_(ArmCommand::of_torque(JointVector::Zero(joints))),
      known_{.reading = plant_.read(), .at_s = JointVector::Constant(joints, now_s)},
      on_the_way_(static_cast<std::size_t>(params.answer_ticks - 1),
                  Answers{.told = known_, .heard = Joints<bool>(static_cast<std::size_t>(joints), true)}) {
  if (lost_share_.size() == 0) lost_share_ = Joints<double>(static_cast<std::size_t>(joints), 0.0);
}

Result<PolledArm> PolledArm::make(const Params& params, ArmPlant plant, double now_s) {
  const auto joints = static_cast<int>(plant.read().position.size());
  if (Check wrong = check(params, static_cast<std::size_t>(joints))) return *std::move(wrong);
  return PolledArm(params, std::move(plant), now_s, joints);
}

void PolledArm::take(const Answers& answers) {
  for (std::size_t i = 0; i < answers.heard.size(); ++i) {
    if (!answers.heard[i]) continue;
    const auto joint = static_cast<Eigen::Index>(i);
    known_.reading.position[joint] = answers.told.reading.position[joint];
    known_.reading.velocity[joint] = answers.told.reading.velocity[joint];
    known_.reading.torque[joint] = answers.told.reading.torque[joint];
    known_.at_s[joint] = answers.told.at_s[joint];
  }
}

void PolledArm::tick(const ArmCommand& command, double now_s) {
  Answers answers{.told = {.reading = plant_.read(), .at_s = JointVector::Constant(acting_.torque.size(), now_s)},
                  .heard = Joints<bool>(silent_.size(), true)};
  for (std::size_t i = 0; i < silent_.size(); ++i) {
    if (lost_share_[i] > 0.0) {
      const double changes = silent_[i] ? 1.0 / outage_ticks_ : falls_silent(lost_share_[i], outage_ticks_);
      if (random_.uniform() < changes) silent_[i] = !silent_[i];
    }
    answers.heard[i] = !silent_[i];
    if (silent_[i]) continue;
    const auto joint = static_cast<Eigen::Index>(i);
    acting_.position[joint] = command.position[joint];
    acting_.velocity[joint] = command.velocity[joint];
    acting_.stiffness[joint] = command.stiffness[joint];
    acting_.damping[joint] = command.damping[joint];
    acting_.torque[joint] = command.torque[joint];
  }
  plant_.write(acting_);
  if (on_the_way_.empty()) {
    take(answers);
    return;
  }
  std::swap(answers, on_the_way_[next_]);
  next_ = next_ + 1 == on_the_way_.size() ? 0 : next_ + 1;
  take(answers);
}

}  // namespace tactus::arm_plants
