// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <string>

#include "tests/cli/command.hpp"
#include "tests/cli/schema_validator.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using Recordings = Command;
using Json = nlohmann::json;

constexpr double mass_kg = 2.0;
constexpr double friction_N = 1.0;
constexpr double wall_N_per_m = 2000.0;

/// A carriage driven to and fro by a servo, by explicit integration at 10 kHz and recorded at 1 kHz; with a wall, a
/// spring stands ahead of `x` = 10 mm. `contact_N` is the force of the wall on the carriage.
std::string carriage(const std::string& header, bool wall, int samples = 5000) {
  std::string text = header + "\n";
  double x = 0.0;
  double v = 0.0;
  for (int i = 0; i < 10 * samples; ++i) {
    const double t = 1e-4 * i;
    const double wanted = 0.04 * std::sin(4.0 * t) + 0.015 * std::sin(15.0 * t);
    const double drive = 3000.0 * (wanted - x) - 110.0 * v;
    const double contact = wall && x > 0.01 ? -wall_N_per_m * (x - 0.01) : 0.0;
    if (i % 10 == 0) {
      char line[128];
      std::snprintf(line, sizeof line, "%.4f,%.9g,%.9g,%.9g\n", t, x, drive, contact);
      text += line;
    }
    const double free = v + 1e-4 * (drive + contact - 3.0 * v) / mass_kg;
    const double most = 1e-4 * friction_N / mass_kg;
    v = std::abs(free) <= most ? 0.0 : free - std::copysign(most, free);
    x += 1e-4 * v;
  }
  return text;
}

const std::string header = "time_s,x_m,drive_N,contact_N";

TEST_F(Recordings, a_model_identified_in_free_motion_estimates_the_force_of_a_wall) {
  write("free.csv", carriage(header, false));
  const Outcome identified = tactus({"identify", "inverse", "free.csv", "--json", "--out", "results"});
  ASSERT_EQ(identified.status, 0) << identified.err;
  const Json model = Json::parse(identified.out);
  ASSERT_EQ(model["parameters"][0]["name"], "inertia");
  EXPECT_NEAR(model["parameters"][0]["value"].get<double>(), mass_kg, 0.02 * mass_kg);
  EXPECT_EQ(model["parameters"][0]["unit"], "kg");
  EXPECT_LT(model["parameters"][0]["interval_95"][0], model["parameters"][0]["value"]);

  write("wall.csv", carriage(header, true));
  const Outcome estimated = tactus({"estimate", "force", "wall.csv", "--model", "results/model.toml", "--json"});
  ASSERT_EQ(estimated.status, 0) << estimated.err;
  const Json force = Json::parse(estimated.out);
  EXPECT_EQ(force["compared_with"], "contact");
  EXPECT_GT(force["correlation"].get<double>(), 0.99);
  EXPECT_LT(force["rmse_N"].get<double>(), 0.05 * force["peak_N"].get<double>());
  EXPECT_LT(force["free_motion_residual_N"].get<double>(), 2.0 * friction_N);
  EXPECT_LT(std::abs(force["lead_s"].get<double>()), 0.01);
}

TEST_F(Recordings, columns_that_are_not_recognised_are_listed_with_the_option_that_names_them) {
  write("free.csv", carriage("time_s,alpha,beta,gamma", false));
  const Outcome guessed = tactus({"identify", "inverse", "free.csv"});
  EXPECT_EQ(guessed.status, 2);
  EXPECT_NE(guessed.err.find("--position"), std::string::npos) << guessed.err;
  EXPECT_NE(guessed.err.find("'beta'"), std::string::npos) << guessed.err;
  const Outcome named = tactus({"identify", "inverse", "free.csv", "--position", "alpha", "--force", "beta"});
  EXPECT_EQ(named.status, 0) << named.err;
}

TEST_F(Recordings, a_wall_whose_force_is_given_as_external_leaves_the_mass_as_it_is) {
  write("wall.csv", carriage(header, true));
  const Outcome outcome = tactus({"identify", "inverse", "wall.csv", "--external", "contact_N", "--json"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json model = Json::parse(outcome.out);
  EXPECT_NEAR(model["parameters"][0]["value"].get<double>(), mass_kg, 0.02 * mass_kg);
}

TEST_F(Recordings, a_bad_recording_gives_a_message_and_no_model) {
  const std::string good = carriage(header, false);
  std::string gap = good;
  gap.erase(gap.find("2.0000,"), gap.find("2.1000,") - gap.find("2.0000,"));
  std::string not_a_number = good;
  not_a_number.replace(not_a_number.find("\n1.0000,") + 8, 4, "nan ");
  write("gap.csv", gap);
  write("nan.csv", not_a_number);
  write("cut.csv", good.substr(0, good.find("\n3.0000,") + 9));
  write("short.csv", carriage(header, false, 100));
  write("wall.csv", carriage(header, true));
  write("good.csv", good);
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"gap.csv"},
                                              {"nan.csv"},
                                              {"cut.csv"},
                                              {"short.csv"},
                                              {"wall.csv"},
                                              {"none.csv"},
                                              {"good.csv", "--sample-time-s", "0.002"},
                                              {"good.csv", "--force-sign", "-1"},
                                              {"good.csv", "--position", "drive_N", "--force", "x_m"},
                                              {"good.csv", "--force", "contact_N"}}) {
    std::vector<std::string> arguments{"identify", "inverse", "--out", "results"};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, 2) << bad.front() << outcome.out;
    EXPECT_FALSE(outcome.err.empty());
    EXPECT_TRUE(outcome.out.empty());
  }
  for (const std::string& file : files()) EXPECT_EQ(file.find("results"), std::string::npos) << file;
}

