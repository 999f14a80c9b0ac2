// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/contact.hpp>

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace contact_test {

static_assert(Element<KelvinVoigtContact>);
static_assert(Element<HuntCrossleyContact>);

constexpr Seconds substep{40e-6};

KelvinVoigtContact kelvin_voigt(KelvinVoigtContact::Params params = {}) {
  return KelvinVoigtContact::make(params, substep).value();
}
HuntCrossleyContact hunt_crossley(HuntCrossleyContact::Params params = {}) {
  return HuntCrossleyContact::make(params, substep).value();
}

template <class Contact>
void expect_no_pull(Contact contact) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20000; ++i) {
    const Penetration at{.penetration_m = 1e-4 * normal(engine), .rate_m_per_s = 3.0 * normal(engine)};
    const double force_N = contact.step(at);
    ASSERT_GE(force_N, 0.0);
    ASSERT_TRUE(at.penetration_m > 0.0 || force_N == 0.0);
  }
  EXPECT_EQ(contact.step({.penetration_m = 0.0, .rate_m_per_s = 1.0}), 0.0);
  EXPECT_EQ(contact.step({.penetration_m = 1e-6, .rate_m_per_s = -100.0}), 0.0)
      << "a body that leaves is not held back";
}

TEST(Contact, NeverPullsAndNeverActsAcrossAGap) {
  expect_no_pull(kelvin_voigt());
  expect_no_pull(hunt_crossley());
}

/// Least energy that went into the contact by any time, over random paths that start outside and come back there.
template <class Contact>
double least_energy_at_closed_paths_J(Contact contact) {
  std::mt19937_64 engine(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> rate(0.001, 2.0);
  double supplied_J = 0.0;
  double least_J = 0.0;
  double depth_m = -1e-4;
  for (int i = 0; i < 400; ++i) {
    const double target_m = i % 4 == 3 ? -1e-4 : 1e-4 * normal(engine);
    const double rate_m_per_s = std::copysign(rate(engine), target_m - depth_m);
    constexpr int pieces = 2000;
    const double piece_m = (target_m - depth_m) / pieces;
    for (int n = 0; n < pieces; ++n) {
      supplied_J +=
          piece_m * contact.step({.penetration_m = depth_m + (n + 0.5) * piece_m, .rate_m_per_s = rate_m_per_s});
    }
    depth_m = target_m;
    if (i % 4 == 3) least_J = std::min(least_J, supplied_J);
  }
  EXPECT_GT(supplied_J, 1e-4) << "the paths must have touched";
  return least_J;
}

TEST(Contact, GivesNoEnergyOnAnyClosedPath) {
  EXPECT_GE(least_energy_at_closed_paths_J(kelvin_voigt({.damping_N_s_per_m = 20.0})), -1e-8);
  EXPECT_GE(least_energy_at_closed_paths_J(hunt_crossley({.dissipation_s_per_m = 3.0})), -1e-8);
}

/// Speed after over speed before an impact, by a fourth-order Runge-Kutta integration with 100 ns steps.
template <class Contact>
double restitution(Contact contact, double mass_kg, double speed_m_per_s) {
  constexpr double dt_s = 1e-7;
  double x = 1e-15;
  double v = speed_m_per_s;
  const auto acceleration = [&](double at, double rate) {
    return -contact.step({.penetration_m = at, .rate_m_per_s = rate}) / mass_kg;
  };
  for (int i = 0; i < 1000000 && x > 0.0; ++i) {
    const double a1 = acceleration(x, v);
    const double v2 = v + 0.5 * dt_s * a1;
    const double a2 = acceleration(x + 0.5 * dt_s * v, v2);
    const double v3 = v + 0.5 * dt_s * a2;
    const double a3 = acceleration(x + 0.5 * dt_s * v2, v3);
    const double v4 = v + dt_s * a3;
    const double a4 = acceleration(x + dt_s * v3, v4);
    x += dt_s / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
    v += dt_s / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
  }
  EXPECT_LE(x, 0.0) << "the body must have left";
  return -v / speed_m_per_s;
}

TEST(KelvinVoigtContact, ADroppedMassLeavesWithTheClosedFormRestitution) {
  constexpr double mass_kg = 0.018;
  constexpr double stiffness_N_per_m = 40000.0;
  for (const double damping_ratio : {0.0, 0.05, 0.3, 0.7}) {
    const double damping_N_s_per_m = 2.0 * damping_ratio * std::sqrt(mass_kg * stiffness_N_per_m);
    const auto contact = kelvin_voigt({.stiffness_N_per_m = stiffness_N_per_m, .damping_N_s_per_m = damping_N_s_per_m});
    // Contact ends when the acceleration of the damped oscillation passes zero, at the phase θ of the damped frequency,
    // and there the velocity is −v₀ exp(−ζθ/√(1 − ζ²)).
    const double rest = std::sqrt(1.0 - damping_ratio * damping_ratio);
    const double phase = std::atan2(2.0 * damping_ratio * rest, 2.0 * damping_ratio * damping_ratio - 1.0);
    EXPECT_NEAR(restitution(contact, mass_kg, 0.2), std::exp(-damping_ratio * phase / rest), 1e-5) << damping_ratio;
  }
}

TEST(HuntCrossleyContact, ADroppedMassLeavesWithTheExactRestitutionForEveryExponent) {
  // v dv/dδ = −(k/m) δⁿ (1 + c v) separates: G(v) = v/c − ln(1 + c v)/c² is the same on the way in and out.
  for (const double exponent : {1.0, 1.5, 2.5}) {
    for (const double c : {0.1, 1.0, 4.0}) {
      constexpr double speed_m_per_s = 0.3;
      const auto g = [c](double v) { return v / c - std::log1p(c * v) / (c * c); };
      double slow = 0.0;
      double fast = std::min(1.0, 1.0 / (c * speed_m_per_s) - 1e-12);
      for (int i = 0; i < 100; ++i) {
        const double middle = 0.5 * (slow + fast);
        (g(-middle * speed_m_per_s) < g(speed_m_per_s) ? slow : fast) = middle;
      }
      const auto contact = hunt_crossley({.exponent = exponent, .dissipation_s_per_m = c});
      EXPECT_NEAR(restitution(contact, 0.018, speed_m_per_s), slow, 1e-5) << "n " << exponent << ", c " << c;
    }
  }
}

TEST(HuntCrossleyContact, HasItsSecantStiffnessAtTheReferenceDepthAndGrowsByTheExponent) {
  for (const double exponent : {1.0, 1.5, 2.5}) {
    auto contact = hunt_crossley({.stiffness_N_per_m = 40000.0, .exponent = exponent});
    const double at_N = contact.step({.penetration_m = 1e-4, .rate_m_per_s = 0.0});
    EXPECT_NEAR(at_N, 4.0, 1e-12);
    EXPECT_NEAR(contact.step({.penetration_m = 2e-4, .rate_m_per_s = 0.0}) / at_N, std::exp2(exponent), 1e-12);
    EXPECT_NEAR(contact.step({.penetration_m = 1e-4, .rate_m_per_s = 0.2}) / at_N, 1.1, 1e-12);
  }
}

}  // namespace contact_test
}  // namespace tactus::mechanics
