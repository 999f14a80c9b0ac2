// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/station/watched_arm.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <optional>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace watched_arm_test {

/// An arm whose fourth motor is told the opposite, once it `reverses`.
class Reversing final : public station::JointDevice {
 public:
  explicit Reversing(station::JointDevice& device) : device_(&device) {}
  [[nodiscard]] Joints<station::DeviceLimits> limits() const override { return device_->limits(); }
  Joints<station::DeviceReading> read(const station::Tick& tick) noexcept override { return device_->read(tick); }
  void write(const Joints<station::DeviceCommand>& command) noexcept override {
    Joints<station::DeviceCommand> given = command;
    if (reverses) given[3].force_N = -given[3].force_N;
    device_->write(given);
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return device_->health(); }
  bool reverses = false;

 private:
  station::JointDevice* device_;
};

TEST(WatchedArm, IsLostOnceAMotorDoesNotDoAsItIsCommandedUntilItHasNoPower) {
  const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;
  auto document = configuration::Document::load(folder / "arm-tapping.toml").value();
  ASSERT_EQ(document.merge(configuration::Document::load(folder / "arms/limits.toml").value()), std::nullopt);
  const ArmFaultBench bench = make_arm_fault_bench(document.read<ArmTappingParams>().value(), folder).value();
  arm_plants::ArmDevice arm = bench.follower;
  Reversing motors(arm);
  station::WatchedArm watched(motors, bench.follower_watch);
  const arm::Chain model = arm::Chain::make(bench.setup.follower.arm.chain).value();
  const int steps = static_cast<int>(std::lround(bench.tick_s() / bench.setup.follower.arm.step_s));
  std::int64_t number = 0;
  const auto tick = [&](bool enabled) {
    const auto read = watched.read({.number = ++number});
    arm::JointVector position(static_cast<Eigen::Index>(read.size()));
    for (std::size_t i = 0; i < read.size(); ++i) position[static_cast<Eigen::Index>(i)] = read[i].position_m;
    const arm::JointVector weight = model.gravity_torque(position);
    Joints<station::DeviceCommand> command(read.size(), {.enabled = enabled});
    for (std::size_t i = 0; i < read.size(); ++i) command[i].force_N = weight[static_cast<Eigen::Index>(i)];
    watched.write(command);
    for (int step = 0; step < steps; ++step) arm.step({});
  };
  for (int i = 0; i < 500; ++i) tick(true);
  EXPECT_EQ(watched.health(), station::DeviceHealth::good);
  motors.reverses = true;
  for (int i = 0; i < 200; ++i) tick(true);
  EXPECT_EQ(watched.health(), station::DeviceHealth::lost);
  EXPECT_EQ(watched.found().joint, 3U);
  motors.reverses = false;
  tick(true);
  EXPECT_EQ(watched.health(), station::DeviceHealth::lost);
  tick(false);
  tick(false);
  EXPECT_EQ(watched.health(), station::DeviceHealth::good);
}

}  // namespace watched_arm_test
}  // namespace tactus::experiments