/// A hand of 200 N/m, 10 N s/m and 50 g on a handle of 100 g that the motor jolts, while the person moves it slowly;
/// explicit integration at 10 kHz, recorded at 1 kHz.
std::string teleoperation(const std::string& columns, int samples = 5000) {
  std::string text = columns + "\n";
  double x = 0.0;
  double v = 0.0;
  for (int i = 0; i < 10 * samples; ++i) {
    const double t = 1e-4 * i;
    const double aim = 0.02 * std::sin(4.0 * t);
    const double motor = 3.0 * std::pow(std::sin(17.0 * t) * std::sin(29.0 * t + t * t), 9.0);
    const double spring = 200.0 * (aim - x) + 10.0 * (0.08 * std::cos(4.0 * t) - v);
    const double acceleration = (motor + spring - 0.5 * v) / 0.15;
    if (i % 10 == 0) {
      char line[128];
      std::snprintf(line, sizeof line, "%.4f,%.9g,%.9g,%.9g,%.9g\n", t, x, 0.9 * x, motor,
                    spring - 0.05 * acceleration);
      text += line;
    }
    v += 1e-4 * acceleration;
    x += 1e-4 * v;
  }
  return text;
}

TEST_F(Recordings, the_impedance_of_the_hand_is_found_in_a_recording_of_master_and_slave) {
  write("work.csv", teleoperation("time_s,master_position_m,slave_position_m,motor_force_N,hand_force_N"));
  const Outcome outcome = tactus({"identify", "operator", "work.csv", "--json", "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json found = Json::parse(outcome.out);
  EXPECT_EQ(SchemaValidator(Json::parse(tactus({"schema", "--results", "identify", "operator"}).out)).faults(found),
            "");
  EXPECT_EQ(found["position"], "master_position");
  EXPECT_EQ(found["force"], "hand_force");
  EXPECT_EQ(found["verdict"], "determined");
  const double truth[] = {200.0, 10.0, 0.05};
  const char* const names[] = {"stiffness", "damping", "mass"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(found["parameters"][i]["name"], names[i]);
    EXPECT_EQ(found["parameters"][i]["determined"], true);
    EXPECT_NEAR(found["parameters"][i]["value"].get<double>(), truth[i], 0.05 * truth[i]);
  }
  EXPECT_EQ(found["windows"].size(), 6);
  EXPECT_NE(content("results/report.html").find("<svg"), std::string::npos);
}

TEST_F(Recordings, a_bad_recording_of_the_hand_gives_a_message_and_no_impedance) {
  const std::string good = teleoperation("time_s,x_m,other_m,motor_force_N,hand_force_N");
  std::string gap = good;
  gap.erase(gap.find("2.0000,"), gap.find("2.1000,") - gap.find("2.0000,"));
  write("gap.csv", gap);
  write("short.csv", teleoperation("time_s,x_m,other_m,motor_force_N,hand_force_N", 1500));
  write("good.csv", good);
  for (const std::vector<std::string>& bad : {std::vector<std::string>{"good.csv"},
                                              {"gap.csv", "--position", "x_m"},
                                              {"short.csv", "--position", "x_m"},
                                              {"good.csv", "--position", "x_m", "--force-sign", "-1"},
                                              {"good.csv", "--position", "hand_force_N", "--force", "x_m"},
                                              {"good.csv", "--position", "x_m", "--sample-time-s", "0.002"},
                                              {"good.csv", "--position", "x_m", "--window-s", "0.1"}}) {
    std::vector<std::string> arguments{"identify", "operator", "--out", "results"};
    arguments.insert(arguments.end(), bad.begin(), bad.end());
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, 2) << bad.front() << outcome.out;
    EXPECT_FALSE(outcome.err.empty());
    EXPECT_TRUE(outcome.out.empty());
  }
  for (const std::string& file : files()) EXPECT_EQ(file.find("results"), std::string::npos) << file;
}

}  // namespace
}  // namespace tactus::cli
