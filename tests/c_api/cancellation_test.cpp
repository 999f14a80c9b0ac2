// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/cancellation_file.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tests/allocation_counter.hpp"
#include "tests/c_api/files.hpp"

extern "C" int use_tactus_from_c99();
extern "C" int use_tactus_from_cxx11();

namespace tactus::c_api {
namespace {

using CApiCancellation = CApi;

constexpr double cycle_s = 200e-6;
constexpr const char* model_text = R"([control.model.motor]
mass_kg = 0.02
friction_N = 0.03
[control.model.cable]
stiffness_N_per_m = 39500.0
damping_N_s_per_m = 3.6
[control.model.drum]
mass_kg = 0.01075
friction_N = 0.0144
[control.model.linkage]
stiffness_N_per_m = 3950.0
damping_N_s_per_m = 0.02
hysteretic_fraction = 0.4
slip_deflection_m = 6.5e-05
reference_deflection_m = 0.00025
[control.model.handle]
mass_kg = 0.014
[control.model.hand]
stiffness_N_per_m = 40.0
damping_N_s_per_m = 23.0
quintic_stiffness_N_per_m5 = 3.125e13
)";

tactus_cancellation_options options_of(const std::string& file) {
  tactus_cancellation_options options = TACTUS_CANCELLATION_OPTIONS_INIT;
  options.sample_time_s = cycle_s;
  options.file = file.c_str();
  return options;
}

tactus_cancellation made_from(const std::string& file) {
  const tactus_cancellation_options options = options_of(file);
  tactus_cancellation made = 0;
  tactus_error error = 0;
  EXPECT_EQ(tactus_cancellation_make(&options, &made, &error), TACTUS_OK) << (error != 0 ? take(error).line : "");
  return made;
}

/// The loop of the README, from the same file.
control::Cancellation loop_of_the_library(const std::string& file) {
  const auto params = configuration::read_cancellation(file);
  EXPECT_TRUE(params.ok());
  return *control::Cancellation::make(*params, Seconds{cycle_s});
}

struct Cycles {
  std::vector<double> position_m, force_N;
};
Cycles random_cycles(std::size_t count) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Cycles cycles;
  for (std::size_t i = 0; i < count; ++i) {
    cycles.position_m.push_back(0.02 * std::sin(1e-3 * static_cast<double>(i)) + 1e-5 * normal(random));
    cycles.force_N.push_back(i % 500 < 60 ? -std::abs(normal(random)) : 0.0);
  }
  return cycles;
}

TEST_F(CApiCancellation, ANumberThatIsNotFiniteIsRefusedAndChangesNothing) {
  const tactus_cancellation asked = made_from(write("model.toml", model_text));
  const tactus_cancellation same = made_from(write("model.toml", model_text));
  double intended_m = 7.0, expected_m = 0.0;
  const std::array<double, 3> positions_m{0.01, 0.02, std::nan("")}, forces_N{0.0, -1.0, 0.0};
  std::array<double, 3> out{7.0, 7.0, 7.0};
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_EQ(tactus_cancellation_step(asked, bad, 0.0, &intended_m), TACTUS_OUT_OF_BOUNDS);
    EXPECT_EQ(tactus_cancellation_step(asked, 0.0, bad, &intended_m), TACTUS_OUT_OF_BOUNDS);
    EXPECT_EQ(tactus_cancellation_intended(asked, bad, &intended_m), TACTUS_OUT_OF_BOUNDS);
    EXPECT_EQ(tactus_cancellation_advance(asked, bad), TACTUS_OUT_OF_BOUNDS);
  }
  EXPECT_EQ(tactus_cancellation_step_array(asked, 3, positions_m.data(), forces_N.data(), out.data()),
            TACTUS_OUT_OF_BOUNDS);
  EXPECT_EQ(intended_m, 7.0);
  EXPECT_EQ(out[0], 7.0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(tactus_cancellation_step(asked, 0.01 * i, -0.5, &intended_m), TACTUS_OK);
    EXPECT_EQ(tactus_cancellation_step(same, 0.01 * i, -0.5, &expected_m), TACTUS_OK);
    EXPECT_EQ(intended_m, expected_m);
  }
}

TEST_F(CApiCancellation, TheHeaderIsC99AndCxx11) {
  EXPECT_EQ(use_tactus_from_c99(), 0);
  EXPECT_EQ(use_tactus_from_cxx11(), 0);
}

