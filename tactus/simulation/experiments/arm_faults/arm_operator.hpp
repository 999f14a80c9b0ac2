// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/faults/fault_operator.hpp>
#include <tactus/simulation/experiments/faults/faulty_operator.hpp>

#include <algorithm>

namespace tactus::experiments {

/// The way on which a tool is led: a part of a straight line.
struct ArmWay {
  arm::Vector3 from_m;
  arm::Vector3 to_m;

  /// How far a tool is off it.
  [[nodiscard]] double apart_m(const arm::Vector3& tool_m) const {
    const arm::Vector3 along = to_m - from_m;
    const double share = std::clamp((tool_m - from_m).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return (tool_m - from_m - share * along).norm();
  }
};

/// The operator of a run at the leader's tool: the path and the buttons of `FaultOperator`, led by a hand in three
/// dimensions. While motors are tried the hand stays where it is.
class ArmFaultOperator {
 public:
  ArmFaultOperator(const ArmFaultBench& bench, const FaultPlan& plan)
      : planned_(plan, wall_from_start_m, true),
        params_(bench.setup.params.person),
        tick_{bench.tick_s()},
        person_(*arm_plants::ToolOperator::make(params_, tick_, bench.leader.plant().tool())),
        outward_(bench.setup.outward),
        scale_(bench.setup.tool_scale),
        rests_(is_wired_so(plan)),
        began_m_(planned_.path_m(0.0)),
        leader_began_m_(bench.leader.plant().tool().position_m),
        follower_began_m_(bench.follower.plant().tool().position_m),
        wall_{.point_m = follower_at(planned_.wall_m()),
              .normal = outward_,
              .contact = *mechanics::Environment::make(bench.setup.params.wall.environment(), tick_)} {}

  /// What the follower's tool meets, as nothing has touched it yet.
  [[nodiscard]] const arm_plants::Wall& wall() const { return wall_; }
  [[nodiscard]] ArmWay leader_way() const {
    return {leader_at(planned_.wall_m() - planned_.depth_m()), leader_at(planned_.wall_m() + planned_.depth_m())};
  }
  [[nodiscard]] ArmWay follower_way() const {
    return {follower_at(planned_.wall_m() - planned_.depth_m()), follower_at(planned_.wall_m() + planned_.depth_m())};
  }

  /// One tick. A hand that comes back takes the tool where it is, and leads it back to its path.
  void begin_tick(const FaultMoment& moment, double tick_s, bool lets_go, const arm_plants::ToolState& tool) {
    const double now_s = moment.now_s;
    if (!lets_go && away_) {
      person_ = *arm_plants::ToolOperator::make(params_, tick_, tool);
      off_m_ = tool.position_m - meant_m(now_s);
      returns_ = FaultyOperator::returns_from(1.0, now_s);
    }
    away_ = lets_go;
    felt_N_ = away_ ? 0.0 : person_.force(tool, 0.0).force_N.norm();
    const auto aim_m = [&](double time_s) {
      return arm::Vector3(meant_m(time_s) + returns_.position_m(time_s) * off_m_);
    };
    person_.begin_tick(aim_m(now_s), aim_m(now_s + tick_s), tool);
  }
  /// What the hand does to the tool, so long after the tick began.
  [[nodiscard]] arm_plants::ToolForce force(const arm_plants::ToolState& tool, double since_tick_s) const {
    return away_ ? arm_plants::ToolForce{} : person_.force(tool, since_tick_s);
  }
  /// Between hand and tool, at the latest tick.
  [[nodiscard]] double hand_N() const { return felt_N_; }

 private:
  /// Beyond the deepest that the operator goes, so that the tool starts before the wall.
  static constexpr double wall_from_start_m = 0.02;

  [[nodiscard]] arm::Vector3 leader_at(double path_m) const {
    return leader_began_m_ - (path_m - began_m_) / scale_ * outward_;
  }
  [[nodiscard]] arm::Vector3 follower_at(double path_m) const {
    return follower_began_m_ - (path_m - began_m_) * outward_;
  }
  [[nodiscard]] arm::Vector3 meant_m(double time_s) const {
    return leader_at(rests_ ? began_m_ : planned_.path_m(time_s));
  }

  FaultOperator planned_;
  arm_plants::ToolOperator::Params params_;
  Seconds tick_;
  arm_plants::ToolOperator person_;
  arm::Vector3 outward_;
  double scale_;
  bool rests_;
  double began_m_;
  arm::Vector3 leader_began_m_, follower_began_m_;
  arm_plants::Wall wall_;
  bool away_ = false;
  double felt_N_ = 0.0;
  arm::Vector3 off_m_ = arm::Vector3::Zero();  ///< of the path, where the hand took the tool again
  mechanics::MinimumJerk returns_{};           ///< the share of that which is left
};

}  // namespace tactus::experiments
