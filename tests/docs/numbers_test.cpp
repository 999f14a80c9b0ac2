// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/model/induced_motion_model.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

// The numbers that docs/theory/induced-master-motion.md gives. What follows from the parameters alone is computed from
// the paper's Table I as typed here; the errors of the steps are measured against a fine integration of the equations.
namespace tactus::control {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;

const Eigen::Vector3d mass_kg{0.0075, 0.01075, 0.014};

Eigen::Matrix3d coupling(double cable, double linkage, double hand) {
  Eigen::Matrix3d matrix;
  matrix << cable, -cable, 0.0, -cable, cable + linkage, -linkage, 0.0, -linkage, linkage + hand;
  return matrix;
}

Eigen::Matrix3d stiffness(double linkage_N_per_m) { return coupling(39500.0, linkage_N_per_m, 40.0); }
Eigen::Matrix3d damping() { return coupling(3.6, 0.02, 23.0); }

/// |motor position / motor force| in m/N of the linear part.
double response(double frequency_Hz, double linkage_N_per_m = 3950.0) {
  const std::complex<double> s(0.0, 2.0 * std::numbers::pi * frequency_Hz);
  Eigen::Matrix3cd impedance = stiffness(linkage_N_per_m) + s * damping();
  impedance += s * s * Eigen::Matrix3cd(mass_kg.cast<std::complex<double>>().asDiagonal());
  return std::abs(impedance.inverse()(0, 0));
}

double peak_Hz(double linkage_N_per_m) {
  double best_Hz = 30.0;
  for (double f = 30.0; f < 300.0; f += 0.1) {
    if (response(f, linkage_N_per_m) > response(best_Hz, linkage_N_per_m)) best_Hz = f;
  }
  return best_Hz;
}

TEST(InducedMotionNumbers, TheResponseToAForcePeaksBetween74And75Hz) {
  EXPECT_NEAR(peak_Hz(3950.0), 74.5, 0.2);
  EXPECT_NEAR(response(1.0), 6.8e-3, 0.05e-3);
  EXPECT_NEAR(response(10.0), 7.6e-4, 0.05e-4);
  EXPECT_NEAR(response(70.0), 7.1e-4, 0.05e-4);
  EXPECT_NEAR(response(100.0), 3.0e-4, 0.05e-4);
  EXPECT_NEAR(response(200.0), 3.3e-5, 0.05e-5);
}

TEST(InducedMotionNumbers, AtSmallDeflectionsTheDefaultLinkageIsStifferAndThePeakLiesNear85Hz) {
  const double initial_N_per_m =
      mechanics::BoucWenSpring::make({}, Seconds{200e-6}).value().initial_stiffness_N_per_m();
  EXPECT_NEAR(initial_N_per_m, 5078.0, 1.0);
  EXPECT_NEAR(peak_Hz(initial_N_per_m), 84.6, 0.2);
}

TEST(InducedMotionNumbers, ForwardEulerIsStableBelow91MicrosecondsOnTheCableAloneAndBelow90InTheChain) {
  // |1 + h λ| < 1 for h < −2 Re λ / |λ|².
  EXPECT_NEAR(3.6 / 39500.0, 91.1e-6, 0.05e-6);
  Matrix6 a = Matrix6::Zero();
  a.topRightCorner<3, 3>().setIdentity();
  a.bottomLeftCorner<3, 3>() = -(mass_kg.cwiseInverse().asDiagonal() * stiffness(3950.0));
  a.bottomRightCorner<3, 3>() = -(mass_kg.cwiseInverse().asDiagonal() * damping());
  double limit_s = 1.0, fastest_Hz = 0.0;
  for (const std::complex<double>& mode : a.eigenvalues()) {
    limit_s = std::min(limit_s, -2.0 * mode.real() / std::norm(mode));
    fastest_Hz = std::max(fastest_Hz, std::abs(mode) / (2.0 * std::numbers::pi));
  }
  EXPECT_NEAR(fastest_Hz, 480.0, 0.5);
  EXPECT_NEAR(limit_s, 89.6e-6, 0.05e-6);
}

TEST(InducedMotionNumbers, UnderFullForceTheModelsHandYieldsATwelfthOfTheLinearHand) {
  double yields_m = 2e-3;  // Newton's steps on 40 x + k5 x^5 = 1 N
  for (int i = 0; i < 50; ++i) {
    const double fourth = std::pow(yields_m, 4);
    yields_m -= (40.0 * yields_m + 3.125e13 * fourth * yields_m - 1.0) / (40.0 + 5.0 * 3.125e13 * fourth);
  }
  EXPECT_NEAR(yields_m, 1.97e-3, 0.005e-3);
  EXPECT_NEAR((1.0 / 40.0) / yields_m, 12.7, 0.05);
  const double chain_m = 1.0 / 39500.0 + 1.0 / 3950.0;
  EXPECT_NEAR((1.0 / 40.0 + chain_m) / (yields_m + chain_m), 11.3, 0.05);
}

/// The equations of the model in small explicit steps: drift, kick, drift.
struct FineIntegration {
  MasterModel master;
  double intended_m_per_s;
  mechanics::BoucWenSpring linkage = mechanics::BoucWenSpring::make(master.linkage, Seconds{1e-6}).value();
  std::array<double, 3> x{}, v{};

