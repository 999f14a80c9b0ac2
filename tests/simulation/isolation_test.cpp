// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/cancellation_model.hpp>
#include <tactus/identification/axis/isolation.hpp>
#include <tactus/identification/axis/isolation_figures.hpp>
#include <tactus/simulation/teleoperator/simulated_rig.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace isolation_test {

using identification::FoundParameter;
using identification::Isolation;

identification::IsolationParams in_short(double held_sweep_s) {
  identification::IsolationParams params;
  params.sweep_s = 1.0;
  params.held_sweep_s = held_sweep_s;
  return params;
}

const FoundParameter& named(const Isolation& isolation, const std::string& name) {
  return *std::find_if(isolation.parameters.begin(), isolation.parameters.end(),
                       [&](const FoundParameter& parameter) { return parameter.name == name; });
}

TEST(Isolation, AShortIsolationFindsADrawnRig) {
  auto rig = SimulatedRig::make(draw_rig(1001)).value();
  double last = -1.0;
  const auto isolation = identification::isolate(rig, in_short(25.0), [&last](const std::string&, double done) {
    EXPECT_GE(done, last);
    last = done;
  });
  ASSERT_TRUE(isolation) << describe(isolation.error());
  int inside = 0, known = 0;
  for (const FoundParameter& parameter : isolation->parameters) {
    const auto truth = rig.truth(parameter.name);
    if (!truth || !parameter.determined) continue;
    ++known;
    inside += *truth >= parameter.interval_95[0] && *truth <= parameter.interval_95[1] ? 1 : 0;
    const bool stiff = parameter.name.ends_with("mass_kg") || parameter.name.ends_with("stiffness_N_per_m");
    // The offset is a force of a few mN and may be none.
    const double asked = parameter.name == "amplifier.offset_N" ? 0.0005 : (stiff ? 0.03 : 0.1) * *truth;
    EXPECT_NEAR(parameter.value, *truth, asked) << parameter.name;
  }
  EXPECT_GE(known, 15);
  EXPECT_GE(inside, known - 3);
  EXPECT_GE(figures(*isolation).size(), isolation->stages.size());
}

TEST(Isolation, TheLinkagesTinyDampingIsNotClaimed) {
  auto params = draw_rig(1002);
  params.benched.master.mechanism.linkage.damping_N_s_per_m = 0.002;
  auto rig = SimulatedRig::make(params).value();
  const auto isolation = identification::isolate(rig, in_short(2.0), {});
  ASSERT_TRUE(isolation) << describe(isolation.error());
  EXPECT_FALSE(named(*isolation, "linkage.damping_N_s_per_m").determined);
}

TEST(Isolation, ALinkageWithoutHysteresisIsFoundLinearAndItsLoopIsNotClaimed) {
  auto params = draw_rig(1005);
  params.benched.master.mechanism.linkage.hysteretic_fraction = 0.0;
  auto rig = SimulatedRig::make(params).value();
  const auto isolation = identification::isolate(rig, in_short(2.0), {});
  ASSERT_TRUE(isolation) << describe(isolation.error());
  EXPECT_FALSE(named(*isolation, "linkage.loop_area_J").determined);
  const double stiffness = named(*isolation, "linkage.stiffness_N_per_m").value;
  const double truth = rig.truth("linkage.stiffness_N_per_m").value();
  EXPECT_NEAR(stiffness, truth, 0.03 * truth);
  EXPECT_LT(isolation->found.master.linkage.hysteretic_fraction, 0.02);
}

/// A rig that stops after some runs.
class StoppingRig final : public identification::Rig {
 public:
  StoppingRig(SimulatedRig& rig, int runs) : rig_(rig), left_(runs) {}
  [[nodiscard]] std::string name() const override { return rig_.name(); }
  [[nodiscard]] double tick_s() const override { return rig_.tick_s(); }
  [[nodiscard]] identification::RigLimits limits() const override { return rig_.limits(); }
  Check assemble(identification::Assembly assembly) override { return rig_.assemble(assembly); }
  Result<identification::RigRun> run(const identification::MotorProgram& program) override {
    if (left_-- == 0) return Error{ErrorCode::failed, {}, "somebody pressed the button", {}};
    return rig_.run(program);
  }

 private:
  SimulatedRig& rig_;
  int left_;
};

TEST(Isolation, WhatTheRigRefusesEndsIt) {
  auto rig = SimulatedRig::make(draw_rig(1003)).value();
  StoppingRig stopping(rig, 3);
  const auto isolation = identification::isolate(stopping, in_short(2.0), {});
  ASSERT_FALSE(isolation);
  EXPECT_EQ(isolation.error().message, "somebody pressed the button");
}

TEST(CancellationModel, ItMovesUnderACommandedNewtonAsTheDeviceDoes) {
  identification::BenchParams found;
  found.amplifier_gain = 0.8;
  found.master.linkage.damping_N_s_per_m = -0.01;
  const auto model = identification::model_for_cancellation(found, 1.0, 2e-3);
  EXPECT_DOUBLE_EQ(model.motor.mass_kg, 0.0075 / 0.8);
  EXPECT_DOUBLE_EQ(model.drum.friction_N, 0.0144 / 0.8);
  EXPECT_DOUBLE_EQ(model.linkage.stiffness_N_per_m, 3950.0 / 0.8);
  EXPECT_DOUBLE_EQ(model.hand.damping_N_s_per_m, 23.0 / 0.8);
  EXPECT_EQ(model.linkage.damping_N_s_per_m, 0.0);
  EXPECT_DOUBLE_EQ(model.linkage.slip_deflection_m, found.master.linkage.slip_deflection_m);
  EXPECT_NEAR(model.hand.quintic_stiffness_N_per_m5, 3.125e13, 1.0);
}

TEST(CancellationModel, OnADeviceThatIsTheModelImpactsLeaveLittle) {
  SimulatedRigParams params;
  params.encoder_resolution_m = params.wander_rms_m = params.tremor_amplitude_m = 0.0;
  params.benched.master.amplifier.bandwidth_Hz = 1e5;
  params.benched.master.mechanism.linkage.hysteretic_fraction = 0.0;
  auto rig = SimulatedRig::make(params).value();
  control::MasterModel model;
  model.linkage.hysteretic_fraction = 0.0;
  model.hand.quintic_stiffness_N_per_m5 = 0.0;
  const auto exact = identification::check_on_impacts(rig, model, 1.0);
  ASSERT_TRUE(exact);
  EXPECT_LT(exact->residual, 0.04);
  model.linkage.stiffness_N_per_m *= 1.2;
  EXPECT_GT(identification::check_on_impacts(rig, model, 1.0)->residual, 0.1);
}

}  // namespace isolation_test
}  // namespace tactus::simulation
