#include <tactus/control/architecture.hpp>

#include <limits>

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
  register_architecture({"scripted", "answers with a constant force", make_scripted});
  ControlParams params;
  params.architecture = "scripted";
  params.force_gain = 0.25;
  auto sites = make_sites(params, tick);
  ASSERT_TRUE(sites.ok());
  EXPECT_DOUBLE_EQ(sites->master.step({}).motor_force_N, 0.25);
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
  EXPECT_EQ(refused_key("projection", [](auto& p) { p.projection.hand_force_cutoff_Hz = 2400.0; }),
            "projection.hand_force_cutoff_Hz");
  EXPECT_EQ(refused_key("shared-compliant", [](auto& p) { p.compliance.cutoff_Hz = 2600.0; }), "compliance.cutoff_Hz");
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
