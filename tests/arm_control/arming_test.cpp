// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <tests/arm_control/arming_bench.hpp>

namespace tactus::arm_control {
namespace arming_test {
namespace {

using arming::Arming, arming::Before, arming::Wiring;

/// How many rigs of each kind; `TACTUS_ARMING_RIGS` in the environment asks for more.
int rigs_of_each() {
  const char* asked = std::getenv("TACTUS_ARMING_RIGS");
  return asked != nullptr ? std::atoi(asked) : 3;
}

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double between(double lower, double upper) { return std::uniform_real_distribution<double>(lower, upper)(engine_); }
  /// As many below 1 as above, over decades.
  double factor(double lower, double upper) { return std::exp(between(std::log(lower), std::log(upper))); }
  std::size_t of(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(engine_); }

 private:
  std::mt19937 engine_;
};

using Model = arm::Chain::Params;
const Model& true_model() { return true_arm().chain; }

Model with_masses(double factor) {
  Model model = true_model();
  for (auto& joint : model.joints) {
    arm::Body& body = joint.body;
    for (double* of : {&body.mass_kg, &body.xx_kg_m2, &body.yy_kg_m2, &body.zz_kg_m2, &body.xy_kg_m2, &body.xz_kg_m2,
                       &body.yz_kg_m2}) {
      *of *= factor;
    }
  }
  return model;
}

/// As a URDF in other units: its inertias are mostly not converted.
Model with_lengths(double factor) {
  Model model = true_model();
  for (auto& joint : model.joints) {
    for (double* of : {&joint.origin.x_m, &joint.origin.y_m, &joint.origin.z_m, &joint.body.centre_x_m,
                       &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= factor;
    }
  }
  return model;
}

/// Every mass and every centre of mass wrong by up to a fifth.
Model nearly_right(Draw& draw) {
  Model model = true_model();
  for (auto& joint : model.joints) {
    for (double* of : {&joint.body.mass_kg, &joint.body.centre_x_m, &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= draw.between(0.8, 1.2);
    }
  }
  return model;
}

Wiring swapped(std::size_t joint) {
  Wiring wiring;
  std::swap(wiring.motor[joint], wiring.motor[joint + 1]);
  return wiring;
}
Wiring reversed(std::size_t joint) {
  Wiring wiring;
  wiring.sign[joint] = -1.0;
  return wiring;
}

constexpr Before situations[] = {Before::hangs, Before::rests, Before::held};

/// Arms so many wrong rigs; until a site lets go no joint may leap.
template <class Rig>
void expect_no_leap(const char* what, unsigned seed, Rig&& draw_rig) {
  double fastest = 0.0, farthest = 0.0, afterwards = 0.0;
  int armed = 0, refused = 0, released = 0, runs = 0;
  for (const Before before : situations) {
    Draw draw(seed);
    for (int i = 0; i < rigs_of_each(); ++i) {
      const auto [name, model, wiring] = draw_rig(draw);
      const Arming outcome = arm_both(model, before, wiring);
      EXPECT_LE(outcome.fastest(), 0.5) << what << " " << name << ", " << name_of(before) << ": " << words_of(outcome);
      EXPECT_LE(outcome.farthest(), 0.03)
          << what << " " << name << ", " << name_of(before) << ": " << words_of(outcome);
      if (std::getenv("TACTUS_ARMING_LIST") != nullptr) {
        printf("%s %s, %s: %s\n", what, name.c_str(), name_of(before), words_of(outcome).c_str());
      }
      fastest = std::max(fastest, outcome.fastest());
      farthest = std::max(farthest, outcome.farthest());
      ++runs;
      if (outcome.became_active()) {
        ++armed;
        afterwards = std::max({afterwards, outcome.leader.active_rad_per_s, outcome.follower.active_rad_per_s});
      } else if (outcome.refused()) {
        ++refused;
      } else {
        ++released;
      }
    }
  }
  printf(
      "%s: %d rigs, %d refused, %d released, %d armed; until then at most %.3f rad/s and %.1f mrad, active %.2f "
      "rad/s\n",
      what, runs, refused, released, armed, fastest, 1e3 * farthest, afterwards);
}

struct Case {
  std::string name;
  Model model;
  Wiring wiring;
};

TEST(Arming, NoJointLeapsWhereTheMassesOfTheUrdfAreWrong) {
  expect_no_leap("masses", 1, [](Draw& draw) {
    const double factor = draw.factor(0.3, 10.0);
    return Case{"x " + std::to_string(factor), with_masses(factor), {}};
  });
}

TEST(Arming, NoJointLeapsWhereTheLengthsOfTheUrdfAreWrong) {
  int number = 0;
  expect_no_leap("lengths", 2, [&number](Draw& draw) {
    // Centimetres and millimetres are the likely ones.
    const double drawn = draw.factor(0.5, 1000.0);
    ++number;
    const double factor = number % 6 == 1 ? 100.0 : number % 6 == 2 ? 1000.0 : drawn;
    return Case{"x " + std::to_string(factor), with_lengths(factor), {}};
  });
}

TEST(Arming, NoJointLeapsWhereNeighbouringMotorsAreSwapped) {
  std::size_t next = 0;
  expect_no_leap("swapped", 3, [&next](Draw& draw) {
    const std::size_t joint = next++ % (joints - 1);
    return Case{std::to_string(joint + 1) + " and " + std::to_string(joint + 2), nearly_right(draw), swapped(joint)};
  });
}

TEST(Arming, NoJointLeapsWhereOneCountsTheOtherWay) {
  std::size_t next = 0;
  expect_no_leap("reversed", 4, [&next](Draw& draw) {
    const std::size_t joint = next++ % joints;
    return Case{std::to_string(joint + 1), nearly_right(draw), reversed(joint)};
  });
}

/// One that a hand holds may be: where the hand yields, the light wrist goes too far while its motor is tried
/// (docs/theory/safety.md).
TEST(Arming, AModelThatIsWrongByAFifthIsNotRefusedWhereTheArmHangsOrRests) {
  for (const Before before : {Before::hangs, Before::rests}) {
    Draw draw(5);
    double fastest = 0.0, farthest = 0.0, afterwards = 0.0;
    for (int i = 0; i < rigs_of_each(); ++i) {
      const Arming outcome = arm_both(nearly_right(draw), before);
      EXPECT_EQ(outcome.leader.found.fault, control::SupportFault::none)
          << i << ", " << name_of(before) << words_of(outcome);
      EXPECT_EQ(outcome.follower.found.fault, control::SupportFault::none)
          << i << ", " << name_of(before) << words_of(outcome);
      // A joint that still leans on its stop moves one way alone under the trial of its motor.
      if (before != Before::rests) {
        EXPECT_TRUE(outcome.became_active()) << i << ", " << name_of(before) << ": " << words_of(outcome);
      }
      fastest = std::max(fastest, outcome.fastest());
      farthest = std::max(farthest, outcome.farthest());
      afterwards = std::max({afterwards, outcome.leader.active_rad_per_s, outcome.follower.active_rad_per_s});
    }
    printf("20 %% wrong, %s: at most %.3f rad/s and %.1f mrad until active, then %.2f rad/s\n", name_of(before),
           fastest, 1e3 * farthest, afterwards);
  }
}

}  // namespace
}  // namespace arming_test
}  // namespace tactus::arm_control