  void step(double motor_force_N, double h) {
    constexpr double band = 0.005;
    const double share = std::clamp(intended_m_per_s / band, -1.0, 1.0);
    const double offset = intended_m_per_s - share * band;
    for (std::size_t i = 0; i < 3; ++i) x[i] += 0.5 * h * v[i];
    const double cable = 39500.0 * (x[0] - x[1]) + 3.6 * (v[0] - v[1]);
    const double link = linkage.step({.deflection_m = x[1] - x[2]}) + 0.02 * (v[1] - v[2]);
    const double hand = 40.0 * x[2] + 3.125e13 * std::pow(x[2], 5) + 23.0 * v[2];
    const std::array<double, 3> force{motor_force_N - cable, cable - link, link - hand};
    const std::array<double, 3> friction_N{0.01, 0.0144, 0.0};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto body = static_cast<Eigen::Index>(i);
      v[i] += h * force[i] / mass_kg[body];
      const double most = h * friction_N[i] / mass_kg[body];
      v[i] += std::clamp(-(v[i] + offset), -most * (1.0 - share), most * (1.0 + share));
      x[i] += 0.5 * h * v[i];
    }
  }
};

constexpr double hold_s = 800e-6;  // a whole number of ticks of every length that is tried

/// A press with an impact on it, held over `hold_s`.
double displayed_N(int hold) {
  const double t = hold * hold_s;
  return -0.4 * (1.0 - std::exp(-t / 0.01)) - 0.5 * std::exp(-t / 0.02) * std::sin(2.0 * std::numbers::pi * 120.0 * t);
}

/// RMS error of the motor's path over 100 ms, as a share of the path's RMS.
double error_of(CancellationStep step, double tick_s, double intended_m_per_s) {
  constexpr int holds = 125;
  constexpr int fine_steps = 4000;
  FineIntegration truth{.master = {}, .intended_m_per_s = intended_m_per_s};
  auto model = InducedMotionModel::make({.master = {}, .step = step}, Seconds{tick_s}).value();
  const auto ticks = std::lround(hold_s / tick_s);
  double difference = 0.0, travel = 0.0;
  for (int hold = 0; hold < holds; ++hold) {
    const double force = displayed_N(hold);
    for (int i = 0; i < fine_steps; ++i) truth.step(force, hold_s / fine_steps);
    for (long i = 0; i < ticks; ++i) {
      model.step({.motor_force_N = force, .intended_velocity_m_per_s = intended_m_per_s});
    }
    difference += std::pow(model.motor_position_m() - truth.x[0], 2);
    travel += std::pow(truth.x[0], 2);
  }
  return std::sqrt(difference / travel);
}

TEST(InducedMotionNumbers, UnderAMovingHandTheExactStepIsOfSecondOrderAndEulerOfFirst) {
  constexpr double moving = 0.1;
  const double exact = error_of(CancellationStep::exact, 200e-6, moving);
  EXPECT_NEAR(exact, 1.7e-5, 0.2e-5);
  EXPECT_NEAR(error_of(CancellationStep::exact, 800e-6, moving) / exact, 16.0, 2.0);
  const double euler = error_of(CancellationStep::euler, 200e-6, moving);  // five substeps of 40 us
  EXPECT_NEAR(euler, 1.05e-3, 0.03e-3);
  EXPECT_NEAR(euler / error_of(CancellationStep::euler, 20e-6, moving), 2.0, 0.1);
}

TEST(InducedMotionNumbers, UnderARestingHandStickingFrictionLeavesTheExactStepAtFirstOrder) {
  const double exact = error_of(CancellationStep::exact, 200e-6, 0.0);
  EXPECT_NEAR(exact, 1.6e-4, 0.2e-4);
  EXPECT_NEAR(exact / error_of(CancellationStep::exact, 12.5e-6, 0.0), 9.5, 3.0);
  EXPECT_NEAR(error_of(CancellationStep::euler, 200e-6, 0.0), 1.07e-3, 0.03e-3);
}

}  // namespace
}  // namespace tactus::control
