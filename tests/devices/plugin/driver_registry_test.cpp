// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/driver_registry.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>

#include <memory>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace tactus::devices {
namespace driver_registry_test {

/// Two motors, whose torque limit is a key.
class Driver final : public BlockingDriver {
 public:
  struct Params {
    double torque_limit_Nm = 5.0;
    static constexpr auto fields() {
      return List{
          field("torque_limit_Nm", &Params::torque_limit_Nm, Unit{"N m", "_Nm"}, positive_up_to(10.0), "Largest.")};
    }
  };
  static Result<std::unique_ptr<BlockingDriver>> make(const Params& params, const DriverRequest& request) {
    asked() = request;
    return std::unique_ptr<BlockingDriver>(new Driver(params));
  }
  static DriverRequest& asked() {
    static DriverRequest request;
    return request;
  }

  std::size_t motors() const noexcept override { return 2; }
  MotorAbility ability(std::size_t) const noexcept override { return {.torque_Nm = params_.torque_limit_Nm}; }
  Check open() override { return std::nullopt; }
  Check exchange(std::span<const MotorCommand>, std::span<MotorReading>) override { return std::nullopt; }
  void close() noexcept override {}

 private:
  explicit Driver(const Params& params) : params_(params) {}
  Params params_;
};

std::string joint(const std::string& name, int motor, const std::string& torque_Nm) {
  return "[arm.leader." + name + "]\nmotor = " + std::to_string(motor) +
         "\nlower_rad = -1.5\nupper_rad = 1.5\nvelocity_limit_rad_per_s = 3.0\ntorque_limit_Nm = " + torque_Nm +
         "\ntorque_rate_limit_Nm_per_s = 50.0\n";
}

std::string side(const std::string& own_keys, const std::string& torque_Nm = "2.0") {
  return "[arm.leader]\nbus = \"test-arm\"\n" + own_keys + joint("shoulder", 7, torque_Nm) +
         joint("elbow", 9, torque_Nm);
}

class DriverRegistry : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_FALSE(register_driver<Driver>("test-arm", "for tests")); }
};

std::string refusal(const std::string& text) {
  const auto rig = Rig::parse(text, "rig.toml");
  return rig ? "no refusal" : describe(rig.error());
}

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

TEST_F(DriverRegistry, ARigFileNamesTheDriverAndItsOwnKeys) {
  const auto rig = Rig::parse(side("port = \"10.0.0.2\"\ntorque_limit_Nm = 4.0\n", "4.0"), "rig.toml");
  ASSERT_TRUE(rig) << describe(rig.error());
  const RigSide& leader = *rig->pairs()[0].leader;
  EXPECT_EQ(bus_name(leader.bus), "test-arm");
  EXPECT_FALSE(check(leader.bus));
  EXPECT_EQ(Driver::asked().port, "10.0.0.2");
  EXPECT_EQ(Driver::asked().motors, (std::vector<std::int64_t>{7, 9}));
  EXPECT_TRUE(leader.joints[1].joint.gives_force);
}

TEST_F(DriverRegistry, ALimitBeyondTheDriversIsRefusedWithItsLine) {
  const std::string refused = refusal(side("torque_limit_Nm = 1.0\n", "2.0"));
  EXPECT_TRUE(contains(refused, "rig.toml:") && contains(refused, "arm.leader.shoulder.torque_limit_Nm") &&
              contains(refused, "1 N m"))
      << refused;
}

TEST_F(DriverRegistry, WrongKeysOfItsOwnAreRefused) {
  EXPECT_TRUE(contains(refusal(side("torque_limit_Nm = 11.0\n")), "rig.toml:3"))
      << refusal(side("torque_limit_Nm = 11.0\n"));
  EXPECT_TRUE(contains(refusal(side("torque_limti_Nm = 1.0\n")), "torque_limit_Nm"));
}

TEST_F(DriverRegistry, AnotherNumberOfJointsIsRefused) {
  const std::string one = "[arm.leader]\nbus = \"test-arm\"\n" + joint("shoulder", 7, "2.0");
  EXPECT_TRUE(contains(refusal(one), "has 2 motors, and the file states 1")) << refusal(one);
}

TEST_F(DriverRegistry, AnUnknownBusListsTheRegisteredOnes) {
  const std::string refused = refusal("[arm.leader]\nbus = \"tset-arm\"\nport = \"x\"\n" + joint("shoulder", 7, "2.0"));
  EXPECT_TRUE(contains(refused, "rig.toml:2") && contains(refused, "damiao") && contains(refused, "test-arm") &&
              contains(refused, "--plugin"))
      << refused;
}

TEST_F(DriverRegistry, NamesOfBuiltInBusesAndNoNameAreRefused) {
  EXPECT_TRUE(register_driver<Driver>("damiao", ""));
  EXPECT_TRUE(register_driver<Driver>("", ""));
  EXPECT_EQ(find_driver("damiao"), nullptr);
  EXPECT_NE(find_driver("test-arm"), nullptr);
}

}  // namespace driver_registry_test
}  // namespace tactus::devices
