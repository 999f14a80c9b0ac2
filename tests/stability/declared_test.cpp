// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/declared.hpp>
#include <tactus/analysis/stability/loop.hpp>
#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/analysis/stability/margins.hpp>
#include <tactus/analysis/stability/scorecard.hpp>
#include <tactus/analysis/stability/two_port.hpp>
#include <tactus/analysis/stability/uncertainty.hpp>

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tests/stability/linear_rig.hpp>

namespace tactus::stability {
namespace declared_test {

/// A stage that says nothing of itself.
struct Silent {
  struct Params {
    double gain = 1.0;
    static constexpr auto fields() {
      return List{field("gain", &Params::gain, units::none, positive, "What it multiplies by.")};
    }
  };
};

/// One that is linear and, unless its gain is 1, not on lanes.
struct Declared : Silent {
  static constexpr int linear_states = 0;
  static constexpr std::optional<control::Unfit> not_on_lanes(const Params& params) {
    if (params.gain == 1.0) return {};
    return control::Unfit{"gain", "write 1"};
  }
};

std::string refusal_of(const Check& refused) { return refused ? describe(*refused) : "none"; }

const auto below_shaper = [](std::string_view own) { return join("shaper", own); };

TEST(Declared, AStageThatSaysNothingIsRefusedByNameOnOrOff) {
  EXPECT_EQ(refusal_of(check_stage<Silent>(Analysis::linear, {}, below_shaper)),
            "control.shaper: has not declared whether it is linear: declare it in its class as "
            "tactus/kernel/control/stages/stage.hpp describes, or use `tactus run`");
  EXPECT_EQ(refusal_of(check_stage<Silent>(Analysis::lanes, {}, below_shaper)),
            "control.shaper: has not declared whether it runs on lanes: declare it in its class as "
            "tactus/kernel/control/stages/stage.hpp describes, or use `tactus run`");
}

TEST(Declared, AStageIsTakenAtItsWord) {
  for (const double gain : {1.0, 2.0}) {
    EXPECT_EQ(refusal_of(check_stage<Declared>(Analysis::linear, {.gain = gain}, below_shaper)), "none");
  }
  EXPECT_EQ(refusal_of(check_stage<Declared>(Analysis::lanes, {.gain = 1.0}, below_shaper)), "none");
  EXPECT_EQ(
      refusal_of(check_stage<Declared>(Analysis::lanes, {.gain = 2.0}, below_shaper)),
      "control.shaper.gain: asks for something that the loop of a map does not have: write 1, or use `tactus run` "
      "with an experiment of kind tapping");
}

/// What each of those that judge a loop says of `params`.
std::vector<std::string> refused_keys(const simulation::Teleoperator::Params& params) {
  const auto key_of = [](const auto& result) { return result ? std::string("none") : result.error().parameter; };
  MapParams point;
  static_cast<simulation::Teleoperator::Params&>(point) = params;
  point.environment.law = mechanics::ContactLaw::kelvin_voigt;
  return {key_of(make_loop(params)), key_of(TwoPort::make(params)), key_of(score(params, {}, {})),
          key_of(uncertain_limit(params, {}, 0.1)), key_of(make_point(point))};
}

/// Sites of position-force under a name, as somebody registers them who plugs in; position-force is itself again after.
class Plugged {
 public:
  Plugged(const char* name, control::Likeness likeness) {
    control::Architecture plugged = original_;
    plugged.name = name;
    plugged.like_position_force = likeness;
    EXPECT_FALSE(control::register_architecture(plugged));
  }
  ~Plugged() { EXPECT_FALSE(control::register_architecture(original_)); }

 private:
  control::Architecture original_ = *control::find_architecture("position-force");
};

TEST(Declared, AnArchitectureThatSaysNothingIsRefusedByName) {
  const Plugged plugged("plugged", control::Likeness::unknown);
  simulation::Teleoperator::Params params = linear_rig();
  params.control.architecture = "plugged";
  EXPECT_EQ(refused_keys(params), std::vector<std::string>(5, "control.architecture"));
}

TEST(Declared, AnArchitectureInThePlaceOfPositionForceIsNotTakenForIt) {
  const simulation::Teleoperator::Params params = linear_rig();
  EXPECT_EQ(refused_keys(params), std::vector<std::string>(5, "none"));
  const Plugged plugged("position-force", control::Likeness::unknown);
  EXPECT_EQ(refused_keys(params), std::vector<std::string>(5, "control.architecture"));
}

TEST(Declared, AnArchitectureThatIsPositionForceAboutRestHasItsMarginsAndNoMap) {
  const Plugged plugged("plugged", control::Likeness::about_rest);
  simulation::Teleoperator::Params params = linear_rig();
  const double limit = gain_limit(*make_loop(params)).force_gain;
  params.control.architecture = "plugged";
  EXPECT_EQ(refused_keys(params), (std::vector<std::string>{"none", "none", "none", "none", "control.architecture"}));
  EXPECT_EQ(gain_limit(*make_loop(params)).force_gain, limit);
}

TEST(Declared, WhatIsNotLinearOrNotOnLanesIsRefusedByItsKey) {
  struct Stage {
    std::string key;
    bool linear;
    std::function<void(control::ControlParams&)> switch_on;
  };
  const std::vector<Stage> stages{
      {"slave_force.source", false, [](auto& c) { c.slave_force.source = control::SlaveForceSource::kalman; }},
      {"operator_estimate", false, [](auto& c) { c.operator_estimate = control::OperatorEstimate::online; }},
      {"operator_estimate", true, [](auto& c) { c.operator_estimate = control::OperatorEstimate::scheduled; }},
      {"cancellation_step", true, [](auto& c) { c.cancellation_step = control::CancellationStep::euler; }},
      {"hand_compensation_Hz", true, [](auto& c) { c.hand_compensation_Hz = 100.0; }},
      {"damping.damping_N_s_per_m", true, [](auto& c) { c.damping.damping_N_s_per_m = 1.0; }},
      {"command_filter.kind", true, [](auto& c) { c.command_filter.kind = control::Shaping::low_pass; }},
      {"force_filter.kind", true, [](auto& c) { c.force_filter.kind = control::Shaping::notch; }},
      {"crossover.frequency_Hz", true, [](auto& c) { c.crossover.frequency_Hz = 60.0; }},
  };
  for (const Stage& stage : stages) {
    control::ControlParams control;
    EXPECT_EQ(refusal_of(check_declared(control, Analysis::lanes)), "none");
    stage.switch_on(control);
    const Check off_lanes = check_declared(control, Analysis::lanes);
    ASSERT_TRUE(off_lanes) << stage.key;
    EXPECT_EQ(off_lanes->parameter, "control." + stage.key);
    EXPECT_NE(off_lanes->message.find("the loop of a map does not have"), std::string::npos) << off_lanes->message;
    const Check nonlinear = check_declared(control, Analysis::linear);
    EXPECT_EQ(nonlinear ? nonlinear->parameter : "none", stage.linear ? "none" : "control." + stage.key);
  }
}

}  // namespace declared_test
}  // namespace tactus::stability
