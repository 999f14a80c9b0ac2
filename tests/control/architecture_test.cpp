// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/projection.hpp>
#include <tactus/kernel/control/architectures/shared_compliant.hpp>

#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>

namespace tactus::control {
namespace architecture_test {

constexpr Seconds tick{200e-6};

/// A site that answers with what the test says.
struct Scripted {
  double force_N = 0.0;
  MasterOutput respond(const MasterInput&) noexcept {
    MasterOutput output;
    output.motor_force_N = force_N;
    return output;
  }
  void reset() noexcept {}
};

struct Silent {
  SlaveOutput respond(const SlaveInput&) noexcept { return {}; }
  void reset() noexcept {}
};

Result<Controllers> make_scripted(const ControlParams& params, Seconds) {
  return Controllers{master_controller(Scripted{.force_N = params.force_gain}), slave_controller(Silent{})};
}

TEST(Architecture, OneRegistrationLineMakesAnArchitectureThatAFileCanName) {
  ASSERT_FALSE(register_architecture({"scripted", "answers with a constant force", make_scripted}));
  ControlParams params;
  params.architecture = "scripted";
  params.force_gain = 0.25;
  auto sites = make_sites(params, tick);
  ASSERT_TRUE(sites.ok());
  EXPECT_DOUBLE_EQ(sites->master.step({}).motor_force_N, 0.25);
}

/// Keys that no architecture of the library has.
struct ScriptParams {
  double force_N = 0.5;
  std::int64_t lines = 3;
  static constexpr auto fields() {
    return List{field("force_N", &ScriptParams::force_N, units::newton, between(0.0, 2.0), "What it answers."),
                field("lines", &ScriptParams::lines, between(1.0, 9.0), "How many lines it has.")};
  }
};

Result<Controllers> make_by_script(const ControlParams& params, Seconds) {
  return Controllers{master_controller(Scripted{.force_N = params.own<ScriptParams>().force_N}),
                     slave_controller(Silent{})};
}

Architecture by_script(const char* name = "by-script", const char* group = "script") {
  return {.name = name,
          .summary = "answers with the force of its script",
          .make = make_by_script,
          .keys = own_keys<ScriptParams>(group, "Architecture by-script: its script.")};
}

std::string keys_of(ControlParams params) {
  std::string all;
  for (const Binding& binding : bind(params)) all += binding.path + "\n";
  return all;
}

TEST(Architecture, BringsKeysOfItsOwnThatStandBesideThoseOfTheOthers) {
  const ControlParams before;
  EXPECT_EQ(keys_of(before).find("script"), std::string::npos);
  ASSERT_FALSE(register_architecture(by_script()));
  for (const ControlParams& params : {before, ControlParams{}}) {
    // Where others were registered before, theirs stand between.
    const std::string keys = keys_of(params);
    const std::size_t own = keys.find("\nscript\nscript.force_N\nscript.lines\n");
    ASSERT_NE(own, std::string::npos) << keys;
    EXPECT_GT(own, keys.find("\ntank.velocity.cutoff_Hz\n")) << keys;
    EXPECT_LT(own, keys.find("\nsupervision\n")) << keys;
  }
}

TEST(Architecture, IsMadeWithTheValuesOfItsOwnKeysAndWithTheirDefaults) {
  ASSERT_FALSE(register_architecture(by_script()));
  ControlParams params;
  params.architecture = "by-script";
  EXPECT_DOUBLE_EQ(make_sites(params, tick)->master.step({}).motor_force_N, 0.5);
  const ControlParams before = params;
  for (const Binding& binding : bind(params)) {
    if (binding.path == "script.force_N") *std::get<double*>(binding.target) = 0.125;
  }
  const ControlParams copy = params;
  params.own<ScriptParams>().force_N = 1.75;
  EXPECT_DOUBLE_EQ(make_sites(before, tick)->master.step({}).motor_force_N, 0.5);
  EXPECT_DOUBLE_EQ(make_sites(copy, tick)->master.step({}).motor_force_N, 0.125);
  EXPECT_DOUBLE_EQ(copy.own<ScriptParams>().force_N, 0.125);
  EXPECT_EQ(copy.own<ScriptParams>().lines, 3);
}

TEST(Architecture, ItsOwnKeysAreHeldToTheirBoundsWhicheverArchitectureIsChosen) {
  ASSERT_FALSE(register_architecture(by_script()));
  for (const char* architecture : {"by-script", "position-force"}) {
    ControlParams params;
    params.architecture = architecture;
    params.own<ScriptParams>().force_N = 2.5;
    EXPECT_EQ(make_sites(params, tick).error().parameter, "script.force_N");
    params.own<ScriptParams>() = {.lines = 10};
    EXPECT_EQ(make_sites(params, tick).error().parameter, "script.lines");
  }
}

TEST(Architecture, AnotherOneOfTheSameNameTakesThePlaceOfItAndOfItsGroup) {
  ASSERT_FALSE(register_architecture(by_script()));
  ASSERT_FALSE(register_architecture({"by-script", "answers with a constant force", make_scripted}));
  EXPECT_EQ(keys_of({}).find("script"), std::string::npos);
}

TEST(Architecture, TwoMayShareAGroup) {
  ASSERT_FALSE(register_architecture(by_script()));
  const std::string with_one = keys_of({});
  ASSERT_FALSE(register_architecture(by_script("by-script-too")));
  EXPECT_EQ(keys_of({}), with_one);
  ASSERT_FALSE(register_architecture({"by-script-too", "answers with a constant force", make_scripted}));
}

TEST(Architecture, AGroupWhoseNameOrTypeIsTakenIsRefused) {
  const auto refusal = [](const Architecture& architecture) {
    const Check refused = register_architecture(architecture);
    return refused ? refused->message : std::string("was registered");
  };
  EXPECT_EQ(
      refusal(by_script("never-registered", "gate")),
      "the group 'gate' of the architecture never-registered bears the name of a key that every architecture has: give "
      "it another one");
  EXPECT_EQ(
      refusal(by_script("never-registered", "tank")),
      "the group 'tank' of the architecture never-registered bears the name of the one that energy-tank has: give it "
      "another one");
  for (const char* group : {"", "my script", "my.script", "Script"}) {
    EXPECT_NE(refusal(by_script("never-registered", group)).find("has no name that a file can hold"),
              std::string::npos);
  }
  EXPECT_EQ(find_architecture("never-registered"), nullptr);
  EXPECT_EQ(refusal(by_script()), "was registered");
  EXPECT_EQ(refusal(by_script("other", "other")),
            "the group 'other' of the architecture other has the type of 'script', that by-script has: give it that "
            "name or a type of its own");
}

TEST(Site, NoControllerGetsPastItsGate) {
  const auto gate = SafetyGate::make({.force_limit_N = 0.5, .rate_limit_N_per_s = 1000.0}, tick);
  ASSERT_TRUE(gate.ok());
  MasterSite strong(master_controller(Scripted{.force_N = 900.0}), *gate);
  EXPECT_DOUBLE_EQ(strong.step({}).motor_force_N, 0.2);
  EXPECT_DOUBLE_EQ(strong.step({}).motor_force_N, 0.4);
  EXPECT_DOUBLE_EQ(strong.step({}).motor_force_N, 0.5);
  EXPECT_EQ(strong.fault(), GateFault::none);
  MasterSite broken(master_controller(Scripted{.force_N = std::numeric_limits<double>::quiet_NaN()}), *gate);
  EXPECT_EQ(broken.step({}).motor_force_N, 0.0);
  EXPECT_EQ(broken.fault(), GateFault::not_finite);
}

TEST(Architecture, AnUnknownNameIsRefusedWithTheNearestAndTheWholeList) {
  ControlParams params;
  params.architecture = "position-forse";
  const auto sites = make_sites(params, tick);
  ASSERT_FALSE(sites.ok());
  EXPECT_EQ(sites.error().parameter, "architecture");
  EXPECT_NE(sites.error().message.find("did you mean 'position-force'?"), std::string::npos) << sites.error().message;
}

TEST(Architecture, TheCouplingsNameTheKeyOfTheFileThatCannotBe) {
  const auto refused_key = [](const char* architecture, auto&& change) {
    ControlParams params;
    params.architecture = architecture;
    change(params);
    const auto sites = make_sites(params, tick);
    return sites ? std::string("was made") : sites.error().parameter;
  };
  for (const char* architecture : {"position-position", "projection", "shared-compliant"}) {
    EXPECT_EQ(refused_key(architecture, [](auto&) {}), "was made");
    EXPECT_EQ(refused_key(architecture, [](auto& p) { p.slave.velocity.cutoff_Hz = 2400.0; }),
              "slave.velocity.cutoff_Hz");
    EXPECT_EQ(refused_key(architecture,
                          [](auto& p) {
                            p.cancellation_step = CancellationStep::euler;
                            p.model.cable.stiffness_N_per_m = 1e9;
                          }),
              "cancellation_step");
  }
  EXPECT_EQ(
      refused_key("projection", [](auto& p) { p.template own<ProjectionParams>().hand_force_cutoff_Hz = 2400.0; }),
      "projection.hand_force_cutoff_Hz");
  EXPECT_EQ(refused_key("shared-compliant", [](auto& p) { p.template own<ComplianceParams>().cutoff_Hz = 2600.0; }),
            "compliance.cutoff_Hz");
}

TEST(Site, AMeasurementOrMessageThatIsNoNumberLetsGoAndStaysSoUntilReset) {
  const auto gate = SafetyGate::make({.force_limit_N = 0.5}, tick);
  ASSERT_TRUE(gate.ok());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with = [](auto&& spoil) {
    MasterInput input;
    spoil(input);
    return input;
  };
  for (const MasterInput& spoilt :
       {with([](auto& input) { input.motor_position_m = nan; }), with([](auto& input) { input.hand_force_N = nan; }),
        with([](auto& input) { input.grip = nan; }), with([](auto& input) { input.arrival.message.position_m = nan; }),
        with([](auto& input) { input.arrival.message.wave = nan; }),
        with([](auto& input) { input.arrival.message.energy_J = nan; })}) {
    MasterSite site(master_controller(Scripted{.force_N = 0.01}), *gate);
    EXPECT_DOUBLE_EQ(site.step({}).motor_force_N, 0.01);
    EXPECT_EQ(site.step(spoilt).motor_force_N, 0.0);
    EXPECT_EQ(site.step({}).motor_force_N, 0.0);
    EXPECT_EQ(site.fault(), GateFault::not_finite);
    site.reset();
    EXPECT_DOUBLE_EQ(site.step({}).motor_force_N, 0.01);
  }
}

TEST(Site, ACopyIsAForkWithAControllerOfItsOwn) {
  ControlParams params;
  params.force_gain = 5.0;
  auto sites = make_sites(params, tick);
  ASSERT_TRUE(sites.ok());
  const auto input = [](double force_N) {
    return MasterInput{.motor_position_m = 0.01, .arrival = {.message = {.force_N = force_N}, .fresh = true}};
  };
  for (int i = 0; i < 50; ++i) sites->master.step(input(0.1));
  MasterSite fork = sites->master;
  const double before_m = fork.step(input(0.1)).induced_position_m;
  EXPECT_NE(before_m, 0.0);
  for (int i = 0; i < 50; ++i) fork.step(input(-0.1));
  EXPECT_EQ(sites->master.step(input(0.1)).induced_position_m, before_m);
}

}  // namespace architecture_test
}  // namespace tactus::control