TEST_F(CApiCancellation, EveryWayToStepIsTheLoopOfTheLibraryBitForBit) {
  const std::string file = write("model.toml", model_text);
  const Cycles cycles = random_cycles(20000);
  const std::size_t count = cycles.position_m.size();
  std::vector<double> expected;
  auto loop = loop_of_the_library(file);
  for (std::size_t i = 0; i < count; ++i) {
    expected.push_back(loop.step({.measured_position_m = cycles.position_m[i], .motor_force_N = cycles.force_N[i]}));
  }
  const std::array<tactus_cancellation, 3> three{made_from(file), made_from(file), made_from(file)};
  std::vector<double> single(count), halves(count), whole(count);
  for (std::size_t i = 0; i < count; ++i) {
    ASSERT_EQ(tactus_cancellation_step(three[0], cycles.position_m[i], cycles.force_N[i], &single[i]), TACTUS_OK);
    ASSERT_EQ(tactus_cancellation_intended(three[1], cycles.position_m[i], &halves[i]), TACTUS_OK);
    ASSERT_EQ(tactus_cancellation_advance(three[1], cycles.force_N[i]), TACTUS_OK);
  }
  whole = cycles.position_m;  // the result may be written over an input
  ASSERT_EQ(tactus_cancellation_step_array(three[2], count, whole.data(), cycles.force_N.data(), whole.data()),
            TACTUS_OK);
  EXPECT_EQ(single, expected);
  EXPECT_EQ(halves, expected);
  EXPECT_EQ(whole, expected);
  EXPECT_NE(expected, cycles.position_m) << "the forces move the motor";
  double induced_m = 0.0;
  EXPECT_EQ(tactus_cancellation_induced(three[0], &induced_m), TACTUS_OK);
  EXPECT_EQ(induced_m, loop.model().motor_position_m());
  for (const auto handle : three) EXPECT_EQ(tactus_cancellation_release(handle), TACTUS_OK);
}

TEST_F(CApiCancellation, ACopyGoesItsOwnWayAndAResetIsAtRest) {
  const std::string file = write("model.toml", model_text);
  const tactus_cancellation one = made_from(file);
  double first_m = 0.0, second_m = 0.0, intended_m = 0.0;
  for (int i = 0; i < 50; ++i) ASSERT_EQ(tactus_cancellation_step(one, 0.0, -1.0, &intended_m), TACTUS_OK);
  tactus_cancellation other = 0;
  ASSERT_EQ(tactus_cancellation_copy(one, &other, nullptr), TACTUS_OK);
  ASSERT_EQ(tactus_cancellation_step(one, 0.0, -1.0, &first_m), TACTUS_OK);
  ASSERT_EQ(tactus_cancellation_step(other, 0.0, 0.0, &second_m), TACTUS_OK);
  EXPECT_EQ(first_m, second_m) << "the force of a cycle acts after its sample";
  ASSERT_EQ(tactus_cancellation_step(one, 0.0, -1.0, &first_m), TACTUS_OK);
  ASSERT_EQ(tactus_cancellation_step(other, 0.0, 0.0, &second_m), TACTUS_OK);
  EXPECT_NE(first_m, second_m);
  ASSERT_EQ(tactus_cancellation_reset(one), TACTUS_OK);
  ASSERT_EQ(tactus_cancellation_step(one, 0.01, 0.0, &first_m), TACTUS_OK);
  EXPECT_EQ(first_m, 0.01);
  EXPECT_EQ(tactus_cancellation_release(one), TACTUS_OK);
  ASSERT_EQ(tactus_cancellation_step(other, 0.0, 0.0, &second_m), TACTUS_OK) << "the copy outlives it";
  EXPECT_EQ(tactus_cancellation_release(other), TACTUS_OK);
}

TEST_F(CApiCancellation, AStepAllocatesNothing) {
  const tactus_cancellation one = made_from(write("model.toml", model_text));
  double intended_m = 0.0;
  const auto before = laws::own_allocation_count();
  for (int i = 0; i < 1000; ++i) static_cast<void>(tactus_cancellation_step(one, 0.01, -0.5, &intended_m));
  static_cast<void>(tactus_cancellation_step(one + 1, 0.01, -0.5, &intended_m));
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_EQ(tactus_cancellation_release(one), TACTUS_OK);
}

TEST_F(CApiCancellation, AModelFileThatLacksAKeyIsRefused) {
  const std::string file = write("model.toml", "[control.model.motor]\nmass_kg = 0.02\n");
  const tactus_cancellation_options options = options_of(file);
  tactus_cancellation made = 1;
  tactus_error error = 0;
  ASSERT_EQ(tactus_cancellation_make(&options, &made, &error), TACTUS_MISSING);
  EXPECT_EQ(made, 0U);
  EXPECT_EQ(take(error).parameter, "control.model.motor.friction_N");
}

