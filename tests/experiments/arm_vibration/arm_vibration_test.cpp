#include <tactus/configuration/document.hpp>
#include <tactus/experiments/arm_vibration/coupled_arms.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace arm_vibration_test {

const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;

ArmVibrationParams shipped() {
  return configuration::Document::load(folder / "arm-vibration.toml")->read<ArmVibrationParams>().value();
}

CoupledArmsResult run(const ArmVibrationParams& params) {
  return *run_coupled_arms(*set_up_coupled_arms(params, folder));
}

TEST(ArmVibration, ASineIsToldByItsFrequencySpeedAndAmplitudeWhateverDriftsBesideIt) {
  std::vector<double> position, velocity;
  for (int k = 0; k < 1000; ++k) {
    const double t = 1e-3 * k, w = 2.0 * std::numbers::pi * 27.3;
    position.push_back(0.3 + 0.05 * t + 4e-3 * std::sin(w * t));
    velocity.push_back(0.05 + 4e-3 * w * std::cos(w * t));
  }
  const Shaking shaking = shaking_of(position, velocity, 1000.0);
  EXPECT_NEAR(shaking.frequency_Hz, 27.25, 0.25);
  EXPECT_NEAR(shaking.amplitude_rad, 4e-3, 1e-4);
  EXPECT_NEAR(shaking.rms_rad_per_s, 4e-3 * 2.0 * std::numbers::pi * 27.3 / std::numbers::sqrt2, 1e-3);
  const Shaking rest = shaking_of(std::vector(500, 0.2), std::vector(500, 0.0), 1000.0);
  EXPECT_EQ(rest.rms_rad_per_s, 0.0);
  EXPECT_EQ(rest.frequency_Hz, 0.0);
}

TEST(ArmVibration, TheReleasedLawIsThatOfItsSource) {
  const auto setup = set_up_coupled_arms(shipped(), folder);
  ASSERT_TRUE(setup) << describe(setup.error());
  const auto law = ReleasedLaw::make(setup->params.control, setup->believed);
  arm::ArmReading own{
      .position = setup->start, .velocity = arm::JointVector::Constant(7, 0.2), .torque = arm::JointVector::Zero(7)};
  const arm::JointVector other = setup->start * 0.9, speed = arm::JointVector::Constant(7, -0.3);
  const arm::ArmCommand told = law->command(own, other, speed);
  const double gravity = arm::Chain::make(setup->believed)->gravity_torque(own.position)[1];
  EXPECT_NEAR(told.torque[1], gravity + 0.306 * std::tanh(0.1 * 28.4 * 0.2) + 0.063 * 0.2 + 0.088, 1e-12);
  EXPECT_EQ(told.stiffness[1], 240.0);
  EXPECT_EQ(told.damping[1], 3.0);
  EXPECT_EQ(told.position, other);
  EXPECT_EQ(told.velocity, speed);
}

}  // namespace arm_vibration_test
}  // namespace tactus::experiments