TEST_F(CApiCancellation, AWrongValueIsRefusedWithPlaceValueBoundsAndRemedy) {
  const std::string file = write("model.toml", "[control.model.motor]\nmass_kg = -0.0075\n");
  tactus_cancellation_options options = options_of(file);
  tactus_cancellation made = 1;
  tactus_error error = 0;
  ASSERT_EQ(tactus_cancellation_make(&options, &made, &error), TACTUS_OUT_OF_BOUNDS);
  EXPECT_EQ(made, 0U);
  const ErrorTexts texts = take(error);
  EXPECT_EQ(texts.status, TACTUS_OUT_OF_BOUNDS);
  EXPECT_EQ(texts.exit_status, 2);
  EXPECT_EQ(texts.place, file + ":2:11");
  EXPECT_EQ(texts.parameter, "control.model.motor.mass_kg");
  EXPECT_EQ(texts.value, "-0.0075 kg");
  EXPECT_EQ(texts.bounds, "must be finite and greater than 0 kg");
  EXPECT_EQ(texts.remedy, "it " + texts.bounds);
  EXPECT_EQ(texts.line, texts.place + ": " + texts.parameter + ": " + texts.message);

  options.file = nullptr;
  const std::array<const char*, 1> set{"control.cancelation_friction=at-rest"};
  options.set = set.data();
  options.set_count = 1;
  ASSERT_EQ(tactus_cancellation_make(&options, &made, &error), TACTUS_UNKNOWN_KEY);
  EXPECT_EQ(take(error).remedy, "did you mean cancellation_friction?");
  options.set_count = 0;
  for (const double wrong_s : {0.0, -1.0, 2.0, std::nan(""), HUGE_VAL}) {
    options.sample_time_s = wrong_s;
    ASSERT_EQ(tactus_cancellation_make(&options, &made, &error), TACTUS_OUT_OF_BOUNDS) << wrong_s;
    EXPECT_EQ(take(error).parameter, "sample_time_s");
  }
  EXPECT_EQ(tactus_cancellation_make(&options, &made, nullptr), TACTUS_OUT_OF_BOUNDS) << "without an error's place";
}

TEST_F(CApiCancellation, AStructOfAnotherSizeAndANullPointerAreRefused) {
  tactus_cancellation_options options = TACTUS_CANCELLATION_OPTIONS_INIT;
  options.sample_time_s = cycle_s;
  tactus_cancellation made = 0;
  tactus_error error = 0;
  for (const std::size_t size : {std::size_t{0}, sizeof options - 1, sizeof options + 8}) {
    options.struct_size = size;
    ASSERT_EQ(tactus_cancellation_make(&options, &made, &error), TACTUS_BAD_ARGUMENT);
    EXPECT_NE(take(error).line.find("TACTUS_CANCELLATION_OPTIONS_INIT"), std::string::npos);
  }
  options.struct_size = sizeof options;
  options.set_count = 1;
  EXPECT_EQ(tactus_cancellation_make(&options, &made, nullptr), TACTUS_BAD_ARGUMENT);
  EXPECT_EQ(tactus_cancellation_make(nullptr, &made, nullptr), TACTUS_BAD_ARGUMENT);
  options.set_count = 0;
  EXPECT_EQ(tactus_cancellation_make(&options, nullptr, nullptr), TACTUS_BAD_ARGUMENT);
  ASSERT_EQ(tactus_cancellation_make(&options, &made, nullptr), TACTUS_OK);
  EXPECT_EQ(tactus_cancellation_step(made, 0.0, 0.0, nullptr), TACTUS_BAD_ARGUMENT);
  EXPECT_EQ(tactus_cancellation_step_array(made, 1, nullptr, nullptr, nullptr), TACTUS_BAD_ARGUMENT);
  EXPECT_EQ(tactus_cancellation_step_array(made, 0, nullptr, nullptr, nullptr), TACTUS_OK);
  EXPECT_EQ(tactus_cancellation_release(made), TACTUS_OK);
  EXPECT_EQ(tactus_check_interface(TACTUS_INTERFACE_MAJOR, TACTUS_INTERFACE_MINOR + 1, &error), TACTUS_INCONSISTENT);
  EXPECT_NE(take(error).line.find("install header and library of one version"), std::string::npos);
}

}  // namespace
}  // namespace tactus::c_api
